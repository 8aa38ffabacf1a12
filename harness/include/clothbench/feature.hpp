#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace clothbench {

/// What a scene asks of a solver. Derived from the scenario by the loader (`derive_needs`), never by a solver. A run
/// fails unless the features its stages served are exactly those the scene needs (`check_stages`).
enum class Feature : std::uint8_t {
  Stretch,  ///< structural edges
  Shear,    ///< diagonals
  Bend,
  Damping,
  Pins,
  MovingPins,
  Sphere,
  Box,
  Plane,
  Capsules,
  StaticMesh,
  MovingMesh,
  Friction,
  DoubleSided,      ///< two-sided contact without a second layer; needed only where there is something to touch
  DuplicatedLayer,  ///< the paper's second, oppositely wound layer of particles tied to the first
  SelfCollision,
  Render,
  UnevenGrid,  ///< cells of different widths (cloth.column_factors)
  Regions,     ///< a membrane stiffness that changes from column to column (material.regions)
  Spin,        ///< a start that turns: another velocity at every vertex
  ClothMesh,   ///< a triangle mesh instead of a grid (cloth.mesh)
  Count
};

inline constexpr std::size_t kFeatureCount = static_cast<std::size_t>(Feature::Count);

inline constexpr std::array<std::string_view, kFeatureCount> kFeatureNames = {
    "stretch",        "shear",       "bend",        "damping",      "pins",
    "moving_pins",    "sphere",      "box",         "plane",        "capsules",
    "static_mesh",    "moving_mesh", "friction",    "double_sided", "duplicated_layer",
    "self_collision", "render",      "uneven_grid", "regions",      "spin",
    "cloth_mesh"};

constexpr std::string_view name_of(Feature f) { return kFeatureNames[static_cast<std::size_t>(f)]; }

/// A set of features; a value type with the usual set algebra.
class FeatureSet {
 public:
  constexpr FeatureSet() = default;
  constexpr FeatureSet(std::initializer_list<Feature> features) {
    for (Feature f : features) bits_ |= bit(f);
  }
  constexpr bool has(Feature f) const { return (bits_ & bit(f)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr void add(Feature f) { bits_ |= bit(f); }
  constexpr FeatureSet operator|(FeatureSet o) const { return FeatureSet(bits_ | o.bits_); }
  constexpr FeatureSet operator&(FeatureSet o) const { return FeatureSet(bits_ & o.bits_); }
  constexpr FeatureSet operator-(FeatureSet o) const { return FeatureSet(bits_ & ~o.bits_); }
  constexpr FeatureSet& operator|=(FeatureSet o) {
    bits_ |= o.bits_;
    return *this;
  }
  constexpr bool operator==(const FeatureSet&) const = default;

  template <class Fn>
  constexpr void for_each(Fn&& fn) const {
    for (std::size_t i = 0; i < kFeatureCount; ++i)
      if (has(static_cast<Feature>(i))) fn(static_cast<Feature>(i));
  }

 private:
  constexpr explicit FeatureSet(std::uint32_t bits) : bits_(bits) {}
  static constexpr std::uint32_t bit(Feature f) { return 1u << static_cast<unsigned>(f); }
  std::uint32_t bits_ = 0;
};

/// Everything that touches cloth.
inline constexpr FeatureSet kColliderFeatures = {Feature::Sphere,   Feature::Box,        Feature::Plane,
                                                 Feature::Capsules, Feature::StaticMesh, Feature::MovingMesh};

}  // namespace clothbench
