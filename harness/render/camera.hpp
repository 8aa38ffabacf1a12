#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::render {

/// 4 x 4, column-major like a matrix in a shader.
using Mat4 = std::array<double, 16>;
Mat4 operator*(const Mat4& a, const Mat4& b);

/// A pinhole camera. World: right-handed, +y up.
struct Camera {
  Vec3 eye_m{}, right{}, up{}, back{};  ///< orthonormal; `back` points from the target towards the eye
  double tan_half_width = 0, tan_half_height = 0;
  double near_m = 0, far_m = 0;

  /// Transforms world coordinates relative to `origin_m` to the camera's axes.
  Mat4 view(const Vec3& origin_m) const;
  /// Transforms to Vulkan's clip space: y down, depth 0 at `near_m` to 1 at `far_m`. Matches xr::projection_of.
  Mat4 projection() const;
};

/// The nearest camera that sees all of `points` (xyz interleaved [m], finite), with a margin of 4 % of the image's
/// width and height on every side. It looks from the front, 30 degrees to the right and 24 up. `aspect`: width over
/// height. Throws Error if there are no points.
Camera frame(std::span<const double> points, double aspect);

/// Left and right eye of a user who looks along -z at the middle of a box from `distance_m` away. The field of view of
/// 110 x 96 degrees is a Quest 3's (Meta's technical specifications); the eyes are 63 mm apart, the mean of adults.
std::array<Camera, 2> eyes(const Vec3& middle_m, double distance_m, double near_m, double far_m);

struct Bounds {
  Vec3 low{}, high{};
  void add(const Vec3&);
  void grow(double by_m);
  bool holds(const Vec3&) const;
  double diagonal() const;
  static Bounds none();
  static Bounds of(std::span<const double> positions_m);  ///< xyz interleaved
  bool empty() const { return !(low[0] <= high[0]); }
};

/// Triangles of colliders and grips to draw, in world coordinates.
struct Surfaces {
  std::vector<Vec3> position_m, normal;  ///< one per vertex; normals unit, or zero if undefined
  std::vector<std::uint8_t> look;        ///< LOOK_… of render_shared.h
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Colliders and active grips of a scene at the end of frame `frame` (0 = the start). Static meshes are drawn without
/// triangles outside `near` (such as distant walls of a room); infinite planes are clipped to `near`; moving
/// colliders are drawn completely. Triangles that are not finite are omitted.
Surfaces surfaces(const Scene&, int frame, const Bounds& near);

}  // namespace clothbench::render
