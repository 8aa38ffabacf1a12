#include "cli/material_cards.hpp"

#include <algorithm>

#include "clothbench/error.hpp"
#include "report/report.hpp"
#include "report/work_precision.hpp"
#include "runner/material_card.hpp"

namespace clothbench {
namespace {

constexpr double kFullLimit_s = 20, kShortLimit_s = 5;  // wall time of a patch

struct Wanted {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
  bool full;

  std::string name() const {
    CellHeader h;
    h.scene = kMaterialCardScene;
    h.solver = entry->info.name;
    h.setting = setting;
    return cell_name(h);
  }
};

std::vector<const SolverEntry*> solvers_of(const CellPlan& plan) {
  std::vector<const SolverEntry*> out;
  for (const auto& group : plan.groups)
    for (const CellSpec& c : group)
      if (c.entry->make && std::none_of(out.begin(), out.end(),
                                        [&](const SolverEntry* e) { return e->info.name == c.entry->info.name; }))
        out.push_back(c.entry);
  return out;
}

std::vector<Wanted> wanted_cards(const CellPlan& plan, const std::filesystem::path& out) {
  const std::vector<CellRecord> cells = collect({out});
  const std::vector<WorkDiagram> diagrams = work_diagrams(cells);
  std::vector<Wanted> all;
  for (const SolverEntry* e : solvers_of(plan)) {
    if (e->info.ignores.has(Feature::Stretch)) continue;
    all.push_back({e, complete_settings(e->info, nlohmann::json::object()), "default", true});
    if (e->info.name == "reference") continue;
    for (const WorkDiagram& d : diagrams)
      for (const WorkPoint& p : d.points) {
        const bool known = std::any_of(all.begin(), all.end(),
                                       [&](const Wanted& w) { return w.entry == e && w.setting == p.setting; });
        if (p.solver == e->info.name && p.on_front && !known)
          all.push_back({e, p.cell->header.settings, p.setting, false});
      }
  }
  return all;
}

}  // namespace

void add_material_cards(const CellPlan& plan, const RunOptions& options, StudyManifest& manifest) {
  const std::vector<Wanted> wanted = wanted_cards(plan, options.out);
  for (const Wanted& w : wanted) manifest.cells.push_back(w.name());
  write_manifest(options.out, manifest);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const Wanted& w = wanted[k];
    if (cell_finished(options.out, w.name())) continue;
    if (options.progress) options.progress(w.name(), k, wanted.size());
    const CellRecord card = measure_material(*w.entry, w.settings, w.setting, w.full, options.device, plan.protocol,
                                             w.full ? kFullLimit_s : kShortLimit_s);
    CellWriter(options.out, card.header).finish(card.outcome, card.summary);
  }
}

}  // namespace clothbench
