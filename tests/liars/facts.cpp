#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lies.hpp"
#include "metrics/motion_check/bodies.hpp"

namespace clothbench::liars {
namespace {

/// Wrenches that attachments leave: 6 less the rank of forces at the held vertices of the start.
int equations_left(const motion_check::Motion& m) {
  const std::vector<std::uint32_t> held = m.held(0);
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  if (held.empty()) return 6;
  V3 middle = V3::Zero();
  for (const std::uint32_t v : held) middle += m.at(0, v) / static_cast<double>(held.size());
  for (const std::uint32_t v : held)
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Matrix<double, 6, 1> w;
      w << V3::Unit(axis), ((m.at(0, v) - middle) / m.length_m).cross(V3::Unit(axis));
      gram += w * w.transpose();
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(gram);
  int rank = 0;
  for (int i = 0; i < 6; ++i) rank += eigen.eigenvalues()[i] > 1e-6 * eigen.eigenvalues()[5];
  return 6 - rank;
}

double rms_way(const motion_check::Motion& m, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t v = 0; v < m.vertices; ++v) sum += (m.at(to, v) - m.at(from, v)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(m.vertices));
}

/// Of the mean of the vertices, between a frame and the one before it.
V3 mean_velocity(const motion_check::Motion& m, std::size_t frame) {
  V3 sum = V3::Zero();
  for (std::size_t v = 0; v < m.vertices; ++v) sum += m.at(frame, v) - m.at(frame - 1, v);
  return sum / (m.dt(frame) * static_cast<double>(m.vertices));
}

/// Whether all colliders are planes, and one is steep or the cloth lands too fast to stop in a tenth of a second.
bool slides(const motion_check::Motion& m, const Facts& f) {
  bool out = false;
  for (const Collider& c : m.scene.colliders) {
    if (c.shape != Collider::Shape::Plane || c.moves()) return false;
    const V3 normal = motion_check::to_v3(c.normal);
    const V3 landing =
        f.first_touch < f.frames ? mean_velocity(m, std::max<std::size_t>(f.first_touch, 1)) : V3::Zero();
    const double across = (landing - landing.dot(normal) * normal).norm();
    out = out || normal.dot(f.up) < 0.98 || across > 0.1 * c.friction * m.weight_unit;
  }
  return out;
}

}  // namespace

Facts facts_of(const Motion& motion) {
  const Scene& s = *motion.scene;
  const motion_check::Motion m(s, {motion.time_s, motion.position});
  motion_check::Bodies bodies(m, motion.contact_offsets_m);
  Facts f;
  f.falls = m.gravity.norm() > 0;
  f.up = f.falls ? V3(-m.gravity.normalized()) : V3(V3::UnitY());
  f.attached = m.has_attachments();
  f.equations = equations_left(m);
  f.solid = !s.colliders.empty();
  f.self = s.cloth.self_collision.thickness_m > 0;
  f.length_m = m.length_m;
  f.frame_s = s.time.dt();
  for (const Collider& c : s.colliders) f.mover = f.mover || c.moves();
  f.frames = f.first_touch = f.at_rest = f.fastest = f.deepest_touch = m.frames;
  std::size_t most = 0;
  std::vector<bool> air(m.frames, true);
  for (std::size_t k = 0; k < m.frames; ++k) {
    const std::size_t count = f.solid ? bodies.contacts(k).size() : 0;
    air[k] = count == 0;
    if (count > 0) f.first_touch = std::min(f.first_touch, k);
    if (f.mover && count > most) most = count, f.deepest_touch = k;
    if (k == 0) continue;
    const double speed = rms_way(m, k - 1, k) / m.dt(k);
    if (f.fastest == m.frames || speed > f.speed_m_per_s) f.fastest = k, f.speed_m_per_s = speed;
  }
  for (std::size_t k = 3; k + 3 < m.frames; ++k)
    if (air[k - 2] && air[k - 1] && air[k] && air[k + 1] && air[k + 2]) f.air.push_back(k);
  f.slides = slides(m, f);
  for (std::size_t k = m.frames; k-- > 0 && rms_way(m, k, m.frames - 1) < 0.002 * m.length_m;) f.at_rest = k;
  return f;
}

bool Right::held(std::size_t frame, std::size_t vertex) const {
  const Scene& s = *motion.scene;
  const auto in = [&](const std::vector<std::uint32_t>& list) { return std::find(list.begin(), list.end(), vertex); };
  if (in(s.pins.vertices) != s.pins.vertices.end()) return true;
  const auto grip = in(s.grips.vertices);
  if (grip == s.grips.vertices.end()) return false;
  if (s.motion.empty()) return true;
  const FrameMotion& now = s.motion[std::min(frame, s.motion.size() - 1)];
  return now.grip_held[static_cast<std::size_t>(grip - s.grips.vertices.begin())] != 0;
}

double difference_m(const Right& right, const Motion& other) {
  const Motion& m = right.motion;
  if (other.frames() != m.frames()) return INFINITY;
  double most = 0;
  for (std::size_t i = 0; i < m.position.size(); i += 3) {
    const V3 d = (Eigen::Vector3f::Map(&m.position[i]) - Eigen::Vector3f::Map(&other.position[i])).cast<double>();
    if (!d.allFinite()) return INFINITY;
    most = std::max(most, d.norm());
  }
  return most;
}

}  // namespace clothbench::liars
