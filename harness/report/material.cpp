#include "report/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/grid.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kNotMeasured = "not measured";
/// Moduli in the order of the table.
struct Modulus {
  const char *name, *head;
  const char* over = nullptr;  ///< for a sheet of twice the stiffness: the modulus of one of the stiffness itself
};
constexpr Modulus kModuli[] = {{"E_0", "E 0"},
                               {"E_45", "E 45"},
                               {"E_90", "E 90"},
                               {"nu", "ν"},
                               {"G", "G"},
                               {"E_strip", "strip"},
                               {"strip_border", "border"},
                               {"E_stiffer", "E ×2", "E_0"},
                               {"B_0", "B 0"},
                               {"B_45", "B 45"},
                               {"B_90", "B 90"},
                               {"B_stiffer", "B ×2", "B_0"},
                               {"mesh_E_0", "mesh E 0"},
                               {"mesh_E_45", "mesh E 45"},
                               {"mesh_E_90", "mesh E 90"},
                               {"mesh_nu", "mesh ν"}};

/// A stiffness as the scene states it: its name in plans and JSON, its modulus, the modulus that a sheet of twice the
/// stiffness is compared with, and that sheet's.
struct Stiffness {
  const char *name, *modulus, *like, *stiffer;
  std::string MaterialVerdict::*verdict;
  bool StiffnessNeed::*need;
};
constexpr Stiffness kStiffnesses[] = {
    {"strip_Y", "E_strip", "E_0", "E_stiffer", &MaterialVerdict::strip, &StiffnessNeed::strip},
    {"sheet_Y", "E_0", "E_0", "E_stiffer", &MaterialVerdict::sheet, &StiffnessNeed::sheet},
    {"B", "B_0", "B_0", "B_stiffer", &MaterialVerdict::bending, &StiffnessNeed::bending}};

bool is_full(const RunRecord& c) {
  const json s = scenario_of(c);
  return s.is_object() && s.value("effective_moduli", "") == "full";
}

double modulus(const RunRecord& c, const char* name) { return summary_value(c, std::string("material_") + name); }

/// Of a solver's moduli, the full measurement at its default setting; null without one.
const RunRecord* standard_of(const SolverMaterial& m) {
  const auto at = std::find_if(m.moduli.begin(), m.moduli.end(), [](const RunRecord* c) { return is_full(*c); });
  return at == m.moduli.end() || (*at)->outcome.status == "unsupported" ? nullptr : *at;
}

/// Why the modulus is not proportional to the stiffness at the default setting.
std::string verdict_at_default(const SolverMaterial& m, const Stiffness& s) {
  const RunRecord* standard = standard_of(m);
  if (standard == nullptr) return kNotMeasured;
  const double value = modulus(*standard, s.modulus);
  if (!std::isfinite(value)) return "no value at rest";
  if (!(value > kHeldModulus)) return fmt::format("none: {:.2g} of the requested stiffness", value);
  const double answer = 2 * modulus(*standard, s.stiffer) / modulus(*standard, s.like);
  if (!(std::abs(answer / 2 - 1) <= kHeldModulus))
    return fmt::format("not proportional: twice the stiffness gives {:.3g} times the modulus", answer);
  return "";
}

std::string verdict(const SolverMaterial& m, const Stiffness& s) {
  if (std::string why = verdict_at_default(m, s); !why.empty()) return why;
  const RunRecord& standard = *standard_of(m);
  const double value = modulus(standard, s.modulus);
  for (const RunRecord* c : m.moduli) {
    const double here = modulus(*c, s.modulus);
    if (!(std::abs(here / value - 1) <= kHeldModulus))
      return std::isfinite(here) ? fmt::format("depends on settings: {:.3g} at {}, {:.3g} at {}", value,
                                               standard.header.setting, here, c->header.setting)
                                 : fmt::format("no value at {}", c->header.setting);
  }
  return "";
}

/// The verdict for one setting: where the modulus depends on settings, that setting's own measurement decides.
std::string verdict_at(const SolverMaterial& m, const Stiffness& s, const std::string& setting) {
  if (std::string why = verdict_at_default(m, s); !why.empty()) return why == kNotMeasured ? "" : why;
  for (const RunRecord* c : m.moduli)
    if (c->header.setting == setting && std::abs(modulus(*c, s.modulus) - 1) <= kHeldModulus) return "";
  return m.verdict.*s.verdict;
}

std::string ratio(double v) {
  if (!std::isfinite(v)) return "–";
  return v >= 1e4 || (v != 0 && std::abs(v) < 1e-3) ? fmt::format("{:.1e}", v) : fmt::format("{:.3g}", v);
}

std::string yes_or(const std::string& why) { return why.empty() ? "yes" : why == kNotMeasured ? "–" : "NO: " + why; }

}  // namespace

bool is_moduli_run(const RunRecord& c) { return has_block(c, "effective_moduli"); }

