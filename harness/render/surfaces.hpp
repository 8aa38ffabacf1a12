#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::render {

struct Bounds {
  Vec3 low{}, high{};
  void add(const Vec3&);
  void grow(double by_m);
  bool holds(const Vec3&) const;
  double diagonal() const;
  static Bounds none();
  bool empty() const { return !(low[0] <= high[0]); }
};

/// Triangles of colliders and grips to draw, in world coordinates.
struct Surfaces {
  std::vector<Vec3> position_m, normal;  ///< one per vertex; normals unit, or zero if undefined
  std::vector<std::uint8_t> look;        ///< LOOK_… of render_shared.h
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Colliders and active grips of a scene at the end of frame `frame` (0 = the start). Only those triangles
/// of static meshes are drawn that overlap `near` (a room has more walls than its desk); infinite planes are clipped to
/// `near`; moving colliders are drawn whole. Triangles that are not finite are left out.
Surfaces surfaces(const Scene&, int frame, const Bounds& near);

}  // namespace clothbench::render
