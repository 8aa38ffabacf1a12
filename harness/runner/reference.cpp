#include "runner/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <future>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <utility>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "metrics/truth_errors.hpp"
#include "runner/frame_loop.hpp"
#include "runner/interrupt.hpp"
#include "runner/study_plan.hpp"
#include "runner/worker.hpp"
#include "scenario/load.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kOrder = 2;         // order of accuracy of both integrators
constexpr double kRounding = 1e-10;  // fraction of the scale; smaller differences show no order

/// The scene with two rows if all its rows move alike; a sheet with shear and a mesh are returned unchanged.
Scene two_rows(const Scene& s) {
  if (s.cloth.mesh || s.needs.has(Feature::Shear)) return s;
  Scene out = scene_from_json(json_from(s.json), s.source, {fmt::format("cloth.grid=[{},2]", s.cloth.columns)});
  out.name = s.name;
  return out;
}

struct Run {
  double value = kMissing;   ///< value at the end of the run
  double unrest = kMissing;  ///< change over the last tenth of the run
  double error = kMissing;   ///< only for a mesh: ranking error against the continuum
};

Run run_quantity(const Scene& scene, const TruthJudge& judge, const char* integrator, int substeps, double tolerance) {
  const truth::ReferenceCase& known = judge.reference_case();
  const SolverEntry& entry = find_solver("reference");
  const json settings =
      complete_settings(entry.info, {{"integrator", integrator}, {"substeps", substeps}, {"tolerance", tolerance}});
  const auto solver = load_solver(entry, settings, {}, scene);
  const int frames = scene.time.frames();
  ClothState state;
  const auto quantity = [&] {
    solver->read_state(state);
    return known.quantity(truth::column_means(scene.cloth, state.position));
  };
  const int last_tenth = frames - (frames + 9) / 10;
  double before = last_tenth == 0 ? quantity() : kMissing;
  FrameLoop loop(*solver, scene, {.frames = frames});
  std::vector<double> times_s;
  std::vector<TruthErrors> errors;
  const auto judge_mesh = [&](int frame) {
    if (!scene.cloth.mesh) return;
    solver->read_state(state);
    times_s.push_back(scene.time.at(frame));
    errors.push_back(judge.judge(frame, state));
  };
  judge_mesh(0);
  while (loop.next()) {
    if (loop.index() + 1 == last_tenth) before = quantity();
    judge_mesh(loop.index() + 1);
  }
  if (loop.failed())
    throw Error(fmt::format("{}: the reference ({}, {} substeps) failed in frame {}", scene.source, integrator,
                            substeps, loop.index()));
  const double value = quantity();
  return {value, std::abs(value - before), errors.empty() ? kMissing : judge.ranking_error(times_s, errors)};
}

struct Extrapolated {
  double value, uncertainty, order;
};

/// Richardson extrapolation; f1 is from the finest steps.
Extrapolated extrapolate(double f1, double f2, double f3, double scale) {
  const double near = f1 - f2, far = f2 - f3;
  if (std::abs(near) <= kRounding * scale) return {f1, std::abs(near), kMissing};
  const double order = std::log2(far / near);
  const bool as_declared = std::abs(order - kOrder) <= 0.5;
  const double p = as_declared ? order : kOrder, rest = near / (std::pow(2, p) - 1);
  return {f1 + rest, (as_declared ? 1.25 : 3) * std::abs(rest), order};
}

/// Null if the scene asks for no solution, or the build lacks the solver.
const SolverEntry* solver_for(const Scene& s) {
  if (s.converged.substeps > 0) return known_solver("xpbd");
  return s.reference_case.empty() ? nullptr : known_solver("reference");
}

/// Name: the scene (for people), then a short form of the rest of the key. The file contains the complete key.
fs::path cache_file(const fs::path& folder, const json& key) {
  return folder /
         fmt::format("{}-{}.json", key.at("scenario_sha256").get<std::string>(), sha256(dump(key)).substr(0, 16));
}