std::vector<SolverMaterial> solver_materials(const std::vector<RunRecord>& runs) {
  std::vector<SolverMaterial> out;
  for (const RunRecord& c : runs) {
    if (!is_moduli_run(c)) continue;
    find_or_add(out, [&](const SolverMaterial& m) { return m.solver == c.header.solver; }, {c.header.solver, {}, {}})
        .moduli.push_back(&c);
  }
  for (SolverMaterial& m : out) {
    std::stable_partition(m.moduli.begin(), m.moduli.end(), [](const RunRecord* c) { return is_full(*c); });
    for (const Stiffness& s : kStiffnesses) m.verdict.*s.verdict = verdict(m, s);
  }
  return out;
}

StiffnessNeed stiffness_need(const RunRecord& c) {
  constexpr double kLeast = 0.01;
  StiffnessNeed need;
  const json scenario = scenario_of(c);
  if (!scenario.is_object()) return need;
  const bool shear = scenario.value(json::json_pointer("/material/shear"), true);
  (shear ? need.sheet : need.strip) = summary_value(c, "truth_dependence_Y") >= kLeast;
  need.bending = summary_value(c, "truth_dependence_B") >= kLeast;
  return need;
}

std::string stiffness_flag(const std::vector<SolverMaterial>& all, const std::string& solver,
                           const std::string& setting, const StiffnessNeed& need) {
  for (const SolverMaterial& m : all)
    for (const Stiffness& s : kStiffnesses)
      if (m.solver == solver && need.*s.need)
        if (std::string why = verdict_at(m, s, setting); !why.empty()) return why;
  return "";
}

std::string stiffness_flag(const std::vector<SolverMaterial>& all, const RunRecord& c) {
  const StiffnessNeed need = stiffness_need(c);
  const json& plan = c.header.plan;
  for (const json& l : plan.is_object() ? plan.value("left_out", json::array()) : json::array())
    for (const Stiffness& s : kStiffnesses)
      if (need.*s.need && l.value("no_parameter", "") == s.name)
        return "the run has no " + l.value("what", "") + ": " + l.value("why", "");
  return stiffness_flag(all, c.header.solver, c.header.setting, need);
}

Table material_table(const std::vector<SolverMaterial>& all) {
  std::vector<const RunRecord*> runs;
  for (const SolverMaterial& m : all) runs.insert(runs.end(), m.moduli.begin(), m.moduli.end());
  using Run = const RunRecord*;
  Columns<Run> columns = {{"", "solver", [](auto& c) { return c->header.solver; }},
                          {"", "setting", [](auto& c) { return c->header.setting; }}};
  return columns
      .across(kModuli, &Modulus::head,
              [](const Run& c, const Modulus& m) {
                if (std::string(m.name) == "E_0" && c->outcome.status != "ok") return c->outcome.status;
                return ratio(modulus(*c, m.name) * (m.over == nullptr ? 1 : 2 / modulus(*c, m.over)));
              })
      .table(
          {"Effective moduli: the effective stiffness of solvers",
           "Measured on patches that hang, slide and bend, at rest. E, G and B: effective moduli divided by the "
           "scene's Y, Y and B, at 0, 45 and 90° to the grid. Exact values: E 1, 1, 1; ν = 1/3 and G = 0.375 "
           "for central springs; strip 1 (no shear); border 1. B at 45° is 1 for developable bending and 0.5 "
           "for lines along the grid, which do not resist twist. ×2: the modulus for twice the stiffness "
           "divided by the modulus for the stiffness itself. mesh: of irregular triangle meshes, whose lattice lies at "
           "that angle to the pull.",
           {}},
          runs);
}

Table material_verdicts(const std::vector<SolverMaterial>& all) {
  return Columns<SolverMaterial>{{"", "solver", &SolverMaterial::solver},
                                 {"", "settings", [](auto& m) { return m.moduli.size(); }},
                                 {"", "Y of strips", [](auto& m) { return yes_or(m.verdict.strip); }},
                                 {"", "Y of sheets", [](auto& m) { return yes_or(m.verdict.sheet); }},
                                 {"", "B", [](auto& m) { return yes_or(m.verdict.bending); }}}
      .table({"Is stiffness a parameter?",
              "Yes: the effective modulus is within 5 % of the requested one, also for twice the stiffness and at "
              "other settings. NO: on scenes that depend on this stiffness the solver is ranked only at settings with "
              "a measured modulus within 5 % of the requested one, and not at all unless the modulus is proportional.",
              {}},
             all);
}

json material_json(const std::vector<SolverMaterial>& all) {
  json out = json::array();
  for (const SolverMaterial& m : all) {
    json moduli = json::array();
    for (const RunRecord* c : m.moduli) {
      json measured = {{"setting", c->header.setting},
                       {"settings", c->header.settings},
                       {"full", is_full(*c)},
                       {"status", c->outcome.status},
                       {"message", c->outcome.message}};
      for (const auto& [name, value] : c->summary)
        if (name.starts_with("material_")) measured[name.substr(9)] = std::isfinite(value) ? json(value) : json();
      moduli.push_back(std::move(measured));
    }
    out.push_back({{"solver", m.solver}, {"moduli", std::move(moduli)}});
    for (const Stiffness& s : kStiffnesses) out.back()[s.name] = m.verdict.*s.verdict;
  }
  return out;
}

}  // namespace clothbench
