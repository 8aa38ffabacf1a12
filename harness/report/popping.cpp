#include "report/popping.hpp"

#include <cmath>

#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kMostRatio = 1.2, kMostSpeed = 1;

/// Displacement of the pop, or the status of a run that did not end well.
Value way_of(const RunRecord& c) {
  return c.outcome.status == "ok" ? Value(summary_value(c, "pop_displacement_m")) : Value(c.outcome.status);
}

std::string why_not(const Popping& p) {
  if (p.run->outcome.status != "ok" || p.finer->outcome.status != "ok") return "did not run";
  if (!std::isfinite(p.ratio()) || !std::isfinite(summary_value(*p.run, "pop_speed_ratio"))) return "not known";
  return p.passed() ? "pass" : "fail";
}

const Columns<Popping>& popping_columns() {
  static const Columns<Popping> all = {
      {"scene", "scene", &Popping::scene},
      {"solver", In::Both, [](auto& p) { return p.series.solver; }},
      {"sides", In::Both, [](auto& p) { return p.series.sides; }},
      {"", "solver", [](auto& p) { return p.series.label(); }},
      {"pop_displacement_m", In::Both, summary("pop_displacement_m")},
      {"pop_displacement_x16_m", In::Both, [](auto& p) { return summary_value(*p.finer, "pop_displacement_m"); }},
      {"", "way", [](auto& p) { return way_of(*p.run); }, digits(3), kMillimetres},
      {"", "way at x16", [](auto& p) { return way_of(*p.finer); }, digits(3), kMillimetres},
      {"ratio", "ratio", &Popping::ratio, digits(3)},
      {"pop_speed_ratio", "speed [of limit]", summary("pop_speed_ratio"), digits(2)},
      {"", "at x16", [](auto& p) { return summary_value(*p.finer, "pop_speed_ratio"); }, digits(2)},
      {"verdict", "popping", why_not}};
  return all;
}

}  // namespace

double Popping::ratio() const {
  const double coarse = summary_value(*run, "pop_displacement_m"), fine = summary_value(*finer, "pop_displacement_m");
  return fine > 0 ? coarse / fine : kMissing;
}

bool Popping::passed() const {
  return run->outcome.status == "ok" && finer->outcome.status == "ok" && ratio() <= kMostRatio &&
         summary_value(*run, "pop_speed_ratio") <= kMostSpeed;
}

std::vector<Popping> poppings(const std::vector<ContactSetUp>& ups) {
  std::vector<Popping> out;
  const std::vector<ContactRow> rows = contact_rows(ups);
  for (const ContactRow& r : rows) {
    if (r.series.setting != "default" || r.run->outcome.status == "unsupported" || r.run->outcome.status == "missing")
      continue;
    Series finer = r.series;
    finer.setting = kFinerLabel;
    for (const ContactRow& f : rows)
      if (f.kind == r.kind && f.scene == r.scene && f.series == finer && f.run->outcome.status != "missing")
        out.push_back({r.scene, r.series, r.run, f.run});
  }
  return out;
}

Table popping_table(const std::vector<Popping>& all) {
  return popping_columns().table(
      {"Popping against the same solver at 16 times its substeps",
       with_withheld("Greatest way of a vertex within 3 frames after the last contact with a collider that moves; the "
                     "same with 16 "
                     "times as many "
                     "substeps a frame; their ratio, which is to be 1.2 at most; greatest speed after that contact "
                     "over its limit "
                     "(twice the "
                     "collider's or that of a fall of the cloth's length), to be 1 at most. Not known: the collider "
                     "never touched, or "
                     "touched to the end, in one of the two; that is no pass.",
                     runs_of(all, &Popping::run, &Popping::finer), {"pop_displacement_m", "pop_speed_ratio"}),
       {}},
      all);
}

json popping_json(const std::vector<Popping>& all) { return popping_columns().json(all); }

}  // namespace clothbench
