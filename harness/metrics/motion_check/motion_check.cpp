#include "metrics/motion_check/motion_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {

std::span<const Statistic> statistics() {
  using enum Check;
  static constexpr std::array kAll = std::to_array<Statistic>({
      {"finite", Kinematic, "frames whose positions are not finite"},
      {"time", Kinematic, "distance of a frame's time from the scene's, in frames"},
      {"start", Kinematic, "distance of a vertex from its initial position"},
      {"attachment", Kinematic, "distance of a pinned or attached vertex from its prescribed position"},
      {"first_step", Dynamic, "force of the first interval that nothing in reach can exert, in weights"},
      {"impulse", Dynamic, "force of one interval that nothing in reach can exert, in weights"},
      {"force", Dynamic, "force that nothing in reach can exert, in two of three intervals, in weights"},
      {"friction", Dynamic, "contact force outside Coulomb's cone, in two of three intervals, in weights"},
      {"sliding", Dynamic,
       "mean force along a face that the cloth rests or slides on, against Coulomb's law, in weights"},
      {"mean_force", Dynamic, "mean force of intervals without contact that no attachment can exert, in weights"},
      {"hinge", Dynamic, "unexplained moment on the cloth beyond a line, about that line"},
      {"energy", Dynamic, "energy above the energy at the start, if only the cloth moves"},
      {"rise", Dynamic, "energy above an earlier frame's, while no collider or attachment can add any"},
      {"speed", Dynamic, "speed of a vertex over the speed that falls, colliders and strain can cause"},
      {"speed_change", Dynamic, "change of velocity in one interval over the speed that the scene can cause"},
      {"strain", Dynamic, "elastic energy over what gravity, colliders and attachments can supply"},
      {"tear", Dynamic, "change of an edge's strain in one interval over the change of the other edges' strain"},
      {"compression", Dynamic, "mean compression of edges over what the weight can cause"},
      {"spike", Dynamic, "displacement of a single vertex for a single frame"},
      {"freeze", Dynamic, "loss of speed of the whole cloth in a single frame"},
      {"stuck", Dynamic, "vertices without contact at exactly constant positions while the cloth moves"},
      {"crossing", Continuous, "points that pass through the cloth or a surface between two frames"},
      {"depth", Continuous, "depth of a vertex in a collider"},
      {"self_crossing", Continuous, "length over which the cloth crosses itself, beyond the start's"},
      {"free_motion", Present, "distance from free fall before a collider is in reach"},
      {"support", Present, "force on cloth at rest that nothing in reach can exert, in weights"},
  });
  static_assert(kAll.size() == kStatistics);
  return kAll;
}

const char* name_of(Check check) {
  static constexpr std::array kNames = {"kinematic", "dynamic", "continuous", "present"};
  return kNames[static_cast<std::size_t>(check)];
}

namespace {

/// End time [s] of a frame; frames after the scene's end have the duration of equal frames.
double time_of(const TimeSpan& t, std::size_t frame) {
  const int k = static_cast<int>(frame), beyond = k - t.frames();
  return beyond > 0 ? t.at(t.frames()) + beyond * t.dt() : t.at(k);
}

void check_attachments(const Motion& m, Bodies&, Findings& found) {
  const double tolerance_m = 4 * m.resolution_m;
  const std::vector<double> start = initial_positions(m.scene);
  const auto start_of = [&](std::size_t v) { return V3(V3::Map(start.data() + 3 * v)); };
  for (std::size_t v = 0; v < m.vertices; ++v) found.add("start", (m.at(0, v) - start_of(v)).norm() / tolerance_m, 0);
  if (!m.has_attachments()) return;
  found.define("attachment");
  for (std::size_t k = 0; k < m.frames; ++k) {
    for (const std::uint32_t v : m.scene.pins.vertices)
      found.add("attachment", (m.at(k, v) - start_of(v)).norm() / tolerance_m, k);
    const FrameMotion* now = m.scripted(k);
    for (std::size_t g = 0; g < m.scene.grips.vertices.size(); ++g) {
      const std::uint32_t v = m.scene.grips.vertices[g];
      if (now == nullptr)
        found.add("attachment", (m.at(k, v) - start_of(v)).norm() / tolerance_m, k);
      else if (now->grip_held[g])
        found.add("attachment", (m.at(k, v) - to_v3(now->grip_position_m[g])).norm() / tolerance_m, k);
    }
  }
}

void check_passage(const Motion& m, Bodies& bodies, Findings& found) {
  if (bodies.empty()) return;
  found.define("crossing");
  found.define("depth");
  for (std::size_t k = 0; k < m.frames; ++k) {
    found.add("depth", bodies.depth_ratio(k), k);
    if (k > 0) found.add("crossing", bodies.passages(k) / kCrossingTolerance, k);
  }
}

/// Beyond its start, a cloth with self-collision may cross itself over at most half the length of a cell.
void check_self(const Motion& m, Bodies&, Findings& found) {
  if (!(m.scene.cloth.self_collision.thickness_m > 0) || !kWithContactMetrics) return;
  found.define("self_crossing");
  double start_m = 0;
  std::vector<double> x(3 * m.vertices);
  for (std::size_t k = 0; k < m.frames; ++k) {
    for (std::size_t v = 0; v < m.vertices; ++v) V3::Map(x.data() + 3 * v) = m.at(k, v);
    const double length_m = self_contact(x, m.triangles).length_m;
    if (k == 0) start_m = length_m;
    found.add("self_crossing", (length_m - start_m) / (m.cell_m / 2), k);
  }
}

}  // namespace

std::span<const Part> parts() {
  static constexpr std::array kAll = std::to_array<Part>({{"attachments", check_attachments},
                                                          {"momentum", check_momentum},
                                                          {"hinges", check_hinges},
                                                          {"limits", check_limits},
                                                          {"smoothness", check_smoothness},
                                                          {"passages", check_passage},
                                                          {"self", check_self}});
  return kAll;
}

std::vector<Finding> verify(const Scene& scene, const Frames& frames, std::span<const double> contact_offsets_m) {
  const Motion motion(scene, frames);
  Findings found;
  for (std::size_t k = 0; k < motion.frames; ++k)
    for (std::size_t v = 0; v < motion.vertices; ++v)
      if (!motion.at(k, v).allFinite()) {
        found.add("finite", std::numeric_limits<double>::infinity(), k);
        return found.take();
      }
  found.define("finite");
  found.define("time");
  for (std::size_t k = 0; k < motion.frames; ++k)
    found.add("time", std::abs(frames.time_s[k] - time_of(scene.time, k)) / (0.01 * scene.time.dt()), k);
  if (motion.frames == 0) return found.take();
  const std::unique_ptr<Bodies> bodies = bodies_of(motion, contact_offsets_m);
  for (const Part& part : parts()) part.run(motion, *bodies, found);
  return found.take();
}

const Finding* worst(std::span<const Finding> findings) {
  const Finding* out = nullptr;
  for (const Finding& f : findings)
    if (out == nullptr || (!(f.ratio <= out->ratio) && !std::isnan(out->ratio))) out = &f;
  return out;
}

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

std::vector<bool> Motion::is_held(std::size_t frame) const {
  std::vector<bool> out(vertices, false);
  for (const std::uint32_t v : held(frame)) out[v] = true;
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
