#include "runner/conformance.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "metrics/metric.hpp"
#include "runner/frame_loop.hpp"
#include "runner/solver_run.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr int kFrames = 6;
constexpr double kStill = 1e-6;   // fraction of the cloth's width
constexpr double kHeld_m = 1e-3;  // float32 and compliant attachments; a wrong attachment is off by centimetres
constexpr std::size_t kFaultsKept = 8;

/// One case while it runs.
class Conformer {
 public:
  Conformer(const SolverEntry& entry, const Scene& scene, ClothSolver& solver)
      : info_(entry.info), scene_(scene), solver_(solver), rest_(initial_positions(scene)), plan_(solver.plan()) {}

  ConformanceResult run(const ConformanceCase& c, double limit_s) {
    check_plan();
    check_start();
    if (!c.profile.empty()) check_profile(c.profile);
    step(c.whole ? scene_.time.frames() : kFrames, limit_s);
    check_cost();
    check_reset();
    if (const int messages = solver_.validation_messages(); messages > 0)
      fault(fmt::format("{} validation messages", messages));
    return std::move(out_);
  }

 private:
  void fault(std::string what) {
    if (out_.faults.size() < kFaultsKept) out_.faults.push_back(std::move(what));
  }

  void check_plan() {
    if (const std::string wrong = check_stages(scene_, info_, plan_); !wrong.empty()) fault("stages: " + wrong);
    if (!(scene_.needs & kColliderFeatures).empty()) return;
    for (const BufferPlan& b : plan_.buffers)
      if (b.name.find("olli") != std::string::npos)
        fault("buffer " + b.name + ": the scene has nothing to collide with");
  }

  void check_start() {
    solver_.read_state(start_);
    if (start_.position.size() != rest_.size() || start_.velocity.size() != rest_.size())
      return fault(fmt::format("read_state: expected {} positions and velocities; found {} and {}", rest_.size(),
                               start_.position.size(), start_.velocity.size()));
    double off = 0;
    for (std::size_t k = 0; k < rest_.size(); ++k) off = max_or_nan(off, std::abs(start_.position[k] - rest_[k]));
    if (!(off <= kStill * scene_.cloth.width_m))
      fault(fmt::format("start: a vertex is {:.3g} m from its initial position in the scene", off));
  }

  void check_profile(const std::string& profile) {
    const DeviceInfo device = solver_.device();
    if (device.name.find(profile) == std::string::npos)
      fault("device " + device.name + ": its name does not contain " + profile);
    if (json_from(device.properties_json).value("device_profile", "") != profile)
      fault("device " + device.name + ": its properties do not state device_profile " + profile);
  }

  void step(int frames, double limit_s) {
    FrameLoop loop(solver_, scene_, {.frames = frames});
    while (loop.next()) {
      ++out_.frames;
      solver_.read_state(now_);
      if (!check_frame(loop.index())) return;
      if (limit_s > 0 && loop.elapsed_s() > limit_s) return;
    }
    if (loop.failed()) fault(fmt::format("frame {}: step failed", loop.index()));
  }

  /// False if later frames would repeat the same fault.
  bool check_frame(int frame) {
    double pins = 0, grips = 0;
    for (std::size_t k = 0; k < now_.position.size(); ++k)
      if (!std::isfinite(now_.position[k]) || !std::isfinite(now_.velocity[k])) {
        fault(fmt::format("frame {}: vertex {} is not finite", frame, k / 3));
        return false;
      }
    for (std::uint32_t v : scene_.pins.vertices)
      for (std::size_t k = 0; k < 3; ++k)
        pins = max_or_nan(pins, std::abs(now_.position[3 * v + k] - rest_[3 * v + k]));
    if (!info_.ignores.has(Feature::Pins) && !(pins <= kStill * scene_.cloth.width_m)) {
      fault(fmt::format("frame {}: a pinned vertex has moved by {:.3g} m", frame, pins));
      return false;
    }
    if (const FrameMotion* motion = scene_.motion_after(frame); motion != nullptr)
      for (std::size_t g = 0; g < motion->grip_position_m.size(); ++g) {
        const Vec3 x = vertex_at(now_.position, scene_.grips.vertices[g]);
        if (motion->grip_held[g] != 0) grips = max_or_nan(grips, length(minus(x, motion->grip_position_m[g])));
      }
    if (info_.ignores.has(Feature::MovingPins) || grips <= kHeld_m) return true;
    fault(fmt::format("frame {}: an attached vertex is {:.3g} m from its hand", frame, grips));
    return false;
  }

