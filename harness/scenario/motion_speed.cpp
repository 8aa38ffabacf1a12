#include <algorithm>
#include <cmath>

#include "clothbench/motion.hpp"

namespace clothbench {
namespace {

bool jumps_at(const Scene& scene, std::size_t frame) {
  return std::any_of(scene.jumps.begin(), scene.jumps.end(),
                     [&](const Jump& j) { return static_cast<std::size_t>(j.frame) == frame; });
}

std::vector<double> speeds_of(const Scene& scene, bool with_recorded) {
  constexpr std::size_t kLooked = 64;
  std::vector<double> most(scene.motion.size(), 0);
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    if (!c.moves() || (c.recorded && !with_recorded)) continue;
    ColliderMesh some;
    if (c.mesh)
      for (std::size_t v = 0; v < c.mesh->vertex_count();
           v += std::max<std::size_t>(1, c.mesh->vertex_count() / kLooked)) {
        some.positions.insert(some.positions.end(), &c.mesh->positions[3 * v], &c.mesh->positions[3 * v] + 3);
        some.joints.push_back(c.mesh->joints[v]);
        some.weights.push_back(c.mesh->weights[v]);
        some.joint_count = c.mesh->joint_count;
      }
    const auto points = [&](const ColliderPose& pose) {
      if (c.mesh) return posed_positions(some, pose);
      std::vector<double> x;
      for (const Capsule& s : pose.capsules)
        for (const Vec3& p : {s.a_m, s.b_m}) x.insert(x.end(), p.begin(), p.end());
      return x;
    };
    for (std::size_t f = 1; f < scene.motion.size(); ++f) {
      if (jumps_at(scene, f)) continue;
      const std::vector<double> was = points(scene.motion[f - 1].colliders[k]),
                                is = points(scene.motion[f].colliders[k]);
      const double dt = scene.time.dt_after(static_cast<int>(f) - 1);
      for (std::size_t x = 0; x < is.size(); x += 3)
        most[f] = std::max(most[f], std::hypot(is[x] - was[x], is[x + 1] - was[x + 1], is[x + 2] - was[x + 2]) / dt);
    }
  }
  return most;
}

std::vector<double> grip_speeds(const Scene& scene) {
  std::vector<double> most(scene.motion.size(), 0);
  for (std::size_t f = 1; f < scene.motion.size(); ++f) {
    const double dt = scene.time.dt_after(static_cast<int>(f) - 1);
    for (std::size_t g = 0; g < scene.motion[f].grip_position_m.size(); ++g) {
      const Vec3 &a = scene.motion[f - 1].grip_position_m[g], &b = scene.motion[f].grip_position_m[g];
      if (scene.motion[f].grip_held[g] != 0)
        most[f] = std::max(most[f], std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) / dt);
    }
  }
  return most;
}

double greatest(const std::vector<double>& speeds) {
  return speeds.empty() ? 0 : *std::max_element(speeds.begin(), speeds.end());
}

}  // namespace

std::vector<double> driving_speeds_m_per_s(const Scene& scene) {
  std::vector<double> most = speeds_of(scene, true);
  const std::vector<double> held = grip_speeds(scene);
  std::transform(most.begin(), most.end(), held.begin(), most.begin(),
                 [](double a, double b) { return std::max(a, b); });
  return most;
}

double collider_speed_m_per_s(const Scene& scene) { return greatest(speeds_of(scene, true)); }

double scripted_collider_speed_m_per_s(const Scene& scene) { return greatest(speeds_of(scene, false)); }

double grip_speed_m_per_s(const Scene& scene) { return greatest(grip_speeds(scene)); }

double grip_strain(const Scene& scene) {
  if (scene.motion.empty()) return 0;
  const auto apart = [](const FrameMotion& m, std::size_t g) {
    const Vec3 &a = m.grip_position_m[0], &b = m.grip_position_m[g];
    return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  };
  const FrameMotion& start = scene.motion.front();
  double most = 0;
  for (const FrameMotion& m : scene.motion)
    for (std::size_t g = 1; g < m.grip_position_m.size(); ++g)
      if (m.grip_held[0] != 0 && m.grip_held[g] != 0 && apart(start, g) > 0)
        most = std::max(most, apart(m, g) / apart(start, g) - 1);
  return most;
}

}  // namespace clothbench
