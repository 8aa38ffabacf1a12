#include "metrics/motion_check/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "clothbench/error.hpp"
#include "clothbench/motion.hpp"

namespace clothbench::motion_check {

Flight::Flight(double before_s, double after_s, double c) {
  if (c * std::max(before_s, after_s) < 1e-6) {
    a1 = before_s, a2 = after_s;
    b1 = -before_s * before_s / 2, b2 = after_s * after_s / 2;
    return;
  }
  a1 = std::expm1(c * before_s) / c, a2 = -std::expm1(-c * after_s) / c;
  b1 = (before_s - a1) / c, b2 = (after_s - a2) / c;
}

Motion::Motion(const Scene& s, const Frames& f)
    : scene(s), vertices(s.cloth.vertex_count()), frames(f.time_s.size()), time_s_(f.time_s), position_(f.position) {
  if (position_.size() != 3 * vertices * frames)
    throw Error("motion check: the number of positions differs from " + std::to_string(frames) + " frames of " +
                std::to_string(vertices) + " vertices");
  masses_kg = vertex_masses(s);
  mass_kg = std::accumulate(masses_kg.begin(), masses_kg.end(), 0.0);
  length_m = std::max(s.cloth.width_m, s.cloth.height_m);
  cell_m = std::max(s.cloth.du(), s.cloth.dv());
  resolution_m = kResolution * length_m;
  gravity = to_v3(s.gravity_m_per_s2);
  weight_unit = gravity.norm() > 0 ? gravity.norm() : 9.81;
  edges = clothbench::edges(s.cloth, EdgeKind::Structural);
  triangles = clothbench::triangles(s.cloth);
  start_velocity = initial_velocities(s);
  for (std::size_t v = 0; v < vertices; ++v) start_speed = std::max(start_speed, start_velocity_of(v).norm());
  even = s.time.ends_s.empty();
  for (std::size_t k = 1; k < frames; ++k) {
    const FrameMotion *was = scripted(k - 1), *now = scripted(k);
    if (was == nullptr || now == nullptr) break;
    for (std::size_t g = 0; g < now->grip_held.size(); ++g)
      if (now->grip_held[g] && was->grip_held[g])
        grip_speed =
            std::max(grip_speed, (to_v3(now->grip_position_m[g]) - to_v3(was->grip_position_m[g])).norm() / dt(k));
  }
}

const FrameMotion* Motion::scripted(std::size_t frame) const {
  if (scene.motion.empty()) return nullptr;
  return &scene.motion[std::min(frame, scene.motion.size() - 1)];
}

std::vector<std::uint32_t> Motion::held(std::size_t frame) const {
  std::vector<std::uint32_t> out = scene.pins.vertices;
  const FrameMotion* now = scripted(frame);
  for (std::size_t g = 0; g < scene.grips.vertices.size(); ++g)
    if (now == nullptr || now->grip_held[g]) out.push_back(scene.grips.vertices[g]);
  return out;
}

Finding& Findings::of(const char* name) {
  for (Finding& f : found_)
    if (std::strcmp(f.statistic->name, name) == 0) return f;
  for (const Statistic& s : statistics())
    if (std::strcmp(s.name, name) == 0) return found_.emplace_back(Finding{&s, 0, 0});
  throw Error(std::string("motion check: no statistic ") + name);
}

void Findings::define(const char* name) { of(name); }

void Findings::add(const char* name, double ratio, std::size_t frame) {
  Finding& f = of(name);
  if (ratio <= f.ratio || std::isnan(f.ratio)) return;
  f.ratio = ratio;
  f.frame = static_cast<int>(frame);
}

}  // namespace clothbench::motion_check