  void check_cost() {
    const FrameCost cost = solver_.last_cost();
    const std::size_t stages = plan_.stages.size();
    for (const std::size_t found : {cost.stage_device_s.size(), cost.stage_read_B.size(), cost.stage_write_B.size()})
      if (found != stages)
        fault(fmt::format("costs of a frame: found {} values; expected {}, one per stage", found, stages));
    if (std::isfinite(cost.device_s) != info_.on_gpu)
      fault(info_.on_gpu ? "device time: missing, though the solver runs on a GPU"
                         : "device time: given, though the solver runs on the CPU");
    for (const SolverCount& c : solver_.counts())
      if (!std::isfinite(c.count)) fault(fmt::format("count {}: not finite", c.name));
  }

  void check_reset() {
    solver_.reset();
    ClothState again;
    solver_.read_state(again);
    if (again.position != start_.position || again.velocity != start_.velocity)
      fault("reset: expected a bit-identical start");
  }

  const SolverInfo& info_;
  const Scene& scene_;
  ClothSolver& solver_;
  const std::vector<double> rest_;
  const Plan plan_;
  ClothState start_, now_;
  ConformanceResult out_;
};

std::string name_of_case(const ConformanceCase& c) {
  if (c.whole) return "whole scene";
  if (!c.relation.empty()) return c.relation;
  return c.sides + " " + c.grid + (c.mesh ? " mesh" : "") + (c.profile.empty() ? "" : " " + c.profile);
}

json row_of(const std::string& scene, const std::string& status, const std::vector<std::string>& faults) {
  return {{"scene", scene},    {"status", status},     {"cases", 0},      {"skipped", 0},
          {"frames_whole", 0}, {"frames_of_scene", 0}, {"faults", faults}};
}

void count(json& row, const char* what) { row[what] = row[what].get<int>() + 1; }

/// Adds one case's results to its scene's row.
void add_case(const SolverEntry& entry, const json& settings, const DeviceOptions& device, const ConformanceCase& c,
              double limit_s, json& row) {
  count(row, "cases");
  const Scene scene = conformance_scene(c, entry.info.name);
  std::string why = conformance_skip(entry.info, scene);
  if (c.whole) row["frames_of_scene"] = scene.time.frames();
  ConformanceResult result;
  if (why.empty()) {
    try {
      result = run_conformance(entry, settings, device, scene, c, limit_s);
      why = result.unsupported;
    } catch (const UnsupportedScene& e) {
      why = entry.info.name + ": " + e.what();
    } catch (const SolverError& e) {
      result.faults = {e.what()};
    }
  }
  if (!why.empty()) {
    count(row, "skipped");
    if (row["skipped"] == row["cases"]) row["faults"] = json::array({why});
    return;
  }
  if (row["status"] == "skipped") row["faults"] = json::array();
  if (row["status"] != "FAIL") row["status"] = result.faults.empty() ? "pass" : "FAIL";
  if (c.whole) row["frames_whole"] = result.frames;
  for (const std::string& f : result.faults) row["faults"].push_back(name_of_case(c) + ": " + f);
}

}  // namespace

std::vector<ConformanceCase> conformance_cases(const std::string& scene, bool profiles) {
  std::vector<ConformanceCase> out;
  for (const char* sides : {"single", "double-duplicated", "double"})
    for (const char* grid : {"[2,2]", "[9,7]", "[17,33]"}) {  // sizes that are no multiples of a workgroup's
      out.push_back({scene, sides, grid, "", false});
      if (profiles && std::string(grid) == "[17,33]") out.push_back({scene, sides, grid, "adreno-like", false});
    }
  for (const char* sides : {"single", "double-duplicated", "double"})
    out.push_back({scene, sides, "[9,7]", "", false, true});
  for (const std::string& relation : relations_of(scene, profiles))
    out.push_back({scene, "", "", "", false, false, relation});
  out.push_back({scene, "", "", "", true});
  return out;
}

Scene conformance_scene(const ConformanceCase& c, const std::string& solver) {
  if (c.whole) return load_scene(c.scene);
  if (!c.relation.empty()) return related_scene(c.scene, c.relation);
  std::vector<std::string> overrides = {"cloth.sides=" + c.sides, "cloth.grid=" + c.grid};
  const auto is = [&](const char* word) { return c.scene.find(word) != std::string::npos; };
  // On a grid of four vertices, no vertex is near a hand.
  if (c.grid == "[2,2]" && is("stretch"))
    for (const char* hand : {"0", "1"}) overrides.push_back(std::string("grips.") + hand + ".radius_m=0.6");
  // A strip that starts over a cylinder needs edges shorter than the cylinder's diameter.
  if (c.grid != "[17,33]" && (is("capstan") || is("self-fold")))
    overrides.back() = c.grid == "[2,2]" ? "cloth.grid=[17,2]" : "cloth.grid=[17,7]";
  if (load_scene(c.scene).cloth.mesh) overrides.pop_back();  // a mesh has one size,
  if (is("garments/"))                                       // but garments have a small version
    overrides.push_back("cloth.mesh.file=assets" + c.scene.substr(c.scene.rfind('/')) + "-small.obj");
  const bool bends = solver == "reference" || solver == "xpbd";
  return c.mesh ? as_mesh(load_scene(c.scene, overrides), bends) : load_scene(c.scene, overrides);
}

