#include "runner/metamorphic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/sha256.hpp"
#include "clothbench/restart_after.hpp"
#include "clothbench/unsupported_scene.hpp"
#include "metrics/metric.hpp"
#include "metrics/registry.hpp"
#include "runner/environment.hpp"
#include "runner/frame_loop.hpp"
#include "scenario/change.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kSame = 1e-4, kNothing = 1e-6;
constexpr double kFar_m = 100;

struct Failed {
  Outcome outcome;
};

/// Every frame's positions and velocities.
using Trace = std::vector<ClothState>;

/// Onto `out`: the state as it is, and after every frame that is still lacking.
Trace trace_of(ClothSolver& solver, const Scene& s, Trace out = {}) {
  FrameLoop loop(solver, s, {.first = static_cast<int>(out.size()), .frames = s.time.frames()});
  solver.read_state(out.emplace_back());
  while (loop.next()) solver.read_state(out.emplace_back());
  if (loop.failed()) throw Failed{outcome_of(loop.status(), loop.index())};
  return out;
}

/// What the changed run should have been: x -> map, velocities alike without the offset.
struct Expected {
  SceneChange change;
  std::vector<std::uint32_t> new_to_old;  ///< empty: as they were
};

void compare(const Trace& base, const Trace& run, const Expected& by, double longer_side_m, MetamorphicResult& out) {
  const double speed = by.change.length / by.change.time;
  for (std::size_t f = 0; f < base.size(); ++f)
    for (std::size_t v = 0; 3 * v < run[f].position.size(); ++v) {
      const std::size_t old = by.new_to_old.empty() ? v : by.new_to_old[v];
      Vec3 x{}, dx{};
      for (std::size_t k = 0; k < 3; ++k) {
        x[k] = by.change.length * base[f].position[3 * old + k];
        dx[k] = speed * base[f].velocity[3 * old + k];
      }
      x = by.change.turned(x);
      dx = by.change.turned(dx);
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double off = run[f].position[3 * v + k] - x[k];
        squared += off * off;
        if (!(off == 0 && run[f].velocity[3 * v + k] == dx[k])) out.bitwise = false;
      }
      const double distance = std::sqrt(squared) / (by.change.length * longer_side_m);
      out.distance = max_or_nan(out.distance, distance);
    }
}

class Tester {
 public:
  Tester(const SolverEntry& entry, const json& settings, const DeviceOptions& device, const Scene& scene)
      : entry_(entry),
        settings_(settings),
        device_(device),
        scene_(scene),
        json_(json::parse(scene.json)),
        side_(std::max(scene.cloth.width_m, scene.cloth.height_m)) {}

  MetamorphicResult test(const std::string& property) {
    MetamorphicResult out{property, scene_.name, "", 0, true, kSame};
    // A two-sided scene may still have a form that it knows.
    if (!supported(scene_) && property != "flip")
      return unsupported_row(out, missing_features(entry_.info, scene_.needs));
    if (!scene_.time.ends_s.empty() && changes_scene(property)) return unsupported_row(out);
    try {
      if (base_.empty() && property != "flip") base_ = run(scene_);
      if (property == "similarity-2") similar(out, 2, 2, 4, 0);
      if (property == "similarity") similar(out, 1.7, 0.6, 3.1, kSame);
      if (property == "mirror") mirror(out);
      if (property == "rotation") rotate(out);
      if (property == "renumbering") renumber(out);
      if (property == "flip") flip(out);
      if (property == "repeat") repeat(out);
      if (property == "no-op") far_colliders(out);
      if (property == "restart") restart(out);
    } catch (const UnsupportedScene& e) {
      return unsupported_row(out, e.what());
    } catch (const Failed& f) {
      out.status = "failed";
      out.outcome = f.outcome;
      out.bitwise = false;
      out.distance = std::nan("");
    }
    if (out.status.empty())
      out.status = (out.at_most == 0 ? out.bitwise : out.distance <= out.at_most) ? "pass" : "fail";
    return out;
  }

  /// Of the runs so far.
  const DeviceInfo& device() const { return ran_on_; }

 private:
  /// Scenes whose clock is uneven are made for one place, one size and one numbering.
  static bool changes_scene(const std::string& property) {
    return property != "repeat" && property != "no-op" && property != "restart";
  }

  bool supported(const Scene& s) const { return unsupported(entry_.info, s.needs).empty(); }

  static MetamorphicResult unsupported_row(MetamorphicResult out, const std::string& why = "") {
    out.status = "unsupported";
    out.outcome = {"unsupported", "ok", -1, why.empty() ? out.property + " does not apply to it" : why};
    out.bitwise = false;
    out.distance = std::nan("");
    return out;
  }

  std::unique_ptr<ClothSolver> loaded(const Scene& s) const {
    auto solver = load_solver(entry_, settings_, device_, s);
    ran_on_ = solver->device();
    return solver;
  }

  Trace run(const Scene& s) const { return trace_of(*loaded(s), s); }

  Scene made(json scenario) const {
    scenario.erase("truth");  // positions alone are compared
    return scene_from_json(std::move(scenario), scene_.source);
  }

