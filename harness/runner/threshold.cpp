#include "runner/threshold.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "runner/whole_run.hpp"
#include "scenario/load.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {
namespace {

truth::ReferenceCase case_with_threshold(const Scene& scene) {
  const auto known = truth::reference_case_of(scene);
  if (!known || !known->threshold)
    throw Error(scene.source +
                ": this scene has no threshold; expected a cloth at rest on a slope or over a cylinder, with friction");
  return *known;
}

/// The scene at one coefficient of friction, without a truth of its own: at too little of it a strip would leave its
/// cylinder, and there is none. It expects nothing: a probe of a search has no verdict.
Scene tried(const Scene& scene, const truth::Threshold& t, double friction) {
  Scene out = scene_from_json(nlohmann::json::parse(scene.json), scene.source, {fmt::format("{}={}", t.key, friction)});
  out.reference_case.clear();
  out.expected_outcome.clear();
  out.expect.clear();
  out.name = tried_scene(scene.name, friction);
  return out;
}

}  // namespace

FoundThreshold find_threshold(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                              StudyRuns& runs, const std::string& setting, std::vector<RunRecord>* reported) {
  const truth::ReferenceCase known = case_with_threshold(scene);
  if (const std::string why = missing_features(entry.info, scene.needs); !why.empty())
    throw Error(scene.name + ": " + why);
  const truth::Threshold& t = *known.threshold;
  return search_threshold(t, [&](double friction) {
    const Scene s = tried(scene, t, friction);
    RunRecord run = runs.run({&s, &entry, settings, setting}, kThresholdProtocol, &known);
    const std::optional<bool> answer = stayed(t, run);
    if (reported != nullptr) reported->push_back(std::move(run));
    return answer;
  });
}

FoundThreshold find_threshold(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                              const DeviceOptions& device) {
  StudyRuns nowhere(device);
  return find_threshold(scene, entry, settings, nowhere);
}

std::vector<RunRecord> threshold_runs(Guard& guard, StudyRuns& runs, const Scene& scene, const SolverEntry& entry,
                                      const nlohmann::json& settings, const std::string& setting) {
  case_with_threshold(scene);
  const RunHeader header = bare_header({&scene, &entry, settings, setting}, kThresholdProtocol);
  if (std::string why = missing_features(entry.info, scene.needs); !why.empty()) {
    RunRecord refused;
    refused.header = header;
    refused.outcome = {"unsupported", "ok", -1, std::move(why)};
    return {refused};
  }
  return runs.ask(guard, header, entry, [&] {
    std::vector<RunRecord> all;
    find_threshold(scene, entry, settings, runs, setting, &all);
    return all;
  });
}

}  // namespace clothbench
