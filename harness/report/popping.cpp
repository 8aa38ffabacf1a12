#include "report/popping.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/json_number.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kMostRatio = 1.2, kMostSpeed = 1;

std::string millimetres(const CellRecord& c) {
  if (c.outcome.status != "ok") return c.outcome.status;
  return significant(1e3 * summary_value(c, "pop_displacement_m"), 3);
}

std::string why_not(const Popping& p) {
  if (p.cell->outcome.status != "ok" || p.finer->outcome.status != "ok") return "did not run";
  if (!std::isfinite(p.ratio()) || !std::isfinite(summary_value(*p.cell, "pop_speed_ratio"))) return "not known";
  return p.kept() ? "kept" : "broken";
}

}  // namespace

double Popping::ratio() const {
  const double coarse = summary_value(*cell, "pop_displacement_m"), fine = summary_value(*finer, "pop_displacement_m");
  return fine > 0 ? coarse / fine : kMissing;
}

bool Popping::kept() const {
  return cell->outcome.status == "ok" && finer->outcome.status == "ok" && ratio() <= kMostRatio &&
         summary_value(*cell, "pop_speed_ratio") <= kMostSpeed;
}

std::vector<Popping> poppings(const std::vector<ContactSetUp>& ups) {
  std::vector<Popping> out;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        if (r.series.setting != "default") continue;
        for (const ContactRow& f : s.rows)
          if (f.series.setting == kFinerLabel && f.series.solver == r.series.solver &&
              f.series.sides == r.series.sides && f.series.repeat == r.series.repeat &&
              r.cell->outcome.status != "unsupported" && r.cell->outcome.status != "missing" &&
              f.cell->outcome.status != "missing")
            out.push_back({s.name, r.series, r.cell, f.cell});
      }
  return out;
}

Table popping_table(const std::vector<Popping>& all) {
  Table t{
      "Popping against the same solver at 16 times its substeps",
      "Greatest way of a vertex within 3 frames after the last contact with a collider that moves; the same with 16 "
      "times as many "
      "substeps a frame; their ratio, which is to be 1.2 at most; greatest speed after that contact over its limit "
      "(twice the "
      "collider's or that of a fall of the cloth's length), to be 1 at most. Not known: the collider never touched, or "
      "touched to the end, in one of the two; that is not kept.",
      {{"scene", "solver", "way [mm]", "way at x16 [mm]", "ratio", "speed [of limit]", "at x16", "popping"}}};
  std::vector<const CellRecord*> cells;
  for (const Popping& p : all) cells.insert(cells.end(), {p.cell, p.finer});
  t.note = with_withheld(t.note, cells, {"pop_displacement_m", "pop_speed_ratio"});
  for (const Popping& p : all)
    t.rows.push_back({p.scene, p.series.label(), millimetres(*p.cell), millimetres(*p.finer), significant(p.ratio(), 3),
                      significant(summary_value(*p.cell, "pop_speed_ratio"), 2),
                      significant(summary_value(*p.finer, "pop_speed_ratio"), 2), why_not(p)});
  return t;
}

json popping_json(const std::vector<Popping>& all) {
  json out = json::array();
  for (const Popping& p : all)
    out.push_back({{"scene", p.scene},
                   {"solver", p.series.solver},
                   {"sides", p.series.sides},
                   {"pop_displacement_m", finite_or_null(summary_value(*p.cell, "pop_displacement_m"))},
                   {"pop_displacement_x16_m", finite_or_null(summary_value(*p.finer, "pop_displacement_m"))},
                   {"ratio", finite_or_null(p.ratio())},
                   {"pop_speed_ratio", finite_or_null(summary_value(*p.cell, "pop_speed_ratio"))},
                   {"verdict", why_not(p)}});
  return out;
}

}  // namespace clothbench
