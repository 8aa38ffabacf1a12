// Tables of contact: verdicts, penetration, pass rates.
#include <fmt/format.h>

#include <map>
#include <set>

#include "report/view.hpp"

namespace clothbench {
namespace {

/// Summary values in one column, separated by " / ".
ViewColumn values(const char* head, std::vector<const char*> names, double per_si = 1) {
  return column(head, [=](const Row& r) {
    const auto text = [&](const char* name) {
      const double v = per_si * r.value(name);
      if (v == std::floor(v)) return std::isinf(v) ? std::string("never") : significant(v, 1);
      return v < 1e-3 ? "<0.001" : significant(v, 3);
    };
    const bool any = std::any_of(names.begin(), names.end(), [&](auto* name) { return !std::isnan(r.value(name)); });
    return any ? Cell(joined(names, " / ", text), per_si * r.value(names.front())) : Cell();
  });
}

/// Passed runs with Wilson's interval, "53/58 (81–96 %)"; empty without runs.
Cell pass_rate(const Group& g, const Keys& /*keys*/) {
  VerdictCounts n;
  for (const Row* r : g) n.add(*r->run);
  return share_cell(n.passed, n.runs);
}

bool is_judged(const Row& r) { return r.part == Part::Contact && r.repeat == 1 && !r.scaled; }

View verdicts() {
  View v{"contact", "Verdict on the acceptance criteria of each scene", note("verdicts"), is_judged};
  v.keys = {{"scene", [](const Row& r) { return Keys{r.scene, {"all", true}}; }}};
  v.by_key = true;
  v.across = {solver_key(), [](const Group& g, const Keys& keys) {
                return g.size() > 1 ? pass_rate(g, keys) : verdict_cell(*g.front());
              }};
  return v;
}

/// "hand-push (contact length max, motion)" for a failed run.
std::string failure_of(const Row* r) {
  return fmt::format("{} ({})", r->scene, joined(violated_bounds(*r->run), ", ", [](std::string_view name) {
                       return spaced(name.substr(0, name.size() - (name.ends_with("_m") ? 2 : 0)));
                     }));
}

View failed_scenes() {
  View v{"contact", "Failed scenes of each solver", "",
         [](const Row& r) { return is_judged(r) && verdict(*r.run) == "fail"; }};
  v.keys = {solver_key()};
  v.columns = {
      {"scenes (violated criteria)", [](const Group& g, const Keys&) { return Cell(joined(g, "; ", failure_of)); }}};
  return v;
}

View contact() {
  View v{"contact", "Contact", note("contact"),
         [](const Row& r) { return r.part == Part::Contact || (r.is_best && r.part == Part::Claims); }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {
      column("verdict", verdict_cell),
      offset_column(),
      values("crossings", {"crossings_max"}),
      values("contour, max / settled [mm]", {"contact_length_max_m", "contact_length_settled_m"}, 1e3),
      values("depth [mm]", {"depth_max_m"}, 1e3),
      values("self-contact contour, max / settled [mm]", {"self_contact_length_max_m", "self_contact_length_settled_m"},
             1e3),
      values("popping [mm]", {"pop_max_m"}, 1e3),
      values("strain, max / end [%]", {"stretch_max", "stretch_max_end"}, 100),
      values("error of maximum strain, max / RMS [of v0/c]", {"truth_quantity_error_max", "truth_quantity_error"})};
  v.more = [](const Group& g) -> std::string {
    return std::none_of(g.begin(), g.end(), [](const Row* r) { return r->is_best; })
               ? ""
               : "Best: settings of the cheapest point of the study `reproduction` at which most claims hold.";
  };
  v.in_full = true;
  return v;
}

/// Scenes with procedural assets differ from those with scans, so they are a separate kind.
std::string with_assets(const std::string& kind, const Row& r) {
  return r.drawn().value("assets", "") == "procedural" ? kind + " (procedural)" : kind;
}

View pass_rates() {
  View v{"contact", "Random scenes: pass rate", note("pass rates"),
         [](const Row& r) { return r.part == Part::Generated; }};
  v.each = [](const Row& r) { return fmt::format("Random scenes of {}: pass rate", r.drawn().value("study", "?")); };
  v.keys = {{"solver",
             [](const Row& r) {
               const bool judged = r.status() != "missing" && verdict(*r.run) != kNoVerdict;
               return judged ? Keys{label_of(*r.run)} : Keys();
             },
             true},
            {"kind", [](const Row& r) {
               return Keys{with_assets(r.drawn().value("kind", ""), r), {with_assets("all", r), true}};
             }}};
  const auto speed = [](const Row& r) { return r.drawn().value("speed_m_per_s", 0.0); };
  const auto band = [=](const Row& r) -> Keys {
    for (const auto& [low, name] : {std::pair{10, "≥ 10 m/s"}, {5, "5–10 m/s"}, {2, "2–5 m/s"}, {0, "0–2 m/s"}})
      if (speed(r) > 0 && speed(r) >= low) return {std::string(name)};
    return {};
  };
  v.across = Across{{"", band}, pass_rate, speed, 0};
  v.columns = {{"all", pass_rate},
               column(
                   "device", [](const Row& r) { return short_name(environment_text(*r.run, "gpu")); }, true),
               offset_column()};
  v.by_key = true;
  v.more = [](const Group& g) {
    std::map<std::string, std::set<std::string>> kinds;  // by solver; "": of all
    for (const Row* r : g)
      for (const std::string& solver : {label_of(*r->run), std::string()})
        kinds[solver].insert(r->drawn().value("kind", ""));
    Texts lacking;
    for (const auto& [solver, own] : kinds)
      for (const std::string& kind : kinds.at(""))
        if (!own.contains(kind)) lacking.push_back(solver + in_brackets(kind));
    std::string out = lacking.empty() ? "" : "The study's plan leaves out " + joined(lacking) + ". ";
    if (const auto missing = std::count_if(g.begin(), g.end(), [](auto* r) { return r->status() == "missing"; }))
      out += fmt::format(
          "{} of {} runs are missing. Long runs start first, so rates of an unfinished study are biased; --resume "
          "completes it.",
          missing, g.size());
    return out;
  };
  return v;
}

}  // namespace

Cell offset_of(const Group& g) {
  double least = kMissing, most = kMissing;
  for (const Row* r : g) {
    least = std::fmin(least, 1e3 * r->offset_m().first);
    most = std::fmax(most, 1e3 * r->offset_m().second);
  }
  if (!std::isfinite(most)) return {};
  return {least == most ? fmt::format("{:.3g}", most) : fmt::format("{:.3g} to {:.3g}", least, most), least};
}

ViewColumn offset_column() {
  return {"contact offset [mm]", [](const Group& g, const Keys&) { return offset_of(g); }};
}

std::vector<View> contact_views() { return {verdicts(), failed_scenes(), contact(), pass_rates()}; }

}  // namespace clothbench
