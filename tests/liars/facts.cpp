#include <algorithm>
#include <cmath>

#include "lies.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench::liars {
namespace {

using motion_check::M6, motion_check::V6, motion_check::wrench_of;

V3 middle_of(const motion_check::Motion& m, std::size_t frame, std::span<const std::uint32_t> vertices) {
  V3 sum = V3::Zero();
  for (const std::uint32_t v : vertices) sum += m.at(frame, v) / static_cast<double>(vertices.size());
  return sum;
}

double rms_way(const motion_check::Motion& m, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t v = 0; v < m.vertices; ++v) sum += (m.at(to, v) - m.at(from, v)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(m.vertices));
}

/// Mean velocity of the vertices between the previous frame and this one.
V3 mean_velocity(const motion_check::Motion& m, std::size_t frame) {
  V3 sum = V3::Zero();
  for (std::size_t v = 0; v < m.vertices; ++v) sum += m.at(frame, v) - m.at(frame - 1, v);
  return sum / (m.dt(frame) * static_cast<double>(m.vertices));
}

/// Whether all colliders are planes, and one is steep or the cloth lands too fast to stop within a tenth of a second.
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
  const std::unique_ptr<motion_check::Bodies> own = motion_check::bodies_of(m, motion.contact_offsets_m);
  motion_check::Bodies& bodies = *own;
  Facts f;
  f.falls = m.gravity.norm() > 0;
  f.up = f.falls ? V3(-m.gravity.normalized()) : V3(V3::UnitY());
  f.attached = m.has_attachments();
  const std::vector<std::uint32_t> held = m.held(0);
  f.equations = static_cast<int>(std::lround(motion_check::free_of_attachments(m, 0, middle_of(m, 0, held)).trace()));
  f.gravity = m.gravity.norm();
  const double Y = s.material.membrane_stiffness_N_per_m.value_or(1e4);
  f.soft_strain = 0.02 + 2 * m.mass_kg * m.weight_unit / (m.length_m * Y) +
                  std::max(bodies.speed(), m.grip_speed) * std::sqrt(s.cloth.areal_density_kg_per_m2 / Y);
  double tensile = 0;
  for (std::size_t k = 0; k < m.frames; ++k) {
    double sum = 0;
    for (const Edge& e : m.edges) sum += std::pow(std::max(m.strain(k, e), 0.0), 2);
    tensile = std::max(tensile, sum / static_cast<double>(std::max<std::size_t>(m.edges.size(), 1)));
  }
  f.soft_strain += std::sqrt(tensile);
  f.collider = !s.colliders.empty();
  for (std::size_t c = 0; c < s.colliders.size(); ++c) {
    const double said = c < motion.contact_offsets_m.size() ? motion.contact_offsets_m[c] : 0;
    f.offset_m = std::max({f.offset_m, s.colliders[c].margin_m, std::isfinite(said) ? said : 0});
  }
  f.self = s.cloth.self_collision.thickness_m > 0;
  f.length_m = m.length_m;
  f.frame_s = s.time.dt();
  for (const Collider& c : s.colliders) f.kinematic = f.kinematic || c.moves();
  f.frames = f.first_touch = f.at_rest = f.fastest = f.deepest_touch = m.frames;
  std::size_t most = 0;
  std::vector<bool> air(m.frames, true);
  for (std::size_t k = 0; k < m.frames; ++k) {
    const std::size_t count = f.collider ? bodies.contacts(k).size() : 0;
    air[k] = count == 0;
    if (count > 0) f.first_touch = std::min(f.first_touch, k);
    if (f.kinematic && count > most) most = count, f.deepest_touch = k;
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

bool changes_force(const Right& right, const Motion& told) {
  if (told.frames() != right.motion.frames()) return true;
  const Scene& scene = *right.motion.scene;
  const motion_check::Motion was(scene, {right.motion.time_s, right.motion.position});
  const motion_check::Motion is(scene, {told.time_s, told.position});
  const std::vector<std::uint32_t> held = was.held(0);
  std::vector<std::uint32_t> about = held;
  for (std::uint32_t v = 0; held.empty() && v < was.vertices; ++v) about.push_back(v);
  const M6 keep = motion_check::free_of_attachments(was, 0, middle_of(was, 0, about));
  // Sliding on a face has a tighter tolerance than contact with colliders of other shapes.
  const double lasting = right.facts.slides ? 0.035 : 0.05;
  // A moving collider may exert any force on attached cloth.
  const std::vector<std::size_t>& air = right.facts.air;
  const auto touched = [&](std::size_t k) {
    return right.facts.attached && right.facts.kinematic && !std::binary_search(air.begin(), air.end(), k);
  };
  std::vector<V6> sums = {V6::Zero()};
  std::vector<double> hidden = {0};
  for (std::size_t k = 0; k + 1 < was.frames; ++k) {
    const double before = was.dt(k), after = was.dt(k + 1);
    const motion_check::Flight flight(before, after, scene.material.damping_per_s);
    const V3 middle = middle_of(was, held.empty() ? k : 0, about);
    const auto add = [&](const motion_check::Motion& m, double sign, V6& to) {
      for (std::size_t v = 0; v < m.vertices; ++v) {
        const V3 ahead = m.at(k + 1, v) - m.at(k, v);
        const V3 force = k == 0 ? V3((ahead - flight.a2 * m.start_velocity_of(v)) / (after * after))
                                : flight.unexplained(m.at(k, v) - m.at(k - 1, v), ahead, m.gravity);
        to += sign * m.masses_kg[v] / (m.mass_kg * m.weight_unit) *
              wrench_of(force, (m.at(k, v) - middle) / (m.length_m / 2));
      }
    };
    V6 change = V6::Zero();
    double bent = 0;  // error that motion within a frame may explain
    add(is, 1, change), add(was, -1, change);
    for (std::size_t v = 0; v < is.vertices; ++v) {
      const V3 ahead = (is.at(k + 1, v) - is.at(k, v)) / after;
      const V3 behind = k == 0 ? is.start_velocity_of(v) : V3((is.at(k, v) - is.at(k - 1, v)) / before);
      bent += is.masses_kg[v] * ((ahead + behind) / 2).norm() * ((ahead - behind) / after - is.gravity).norm();
    }
    if (touched(k)) {
      sums = {V6::Zero()}, hidden = {0};
      continue;
    }
    sums.push_back(sums.back() + keep * change);
    hidden.push_back(hidden.back() + bent * after / 3 / (is.mass_kg * is.weight_unit * is.length_m / 2));
    for (const std::size_t span : {1, 3, 12}) {
      if (span + 1 > sums.size() || (span > 1 && span == k + 1)) continue;
      const double n = static_cast<double>(span);
      const std::size_t from = sums.size() - 1 - span;
      const double change_mean = ((sums.back() - sums[from]).norm() - hidden.back() + hidden[from]) / n;
      if (change_mean > (span == 1 ? 0.55 : lasting) + was.noise(k, was.vertices) / n) return true;
    }
  }
  return false;
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

std::size_t first_difference(const Right& right, const Motion& told) {
  const std::size_t numbers = 3 * told.vertices();
  const auto at = std::mismatch(told.position.begin(), told.position.end(), right.motion.position.begin(),
                                right.motion.position.end());
  return static_cast<std::size_t>(at.first - told.position.begin()) / numbers;
}

double accelerated_m(const Motion& m, std::size_t frame) {
  double most = 0;
  for (std::size_t k = std::max<std::size_t>(frame, 3) - 2; k < std::min(frame + 3, m.frames() - 1); ++k)
    for (std::size_t v = 0; v < m.vertices(); ++v)
      for (std::size_t i = 0; i < 3; ++i)
        most = std::max(most, std::abs(m.at(k + 1, v)[i] - 2 * m.at(k, v)[i] + m.at(k - 1, v)[i]));
  return most;
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