constexpr std::pair<const char*, double ReferenceResult::*> kScalars[] = {
    {"truth_value", &ReferenceResult::truth},
    {"truth_space_error", &ReferenceResult::space_error},
    {"reference_value", &ReferenceResult::value},
    {"reference_uncertainty", &ReferenceResult::uncertainty},
    {"reference_order_bdf2", &ReferenceResult::order_bdf2},
    {"reference_order_conservative", &ReferenceResult::order_conservative},
    {"reference_order_xpbd", &ReferenceResult::order_xpbd},
    {"reference_truth_distance", &ReferenceResult::truth_distance},
    {"reference_spread", &ReferenceResult::spread}};

}  // namespace

std::map<std::string, double> ReferenceResult::scalars() const {
  std::map<std::string, double> out;
  for (const auto& [name, member] : kScalars) out[name] = this->*member;
  return out;
}

/// Result for a scene that the reference solver cannot run: its exact solution has a closed form.
ReferenceResult closed_form(const Scene& scene) {
  const TruthJudge judge(scene);
  const truth::ReferenceCase& known = judge.reference_case();
  ReferenceResult r;
  r.truth = known.quantity(known.columns(scene.time.frames()));
  r.space_error = judge.space_error();
  return r;
}

ReferenceResult compute_reference(const Scene& whole, const ReferenceRules& rules) {
  const Scene scene = two_rows(whole);
  const TruthJudge judge(scene);
  const truth::ReferenceCase& known = judge.reference_case();
  const int frames = scene.time.frames();
  const auto per_frame = static_cast<unsigned>(std::max(1, (rules.moving_steps + frames - 1) / frames));
  ReferenceResult r;
  const int least_substeps = known.settles ? rules.settling_substeps : static_cast<int>(std::bit_ceil(per_frame));
  const double scale = known.quantity_scale;
  r.truth = known.quantity(known.columns(frames));
  r.space_error = judge.space_error();
  Extrapolated found[2];
  double coarsest = 0;
  for (int i = 0; i < 2; ++i) {
    Run f[3];
    for (int level = 0; level < 3; ++level)
      f[level] = run_quantity(scene, judge, i == 0 ? "bdf2" : "conservative", least_substeps << level, rules.tolerance);
    if (i == 0) coarsest = f[0].value;
    if (scene.cloth.mesh && !(f[2].error <= r.space_error)) r.space_error = f[2].error;
    found[i] = known.settles
                   ? Extrapolated{f[2].value, std::max(std::abs(f[2].value - f[1].value), f[2].unrest), kMissing}
                   : extrapolate(f[2].value, f[1].value, f[0].value, scale);
  }
  const double strict = run_quantity(scene, judge, "bdf2", least_substeps, rules.tolerance / 10).value;
  r.order_bdf2 = found[0].order;
  r.order_conservative = found[1].order;
  r.value = (found[0].value + found[1].value) / 2;
  const double between = std::abs(found[0].value - found[1].value), of_tolerance = std::abs(coarsest - strict);
  r.uncertainty = std::max({found[0].uncertainty, found[1].uncertainty, between, of_tolerance}) / scale;
  r.truth_distance = std::abs(r.value - r.truth) / scale;
  return r;
}

ReferenceResult converge(const Scene& scene, const DeviceOptions& device) {
  static std::mutex gpu;  // solvers of one process share its queue
  const std::scoped_lock one(gpu);
  const SolverEntry& entry = *solver_for(scene);
  const auto ensemble = [&](const Scene& of, int substeps) {
    return ensemble_of(of, entry, complete_settings(entry.info, {{"substeps", substeps}}), device);
  };
  const int substeps = scene.converged.substeps;
  Ensemble found = ensemble(scene, substeps);
  ReferenceResult r;
  r.spread = found.spread;
  const std::vector<double> half = ensemble(scene, substeps / 2).mean, quarter = ensemble(scene, substeps / 4).mean;
  const double near = motion_distance(scene, found.mean, half);
  r.order_xpbd = std::log2(motion_distance(scene, half, quarter) / near);
  r.uncertainty = std::max(r.spread, near);
  if (const auto& grid = scene.converged.fine_grid) {
    const std::string set = fmt::format("cloth.grid=[{},{}]", (*grid)[0], (*grid)[1]);
    const Scene fine = scene_from_json(json_from(scene.json), scene.source, {set});
    r.space_error = motion_distance(scene, found.mean, ensemble(fine, substeps).mean);
  }
  r.mean = std::make_shared<std::vector<double>>(std::move(found.mean));
  return r;
}

