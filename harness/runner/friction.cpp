#include "runner/friction.hpp"

#include <nlohmann/json.hpp>

#include "runner/whole_run.hpp"
#include "scenario/load.hpp"

namespace clothbench {

std::vector<RunRecord> friction_runs(Guard& guard, StudyRuns& runs, const SolverEntry& entry,
                                     const nlohmann::json& settings, const std::string& setting,
                                     const std::vector<std::string>& set,
                                     const std::function<void(const std::string&)>& note) {
  std::vector<RunRecord> all;
  for (const FrictionForm& form : friction_forms()) {
    note(form.scene);
    const Scene scene = load_scene(std::string("validation/") + form.scene, set);
    const RunSpec spec{&scene, &entry, settings, setting};
    // What cannot be run needs no search to say so.
    const bool search = form.threshold && unsupported(entry.info, scene.needs).empty();
    std::vector<RunRecord> some = search ? threshold_runs(guard, runs, scene, entry, settings, setting)
                                         : runs.ask(guard, bare_header(spec, kFrictionProtocol), entry,
                                                    [&] { return std::vector{runs.run(spec, kFrictionProtocol)}; });
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace clothbench
