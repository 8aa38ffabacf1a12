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
constexpr Modulus kModuli[] = {
    {"E_0", "E 0"}, {"E_45", "E 45"},     {"E_90", "E 90"},           {"nu", "ν"},
    {"G", "G"},     {"E_strip", "strip"}, {"strip_border", "border"}, {"E_stiffer", "E ×2", "E_0"},
    {"B_0", "B 0"}, {"B_45", "B 45"},     {"B_90", "B 90"},           {"B_stiffer", "B ×2", "B_0"}};

bool is_full(const RunRecord& c) {
  const json s = scenario_of(c);
  return s.is_object() && s.value("effective_moduli", "") == "full";
}

double modulus(const RunRecord& c, const char* name) { return summary_value(c, std::string("material_") + name); }

/// `stiffer`: name of the modulus of a sheet with twice the stiffness, relative to that stiffness.
std::string verdict(const SolverMaterial& m, const char* name, const char* like, const char* stiffer) {
  const RunRecord* standard = nullptr;
  for (const RunRecord* c : m.moduli)
    if (standard == nullptr && is_full(*c)) standard = c;
  if (standard == nullptr || standard->outcome.status == "unsupported") return kNotMeasured;
  const double value = modulus(*standard, name);
  if (!std::isfinite(value)) return "no value at rest";
  if (!(value > kHeldModulus)) return fmt::format("none: {:.2g} of the requested stiffness", value);
  const double answer = 2 * modulus(*standard, stiffer) / modulus(*standard, like);
  if (!(std::abs(answer / 2 - 1) <= kHeldModulus))
    return fmt::format("not proportional: twice the stiffness gives {:.3g} times the modulus", answer);
  for (const RunRecord* c : m.moduli) {
    const double here = modulus(*c, name);
    if (!(std::abs(here / value - 1) <= kHeldModulus))
      return std::isfinite(here) ? fmt::format("depends on settings: {:.3g} at {}, {:.3g} at {}", value,
                                               standard->header.setting, here, c->header.setting)
                                 : fmt::format("no value at {}", c->header.setting);
  }
  return "";
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
    m.verdict = {verdict(m, "E_strip", "E_0", "E_stiffer"), verdict(m, "E_0", "E_0", "E_stiffer"),
                 verdict(m, "B_0", "B_0", "B_stiffer")};
  }
  return out;
}

StiffnessNeed stiffness_need(const RunRecord& c) {
  constexpr double kDepends = 0.01;
  StiffnessNeed need;
  const json scenario = scenario_of(c);
  if (!scenario.is_object()) return need;
  const bool shear = scenario.value(json::json_pointer("/material/shear"), true);
  (shear ? need.sheet : need.strip) = summary_value(c, "truth_dependence_Y") >= kDepends;
  need.bending = summary_value(c, "truth_dependence_B") >= kDepends;
  return need;
}

std::string stiffness_flag(const std::vector<SolverMaterial>& all, const std::string& solver,
                           const StiffnessNeed& need) {
  for (const SolverMaterial& m : all) {
    if (m.solver != solver) continue;
    for (const auto& [needed, why] : {std::pair{need.strip, &m.verdict.strip}, std::pair{need.sheet, &m.verdict.sheet},
                                      std::pair{need.bending, &m.verdict.bending}})
      if (needed && !why->empty() && *why != kNotMeasured) return *why;
  }
  return "";
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
      .table({"Effective moduli: the effective stiffness of solvers",
              "Measured on patches that hang, slide and bend, at rest. E, G and B: effective moduli divided by the "
              "scene's Y, Y and B, at 0, 45 and 90° to the grid. Exact values: E 1, 1, 1; ν = 1/3 and G = 0.375 "
              "for central springs; strip 1 (no shear); border 1. B at 45° is 1 for developable bending and 0.5 "
              "for lines along the grid, which do not resist twist. ×2: the modulus for twice the stiffness "
              "divided by the modulus for the stiffness itself.",
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
              "other settings. NO: the solver is not ranked on scenes that depend on this stiffness.",
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
    out.push_back({{"solver", m.solver},
                   {"strip_Y", m.verdict.strip},
                   {"sheet_Y", m.verdict.sheet},
                   {"B", m.verdict.bending},
                   {"moduli", std::move(moduli)}});
  }
  return out;
}

}  // namespace clothbench
