#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace clothbench {

/// A property of scenes that solvers must support, one per row of feature_table.hpp. Only the loader (`derive_needs`)
/// derives features from the scenario. `check_stages` compares them with the features that a run's stages serve.
enum class Feature : std::uint8_t {
#define FEATURE(id, ...) id,
#include "clothbench/feature_table.hpp"
#undef FEATURE
  Count
};

enum class FeatureOf : std::uint8_t {
  Cloth,
  Collider,  ///< something that touches the cloth
  Data       ///< changes the data of a stage and needs no separate stage
};

struct FeatureRow {
  std::string_view name;
  FeatureOf of;
  std::string_view doc;
};

inline constexpr std::size_t kFeatureCount = static_cast<std::size_t>(Feature::Count);

inline constexpr std::array<FeatureRow, kFeatureCount> kFeatures = {{
#define FEATURE(id, name, bit, of, doc, needed) {#name, FeatureOf::of, doc},
#include "clothbench/feature_table.hpp"
#undef FEATURE
}};

constexpr std::string_view name_of(Feature f) { return kFeatures[static_cast<std::size_t>(f)].name; }

/// A set of features, with the usual set operations.
class FeatureSet {
 public:
  constexpr FeatureSet() = default;
  /// Bit k stands for feature k; bits at and beyond kFeatureCount are dropped.
  constexpr explicit FeatureSet(std::uint32_t bits) : bits_(bits & ((1u << kFeatureCount) - 1)) {}
  constexpr FeatureSet(std::initializer_list<Feature> features) {
    for (Feature f : features) bits_ |= bit(f);
  }
  constexpr bool has(Feature f) const { return (bits_ & bit(f)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr std::uint32_t bits() const { return bits_; }
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
  static constexpr std::uint32_t bit(Feature f) { return 1u << static_cast<unsigned>(f); }
  std::uint32_t bits_ = 0;
};

constexpr FeatureSet features_of(FeatureOf what) {
  FeatureSet out;
  for (std::size_t k = 0; k < kFeatureCount; ++k)
    if (kFeatures[k].of == what) out.add(static_cast<Feature>(k));
  return out;
}

inline constexpr FeatureSet kColliderFeatures = features_of(FeatureOf::Collider);

}  // namespace clothbench