std::map<std::string, ReferenceResult> references(const std::vector<const Scene*>& scenes, const fs::path& cache,
                                                  const std::function<void(const std::string&)>& note,
                                                  const ReferenceRules& rules, const DeviceOptions& device) {
  std::map<std::string, ReferenceResult> out;
  std::vector<const Scene*> lacking;
  std::set<std::string> seen;
  for (const Scene* s : scenes) {
    const SolverEntry* solver = solver_for(*s);
    if (solver == nullptr || !seen.insert(s->sha256).second) continue;
    if (!unsupported(solver->info, s->needs).empty()) {
      if (!s->reference_case.empty()) out[s->sha256] = closed_form(*s);
      continue;
    }
    if (const auto known = read_reference(cache, reference_key(*s, rules)))
      out[s->sha256] = *known;
    else
      lacking.push_back(s);
  }
  if (lacking.empty()) return out;
  fs::create_directories(cache);
  std::atomic<std::size_t> next{0};
  std::mutex guard;
  std::string failed;
  const auto work = [&] {
    for (std::size_t k = next++; k < lacking.size(); k = next++) {
      try {
        const bool converges = lacking[k]->converged.substeps > 0;
        const ReferenceResult r = converges ? converge(*lacking[k], device) : compute_reference(*lacking[k], rules);
        write_reference(cache, reference_key(*lacking[k], rules), r);
        const std::scoped_lock lock(guard);
        out[lacking[k]->sha256] = r;
      } catch (const std::exception& e) {
        const std::scoped_lock lock(guard);
        failed = e.what();
      }
    }
  };
  if (note) note(fmt::format("reference solutions of {} scenes", lacking.size()));
  std::vector<std::future<void>> workers;  // joined when destroyed; the libc++ of NDK r25 has no jthread
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  for (std::size_t k = 0; k < std::min(cores, lacking.size()); ++k)
    workers.push_back(std::async(std::launch::async, work));
  workers.clear();
  stop_if_interrupted(kTrialsKept);
  if (!failed.empty()) throw Error(failed, ExitCode::CheckFailed);
  return out;
}

json reference_key(const Scene& scene, const ReferenceRules& rules) {
  static const std::string program = sha256(content_of(own_program()));
  const SolverInfo& info = solver_for(scene)->info;
  json settings = json::array();
  if (scene.converged.substeps > 0)
    settings.push_back(complete_settings(info, json::object()));
  else
    for (const char* integrator : {"bdf2", "conservative"})
      settings.push_back(complete_settings(info, {{"integrator", integrator}, {"tolerance", rules.tolerance}}));
  // The substeps of the runs follow from the rules and the scene, so they are not part of the key.
  for (json& s : settings) s.erase("substeps");
  return {{"scenario_sha256", scene.sha256},
          {"solver_version", info.version},
          {"solver_settings", settings},
          {"moving_steps", rules.moving_steps},
          {"settling_substeps", rules.settling_substeps},
          {"program_sha256", program}};
}

std::optional<ReferenceResult> read_reference(const fs::path& folder, const json& key) {
  const json j = json_or_discarded(content_of(cache_file(folder, key)));
  if (!j.is_object() || j.value("key", json()) != key) return std::nullopt;
  ReferenceResult r;
  try {
    const std::map<std::string, double> values = numbers_from_json(j.at("values"));
    for (const auto& [name, member] : kScalars) r.*member = values.at(name);
    if (j.contains("mean")) r.mean = std::make_shared<std::vector<double>>(j["mean"].get<std::vector<double>>());
  } catch (const std::exception&) {  // unreadable or incomplete: it is computed again
    return std::nullopt;
  }
  return r;
}

void write_reference(const fs::path& folder, const json& key, const ReferenceResult& r) {
  json j = {{"key", key}, {"values", numbers_to_json(r.scalars())}};
  if (r.mean)
    for (const double x : *r.mean) j["mean"].push_back(std::round(1e8 * x) / 1e8);  // in few digits
  write_file_atomically(cache_file(folder, key), dump(j) + "\n");
}

}  // namespace clothbench
