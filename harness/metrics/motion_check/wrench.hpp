#pragma once
#include <Eigen/Dense>

#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {

using V6 = Eigen::Matrix<double, 6, 1>;
using M6 = Eigen::Matrix<double, 6, 6>;

/// The wrench of a force: force and moment. An arm of half the cloth's length makes both of one unit.
inline V6 wrench_of(const V3& force, const V3& arm) {
  V6 w;
  w << force, arm.cross(force);
  return w;
}

/// Projection on the wrenches about `middle` that no attachment can exert around a frame. Vertices held in the frame or
/// its neighbours count.
M6 free_of_attachments(const Motion&, std::size_t frame, const V3& middle);

}  // namespace clothbench::motion_check