  void changed(MetamorphicResult& out, const SceneChange& change) const {
    compare(base_, run(made(change_scene(json_, change, scene_.source))), {change, {}}, side_, out);
  }

  void similar(MetamorphicResult& out, double length, double time, double mass, double at_most) const {
    SceneChange c;
    c.length = length;
    c.time = time;
    c.mass = mass;
    out.at_most = at_most;
    changed(out, c);
  }

  void mirror(MetamorphicResult& out) const {
    SceneChange c;
    c.turn[0][0] = -1;
    changed(out, c);
  }

  void rotate(MetamorphicResult& out) const {
    // Rows of the rotations by 1 rad about (1, 2, 2)/3 and by 2.5 rad about (2, -1, 2)/3: Rodrigues' formula.
    for (const auto& [axis, angle] :
         {std::pair{Vec3{1.0 / 3, 2.0 / 3, 2.0 / 3}, 1.0}, std::pair{Vec3{2.0 / 3, -1.0 / 3, 2.0 / 3}, 2.5}}) {
      SceneChange c;
      const double s = std::sin(angle), k = 1 - std::cos(angle);
      const Vec3 cross[3] = {{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          c.turn[i][j] = (i == j ? 1 - k : 0) + s * cross[i][j] + k * axis[i] * axis[j];
      changed(out, c);
    }
  }

  void renumber(MetamorphicResult& out) const {
    for (const Renumbering by : {Renumbering::FlipU, Renumbering::FlipV, Renumbering::Transpose}) {
      Expected expected;
      const Scene other = made(renumber_scene(json_, by, scene_.source, expected.new_to_old));
      compare(base_, run(other), expected, side_, out);
    }
    allow_own_error(out, json_, base_);
  }

  /// A cloth with two sides, in the form of them that the solver knows, numbered along its other side first: vertices,
  /// edges and triangles stay where they were, normals turn. (From another corner, triangles would have the other
  /// diagonals.)
  void flip(MetamorphicResult& out) const {
    json two_sided = json_;
    for (const char* sides : {"double", "double-duplicated"}) {
      two_sided["cloth"]["sides"] = sides;
      const Scene s = made(two_sided);
      if (!supported(s)) continue;
      const Trace base = run(s);
      Expected expected;
      const Scene turned = made(renumber_scene(two_sided, Renumbering::Transpose, scene_.source, expected.new_to_old));
      compare(base, run(turned), expected, side_, out);
      allow_own_error(out, two_sided, base);
      return;
    }
    out = unsupported_row(out);
  }

  /// Twice as many frames of half the length: what a property changes must be less than what the step does. Uneven
  /// frames have no halves that a scenario can name, so that for them the strict bound stands.
  void allow_own_error(MetamorphicResult& out, json scenario, const Trace& base) const {
    if (!(out.distance > kSame) || !scene_.time.ends_s.empty()) return;
    scenario["time"]["frame_rate_hz"] = 2 * scene_.time.frame_rate_hz;
    const Trace finer = run(made(std::move(scenario)));
    Trace there;
    for (std::size_t f = 0; f < finer.size(); f += 2) there.push_back(finer[f]);
    MetamorphicResult own;
    compare(base, there, {}, side_, own);
    out.at_most = std::max(kSame, own.distance);
  }

  /// Goes on from the state half way, in a solver that was not there before.
  void restart(MetamorphicResult& out) const {
    const auto solver = loaded(scene_);
    const std::size_t half = base_.size() / 2;
    if (!restart_after(*solver, base_[half], frame_input(scene_, static_cast<int>(half) - 1))) {
      out = unsupported_row(out);
      return;
    }
    const Trace from = trace_of(*solver, scene_, {base_.begin(), base_.begin() + static_cast<std::ptrdiff_t>(half)});
    compare(base_, from, {}, side_, out);
    allow_own_error(out, json_, base_);
  }

  void repeat(MetamorphicResult& out) const {
    out.at_most = 0;
    const auto solver = loaded(scene_);
    compare(base_, trace_of(*solver, scene_), {}, side_, out);
    solver->reset();
    compare(base_, trace_of(*solver, scene_), {}, side_, out);
  }

  void far_colliders(MetamorphicResult& out) const {
    out.at_most = kNothing;
    const json at = {0, kFar_m, 0};
    const json far[] = {
        {{"type", "sphere"}, {"center_m", at}, {"radius_m", 0.5}, {"friction", 0.5}},
        {{"type", "box"}, {"center_m", at}, {"size_m", {1, 1, 1}}, {"friction", 0.5}},
        {{"type", "cylinder"}, {"center_m", at}, {"radius_m", 0.5}, {"length_m", 1}, {"sides", 12}, {"friction", 0.5}}};
    bool any = false;
    for (const json& collider : far) {
      json with = json_;
      with["colliders"].push_back(collider);
      const Scene s = made(std::move(with));
      if (!supported(s)) continue;
      any = true;
      compare(base_, run(s), {}, side_, out);
    }
    if (!any) out = unsupported_row(out);
  }

  const SolverEntry& entry_;
  const json& settings_;
  const DeviceOptions& device_;
  const Scene& scene_;
  const json json_;
  const double side_;
  Trace base_;
  mutable DeviceInfo ran_on_;
};

}  // namespace

const std::vector<MetamorphicProperty>& metamorphic_properties() {
  static const std::vector<MetamorphicProperty> all = {
      {"similarity-2", "lengths ×2, time ×2, mass ×4: the same bits"},
      {"similarity", "lengths ×1.7, time ×0.6, mass ×3.1"},
      {"mirror", "x → −x"},
      {"rotation", "the whole scene and gravity turned"},
      {"renumbering",
       "vertices numbered from another corner, or along the other side; bound: 1e-4, or the effect of "
       "frames half as long"},
      {"flip",
       "a two-sided cloth turned over: vertices and triangles in place, all normals reversed; bound: as for "
       "renumbering"},
      {"repeat", "run again, and after reset: the same bits"},
      {"no-op", "a ball, a box or a mesh 100 m away"},
      {"restart", "a new solver continues from the positions and velocities at half time; bound: as for renumbering"}};
  return all;
}

std::vector<Scene> metamorphic_scenes() {
  std::vector<Scene> out;
  for (const char* name :
       {"metamorphic/sheet", "validation/swing-strip", "validation/incline-stop", "metamorphic/drop"})
    out.push_back(load_scene(name));
  return out;
}

std::vector<MetamorphicResult> run_metamorphic(const SolverEntry& entry, const json& settings,
                                               const DeviceOptions& device, const std::vector<Scene>& scenes,
                                               const std::function<void(const std::string&)>& note) {
  std::vector<MetamorphicResult> out;
  for (const Scene& s : scenes) {
    Tester tester(entry, settings, device, s);
    for (const MetamorphicProperty& p : metamorphic_properties()) {
      if (note) note(fmt::format("{}: {} on {}", entry.info.name, p.name, s.name));
      out.push_back(tester.test(p.name));
    }
  }
  return out;
}

namespace {

constexpr const char* kProtocol = "metamorphic";

RunHeader header_of(const SolverEntry& entry, const json& settings, const std::string& setting, const Scene& scene,
                    const MetamorphicProperty& property) {
  RunHeader h;
  h.scene = scene.name + "-" + property.name;
  h.solver = entry.info.name;
  h.setting = setting;
  h.settings = settings;
  h.scenario_json = json{{"name", h.scene},
                         {"metamorphic", {{"scene", scene.name}, {"property", property.name}, {"doc", property.doc}}},
                         {"base", json::parse(scene.json)}}
                        .dump();
  h.scenario_sha256 = sha256(h.scenario_json);
  h.environment = describe_environment({}, kProtocol);
  describe_solver(entry.info, h.environment);
  return h;
}

/// The bound is a bound of the scene's, so that `check` and the table of expectations judge it.
RunRecord record_of(RunHeader header, const MetamorphicResult& r, const DeviceInfo& device, const SolverInfo& info) {
  RunRecord c;
  c.header = std::move(header);
  c.header.environment = describe_environment(device, kProtocol);
  describe_solver(info, c.header.environment);
  c.outcome = r.outcome;
  const bool judged = r.status == "pass" || r.status == "fail";
  c.summary = {{"metamorphic_distance", r.distance},
               {"metamorphic_at_most", r.at_most},
               {"metamorphic_bits_differ", !judged     ? kMissing
                                           : r.bitwise ? 0
                                                       : 1},
               {kExpect + "metamorphic_distance", !judged              ? kMissing
                                                  : r.status == "pass" ? 1
                                                                       : 0}};
  c.outcome.expect = r.status == "pass"   ? "pass"
                     : r.status == "fail" ? fmt::format("fail: {} on {}: distance {:.4g} > {:.4g}", r.property, r.scene,
                                                        r.distance, r.at_most)
                                          : "not measured";
  return c;
}

}  // namespace

std::vector<RunRecord> metamorphic_runs(Guard& guard, StudyRuns& runs, const SolverEntry& entry, const json& settings,
                                        const std::string& setting, const Scene& scene,
                                        const std::function<void(const std::string&)>& note) {
  std::vector<RunRecord> out;
  Tester tester(entry, settings, runs.device(), scene);
  for (const MetamorphicProperty& p : metamorphic_properties()) {
    if (note) note(fmt::format("{}: {} on {}", entry.info.name, p.name, scene.name));
    const RunHeader header = header_of(entry, settings, setting, scene, p);
    const PlannedRun planned{run_name(header), header.scenario_sha256, settings, &entry.info};
    const std::vector<RunRecord> some = runs.ask(guard, header, entry, [&] {
      return std::vector{runs.made(planned, [&] {
        const MetamorphicResult r = tester.test(p.name);
        return record_of(header, r, tester.device(), entry.info);
      })};
    });
    out.insert(out.end(), some.begin(), some.end());
  }
  return out;
}

}  // namespace clothbench
