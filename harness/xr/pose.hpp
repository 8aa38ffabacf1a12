#pragma once
#include <Eigen/Geometry>
#include <array>

#include "clothbench/collider.hpp"
#include "xr/openxr.hpp"

namespace clothbench::xr {

inline Vec3 vector_of(const XrVector3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// The axes x, y, z of what has this orientation.
inline std::array<Vec3, 3> axes_of(const XrQuaternionf& q) {
  const Eigen::Matrix3d m = Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>().toRotationMatrix();
  return {{{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}}};
}

}  // namespace clothbench::xr