std::string conformance_skip(const SolverInfo& info, const Scene& s) {
  // The reference solver's constraints are exact; with inextensible diagonals they would exceed the degrees of freedom.
  if (info.name == "reference" && !s.material.membrane_stiffness_N_per_m &&
      (s.needs.has(Feature::Shear) || s.cloth.mesh))
    return "reference would diverge: more constraints than degrees of freedom";
  if (info.name == "xpbd" && s.cloth.mesh && s.needs.has(Feature::SelfCollision))
    return "xpbd supports self_collision only on grids";
  if (s.cloth.mesh && s.needs.has(Feature::Bend) && (info.name == "paper" || info.name.starts_with("bullet-")))
    return info.name + " has no resistance to bending for triangle meshes";
  return missing_features(info, s.needs);
}

ConformanceResult run_conformance(const SolverEntry& entry, const json& settings, const DeviceOptions& device,
                                  const Scene& scene, const ConformanceCase& c, double limit_s) {
  if (!c.relation.empty()) return run_relation(entry, settings, device, scene, c);
  DeviceOptions options = device;
  if (!c.profile.empty()) options.profile = c.profile;
  const auto solver = entry.make(settings, options);
  ConformanceResult refused;
  if (solver->info().name != entry.info.name) refused.faults = {"info: the name differs from the solver's"};
  if (!(entry.info.supports & entry.info.ignores).empty())
    refused.faults.push_back("supports, ignores: a feature is in both");
  try {
    solver->load(scene);
  } catch (const UnsupportedScene& e) {
    refused.unsupported = entry.info.name + ": " + e.what();
    return refused;
  }
  ConformanceResult out = Conformer(entry, scene, *solver).run(c, limit_s);
  out.faults.insert(out.faults.begin(), refused.faults.begin(), refused.faults.end());
  return out;
}

std::vector<std::string> conformance_scenes(const std::vector<std::string>& chosen) {
  const std::vector<std::string> all = scene_names({"paper", "contact", "validation", "conformance"});
  for (const std::string& name : chosen)
    if (!contains(all, name)) throw Error("--scene " + name + ": no such scene" + nearest_known(name, all));
  return chosen.empty() ? all : chosen;
}

std::string conformance_text(const std::string& solver, const json& r) {
  const std::string status = r["status"];
  const int skipped = r["skipped"], frames = r["frames_whole"], all_frames = r["frames_of_scene"];
  std::string text = fmt::format("{} cases", r["cases"].get<int>() - skipped);
  if (skipped > 0) text += fmt::format(", {} skipped", skipped);
  if (frames > 0 && frames < all_frames)
    text += fmt::format(", first {} of {} frames", frames, all_frames);
  else if (frames > 0)
    text += fmt::format(", all {} frames", frames);
  const auto faults = r["faults"].get<std::vector<std::string>>();
  if (status == "skipped" && !faults.empty()) text = faults.front();
  text = fmt::format("{:<7} {} {}: {}\n", status, solver, r["scene"].get<std::string>(), text);
  if (status != "FAIL") return text;
  for (const std::string& f : faults) text += fmt::format("        {}\n", f);
  return text;
}

json conformance_answer(const json& request) {
  const SolverEntry& entry = find_solver(request.at("solver"));
  const std::string scene = request.at("scene");
  json row = row_of(scene, "skipped", {});
  for (const ConformanceCase& c : conformance_cases(scene, entry.info.on_gpu && !is_external(entry.info)))
    if (request.at("whole").get<bool>() || !c.whole)
      add_case(entry, request.at("settings"), device_from_json(request.at("device")), c, request.at("limit_s"), row);
  return row;
}

json ask_conformance(Worker& worker, const SolverEntry& entry, const json& settings, const DeviceOptions& device,
                     const std::string& scene, bool whole, double limit_s) {
  const json request = {{"solver", entry.info.name},
                        {"settings", settings},
                        {"device", device_to_json(device)},
                        {"scene", scene},
                        {"whole", whole},
                        {"limit_s", limit_s}};
  const WorkerAnswer answer = guarded(worker, "conformance", request, conformance_answer);
  return answer.end ? row_of(scene, "FAIL", {"crashed: " + answer.end->text()}) : answer.value;
}

}  // namespace clothbench
