#include "runner/threshold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/truth_errors.hpp"
#include "runner/frame_loop.hpp"
#include "scenario/load.hpp"
#include "truth/card.hpp"

namespace clothbench {
namespace {

constexpr double kLow = 0.5, kHigh = 1.5, kFinest = 1e-3;

/// The last state of a run of the whole scene; none if it fails.
std::optional<ClothState> last_state(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                                     const DeviceOptions& device) {
  const auto solver = load_solver(entry, settings, device, scene);
  FrameLoop loop(*solver, scene, {.frames = scene.time.frames()});
  while (loop.next()) {
  }
  if (loop.failed()) return std::nullopt;
  ClothState state;
  solver->read_state(state);
  return state;
}

/// None where the run fails, or ends with a vertex that is not finite. A strip that is no longer over its cylinder has
/// no displacement over it, and does not stay.
std::optional<bool> stays(const Scene& scene, const truth::Card& card, double limit_m, const SolverEntry& entry,
                          const nlohmann::json& settings, const DeviceOptions& device) {
  const auto state = last_state(scene, entry, settings, device);
  if (!state || !std::all_of(state->position.begin(), state->position.end(), [](double x) { return std::isfinite(x); }))
    return std::nullopt;
  return std::abs(card.quantity(truth::column_means(scene.cloth, state->position))) <= limit_m;
}

}  // namespace

FoundThreshold find_threshold(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                              const DeviceOptions& device) {
  const auto card = truth::card_of(scene);
  if (!card || !card->threshold)
    throw Error(scene.source +
                ": this scene has no threshold: expected one at rest on a slope or over a cylinder, with friction");
  if (!unsupported(entry.info, scene.needs).empty()) throw Error(entry.info.name + " cannot run " + scene.name);
  const truth::Threshold& t = *card->threshold;
  FoundThreshold out;
  out.exact = t.exact;
  const auto holds = [&](double friction) {
    if (out.failed) return false;
    ++out.runs;
    const Scene tried =
        scene_from_json(nlohmann::json::parse(scene.json), scene.source, {fmt::format("{}={}", t.key, friction)});
    const std::optional<bool> held_there = stays(tried, *card, t.held_below_m, entry, settings, device);
    out.failed = !held_there;
    return held_there.value_or(false);
  };
  double low = kLow * t.exact, high = kHigh * t.exact;
  if (!holds(high)) {
    out.slips_at_most = true;
    out.found = high;
  } else if (holds(low)) {
    out.holds_at_least = true;
    out.found = low;
  } else {
    while (!out.failed && high - low > kFinest * t.exact) (holds((low + high) / 2) ? high : low) = (low + high) / 2;
    out.found = (low + high) / 2;
  }
  if (out.failed) {
    out.found = out.error = kMissing;
    out.holds_at_least = out.slips_at_most = false;
    return out;
  }
  out.error = t.error(out.found);
  return out;
}

nlohmann::json ask_threshold(Guard& guard, const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                             const DeviceOptions& device) {
  const Guard::Answer answer = guard.run(entry, [&]() -> nlohmann::json {
    const FoundThreshold found = find_threshold(scene, entry, settings, device);
    const auto card = truth::card_of(scene);
    const auto number = [&](double x) { return found.failed ? nlohmann::json() : nlohmann::json(x); };
    return {{"scene", scene.name},
            {"solver", entry.info.name},
            {"exact", found.exact},
            {"found", number(found.found)},
            {"error", number(found.error)},
            {"error_name", card->threshold->error_name},
            {"error_units", card->threshold->error_units},
            {"bound", found.holds_at_least  ? "<= "
                      : found.slips_at_most ? ">= "
                                            : ""},
            {"failed", found.failed},
            {"runs", found.runs}};
  });
  if (answer.crash.empty()) return answer.value;
  return {{"scene", scene.name}, {"solver", entry.info.name}, {"crashed", answer.crash}};
}

double end_error(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                 const DeviceOptions& device) {
  const TruthJudge judge(scene);
  const auto state = last_state(scene, entry, settings, device);
  return state ? judge.judge(scene.time.frames(), *state).quantity_error : kMissing;
}

}  // namespace clothbench
