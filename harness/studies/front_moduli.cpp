#include "studies/front_moduli.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include "report/report.hpp"
#include "report/roles.hpp"
#include "report/work_precision.hpp"
#include "runner/effective_moduli.hpp"

namespace clothbench {
namespace {

constexpr double kFullLimit_s = 20,
                 kShortLimit_s = 5;  // wall time of a patch in a full study; the default measured's otherwise:
constexpr double kDefaultLimit_s = 8;

struct Wanted {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
  bool full, bending = true;

  std::string name() const { return run_name(kModuliScene, entry->info.name, setting); }
};

std::vector<const SolverEntry*> solvers_of(const RunPlan& plan) {
  std::vector<const SolverEntry*> out;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (c.entry->make && std::none_of(out.begin(), out.end(),
                                        [&](const SolverEntry* e) { return e->info.name == c.entry->info.name; }))
        out.push_back(c.entry);
  return out;
}

/// The default setting of every solver; a full study's baseline is measured too, though it is the model itself.
std::vector<Wanted> default_moduli(const RunPlan& plan, bool whole) {
  std::vector<Wanted> all;
  for (const SolverEntry* e : solvers_of(plan))
    if (!e->info.ignores.has(Feature::Stretch) && (whole || !is_baseline(e->info.name)))
      all.push_back({e, complete_settings(e->info, nlohmann::json::object()), "default", true});
  return all;
}

/// Settings on the fronts: in a full study all of them; else those on scenes whose answer depends on a stiffness that
/// the solver's default setting has as a parameter, since no other measured can change a verdict that matters; and of
/// these no bending where the default has none.
std::vector<Wanted> front_moduli(const RunPlan& plan, const std::filesystem::path& out, bool whole,
                                 std::size_t& left_out) {
  const std::vector<RunRecord> runs = collect({out});
  std::vector<RunRecord> defaults;  // a resumed study must want what it wanted before: moduli of fronts decide nothing
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(defaults),
               [](const RunRecord& c) { return is_moduli_run(c) && c.header.setting == "default"; });
  const std::vector<SolverMaterial> materials = solver_materials(defaults);
  std::vector<Wanted> all, without;
  const auto listed = [](const std::vector<Wanted>& list, const SolverEntry* e, const std::string& setting) {
    return std::any_of(list.begin(), list.end(), [&](const Wanted& w) { return w.entry == e && w.setting == setting; });
  };
  const std::vector<WorkDiagram> diagrams = work_diagrams(runs, materials);
  for (const SolverEntry* e : solvers_of(plan)) {
    if (e->info.ignores.has(Feature::Stretch) || is_baseline(e->info.name)) continue;
    const bool bends = stiffness_flag(materials, e->info.name, "default", {false, false, true}).empty();
    for (const WorkDiagram& d : diagrams)
      for (const WorkPoint& p : d.points) {
        if (p.solver != e->info.name || !p.on_front || p.setting == "default") continue;
        const bool matters = whole || (d.need.any() && p.not_ranked.empty());
        std::vector<Wanted>& list = matters ? all : without;
        if (!listed(list, e, p.setting)) list.push_back({e, p.run->header.settings, p.setting, false, whole || bends});
      }
  }
  for (const Wanted& w : without) left_out += !listed(all, w.entry, w.setting);
  return all;
}

}  // namespace

void add_moduli_runs(const RunPlan& plan, const RunOptions& options, StudyManifest& manifest, RunResult& result) {
  const bool whole = plan.protocol == "full";
  const auto measure = [&](const std::vector<Wanted>& wanted) {
    for (const Wanted& w : wanted) manifest.runs.push_back(w.name());
    write_manifest(options.out, manifest);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const Wanted& w = wanted[k];
      if (run_finished(options.out, w.name())) continue;
      if (options.progress) options.progress(w.name(), k, wanted.size());
      const auto start = std::chrono::steady_clock::now();
      const RunRecord measured =
          measure_material(*w.entry, w.settings, w.setting, w.full, options.device, plan.protocol,
                           !w.full ? kShortLimit_s
                           : whole ? kFullLimit_s
                                   : kDefaultLimit_s,
                           w.bending ? PatchChoice::Grids : PatchChoice::Stretch);
      RunWriter(options.out, measured.header).finish(measured.outcome, measured.summary);
      result.moduli_seconds[w.entry->info.name] +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      ++result.moduli;
    }
  };
  measure(default_moduli(plan, whole));
  std::size_t left_out = 0;
  measure(front_moduli(plan, options.out, whole, left_out));
  result.moduli_left_out = static_cast<int>(left_out);
}

}  // namespace clothbench
