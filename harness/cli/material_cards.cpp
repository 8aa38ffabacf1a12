#include "cli/material_cards.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include "clothbench/error.hpp"
#include "report/report.hpp"
#include "report/work_precision.hpp"
#include "runner/material_card.hpp"

namespace clothbench {
namespace {

constexpr const char* kYardstick = "reference";
constexpr double kFullLimit_s = 20,
                 kShortLimit_s = 5;  // wall time of a patch in a full study; the default card's otherwise:
constexpr double kDefaultLimit_s = 8;

struct Wanted {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
  bool full, bending = true;

  std::string name() const { return cell_name(kMaterialCardScene, entry->info.name, setting); }
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

/// The default setting of every solver; a full study's yardstick is measured too, though it is the model itself.
std::vector<Wanted> default_cards(const CellPlan& plan, bool whole) {
  std::vector<Wanted> all;
  for (const SolverEntry* e : solvers_of(plan))
    if (!e->info.ignores.has(Feature::Stretch) && (whole || e->info.name != kYardstick))
      all.push_back({e, complete_settings(e->info, nlohmann::json::object()), "default", true});
  return all;
}

/// Settings on the fronts: in a full study all of them; else those on scenes whose answer depends on a stiffness that
/// the solver's default setting has as a parameter, since no other card can change a verdict that matters; and of these
/// no bending where the default has none.
std::vector<Wanted> front_cards(const CellPlan& plan, const std::filesystem::path& out, bool whole,
                                std::size_t& left_out) {
  const std::vector<CellRecord> cells = collect({out});
  std::vector<CellRecord> defaults;  // a resumed study must want what it wanted before: cards of fronts decide nothing
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(defaults),
               [](const CellRecord& c) { return is_material_card(c) && c.header.setting == "default"; });
  const std::vector<SolverMaterial> materials = solver_materials(defaults);
  std::vector<Wanted> all, without;
  const auto listed = [](const std::vector<Wanted>& list, const SolverEntry* e, const std::string& setting) {
    return std::any_of(list.begin(), list.end(), [&](const Wanted& w) { return w.entry == e && w.setting == setting; });
  };
  const std::vector<WorkDiagram> diagrams = work_diagrams(cells, materials);
  for (const SolverEntry* e : solvers_of(plan)) {
    if (e->info.ignores.has(Feature::Stretch) || e->info.name == kYardstick) continue;
    const bool bends = stiffness_flag(materials, e->info.name, {false, false, true}).empty();
    for (const WorkDiagram& d : diagrams)
      for (const WorkPoint& p : d.points) {
        if (p.solver != e->info.name || !p.on_front || p.setting == "default") continue;
        const bool matters = whole || (d.need.any() && !d.flagged.contains(p.solver));
        std::vector<Wanted>& list = matters ? all : without;
        if (!listed(list, e, p.setting)) list.push_back({e, p.cell->header.settings, p.setting, false, whole || bends});
      }
  }
  for (const Wanted& w : without) left_out += !listed(all, w.entry, w.setting);
  return all;
}

}  // namespace

void add_material_cards(const CellPlan& plan, const RunOptions& options, StudyManifest& manifest, RunResult& result) {
  const bool whole = plan.protocol == "full";
  const auto measure = [&](const std::vector<Wanted>& wanted) {
    for (const Wanted& w : wanted) manifest.cells.push_back(w.name());
    write_manifest(options.out, manifest);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const Wanted& w = wanted[k];
      if (cell_finished(options.out, w.name())) continue;
      if (options.progress) options.progress(w.name(), k, wanted.size());
      const auto start = std::chrono::steady_clock::now();
      const CellRecord card = measure_material(*w.entry, w.settings, w.setting, w.full, options.device, plan.protocol,
                                               !w.full ? kShortLimit_s
                                               : whole ? kFullLimit_s
                                                       : kDefaultLimit_s,
                                               w.bending);
      CellWriter(options.out, card.header).finish(card.outcome, card.summary);
      result.card_seconds[w.entry->info.name] +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      ++result.cards;
    }
  };
  measure(default_cards(plan, whole));
  std::size_t left_out = 0;
  measure(front_cards(plan, options.out, whole, left_out));
  result.cards_left_out = static_cast<int>(left_out);
}

}  // namespace clothbench
