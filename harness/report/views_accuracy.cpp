// Tables of error against run time, stability, failures, violated criteria, machines and features.
#include <fmt/format.h>

#include <array>
#include <map>

#include "clothbench/feature.hpp"
#include "metrics/registry.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

// Wall time per frame: about the cost of one dispatch with its submission, 1 ms, and the frame of a 72 Hz display.
constexpr std::array kBudgets_ms = {0.1, 1.0, 13.9};

bool in_truth(const Row& r) { return r.part == Part::Truth; }
using Measure = double (Row::*)() const;

/// The row with the smallest `by` among those with at most this error and wall time per frame; null if there is none.
const Row* best(const Group& g, Measure by, double error, double frame_ms = INFINITY) {
  const Row* out = nullptr;
  for (const Row* r : g)
    if (r->counts() && r->error() <= error && std::isfinite((r->*by)()) &&
        (std::isinf(frame_ms) || r->wall_ms_per_s() / r->frame_rate_hz() <= frame_ms) &&
        (out == nullptr || (r->*by)() < (out->*by)()))
      out = r;
  return out;
}

/// Shortest time, measured by `clock`, in which a setting reaches an error of at most `most`.
ViewColumn time_to(const char* head, double most, Measure clock) {
  const auto text = [=](const Row& r) {
    return Cell(fmt::format("{:.3g} ({})", (r.*clock)(), r.setting), (r.*clock)());
  };
  return column(head, text, false, [=](const Group& g) { return best(g, clock, most); });
}

/// Smallest error of the settings whose frames take at most `most_ms` of wall time. Errors below the floor are not
/// distinguished.
ViewColumn best_error(std::string head, double most_ms) {
  const auto text = [](const Row& r) {
    const double floor = r.truth->rank_floor();
    return Cell(fmt::format("{}{:.2g} ({})", r.error() <= floor ? "≤ " : "", std::max(floor, r.error()), r.setting),
                r.error());
  };
  return column(std::move(head), text, false, [=](const Group& g) { return best(g, &Row::error, INFINITY, most_ms); });
}

/// The fastest setting with an error of at most 1 %; if there is none, the most accurate setting.
const Row* representative(const Group& g) {
  const Row* r = best(g, &Row::wall_ms_per_s, 1e-2);
  return r != nullptr ? r : best(g, &Row::error, INFINITY);
}

Cell failed_cell(const Group& g) {
  std::size_t failed = 0, over_budget = 0, able = 0;
  for (const Row* r : g) {
    if (r->status() == "over_budget")
      ++over_budget;
    else if (!r->counts())
      ++failed;
    able += r->status() != "unsupported" && r->status() != "missing";
  }
  if (able == 0) return {"unsupported", kMissing, "dim"};
  return {fmt::format("{} of {}", failed, g.size()) + (over_budget > 0 ? fmt::format(", {} not run", over_budget) : ""),
          static_cast<double>(failed) / static_cast<double>(g.size())};
}

std::string ranked_text(const Group& g) {
  std::size_t able = 0, ranked = 0;
  std::string why;
  for (const Row* r : g) {
    if (r->status() == "unsupported" || r->status() == "missing") continue;
    ++able;
    if (const std::string not_ranked = r->not_ranked(); not_ranked.empty())
      ++ranked;
    else
      why = not_ranked;
  }
  if (able > 0 && ranked == 0) return "NO: " + why;
  if (able == 0 || !g.front()->truth->refused().empty()) return "no";
  if (g.front()->on_software) return "no: software device";
  if (const Row* r = representative(g); r != nullptr && r->times->wall.uncertain()) return "no: ~";
  if (ranked < able) return fmt::format("at {} of {} settings", ranked, able);
  return is_baseline(g.front()->solver) ? "baseline" : "yes";
}

View work() {
  View v{"accuracy", "Error against run time", note("error and time"), in_truth};
  v.keys = {key("scene", [](const Row& r) { return r.scene + (r.truth->refused().empty() ? "" : " (refused)"); }),
            key("solver", &Row::solver, true)};
  v.columns = {time_to("to 1 %", 1e-2, &Row::wall_ms_per_s), time_to("to 0.1 %", 1e-3, &Row::wall_ms_per_s),
               time_to("to 1 %, GPU", 1e-2, &Row::device_ms_per_s),
               time_to("to 0.1 %, GPU", 1e-3, &Row::device_ms_per_s)};
  for (const double budget_ms : kBudgets_ms)
    v.columns.push_back(best_error(fmt::format("error within {:g} ms", budget_ms), budget_ms));
  v.columns.push_back(best_error("best error", INFINITY));
  add_tail_columns(v, representative);
  v.columns.push_back({"failed", [](const Group& g, const Keys&) { return failed_cell(g); }});
  v.columns.push_back(column("trials", trials_cell));
  v.columns.push_back({"ranked", [](const Group& g, const Keys&) { return ranked_text(g); }});
  v.timed = true;
  return v;
}

/// A scalar of the scene, taken from the first run that has it.
ViewColumn fact(const char* head, const char* name, const char* form = "{:.1e}") {
  return {head, [=](const Group& g, const Keys&) {
            const auto at = std::find_if(g.begin(), g.end(), [&](auto* r) { return std::isfinite(r->value(name)); });
            const double found = at == g.end() ? kMissing : (*at)->value(name);
            return at == g.end() ? Cell() : Cell(found == 0 ? "0" : fmt::format(fmt::runtime(form), found), found);
          }};
}

View reference_cases() {
  View v{"accuracy", "Reference cases and their reference solutions", note("reference cases"), in_truth};
  v.keys = {scene_key(), key("error", [](const Row& r) { return r.truth->ranking; })};
  v.columns = {fact("space", "truth_space_error"),
               fact("U_ref", "reference_uncertainty"),
               fact("spread", "reference_spread"),
               fact("reference − exact", "reference_truth_distance"),
               fact("order BDF2", "reference_order_bdf2", "{:.2f}"),
               fact("order conservative", "reference_order_conservative", "{:.2f}"),
               fact("order xpbd", "reference_order_xpbd", "{:.2f}"),
               column("ranks", [](const Row& r) {
                 const std::string refused = r.truth->refused();
                 return refused.empty() ? std::string("yes") : "REFUSED: " + refused;
               })};
  return v;
}

constexpr const char* kGrades[] = {"stable", "degraded", "failed"};

/// "5/7 stable, 2 failed (F1), 1 unsupported".
Cell tally(const Group& g, const Keys& /*keys*/) {
  std::map<std::pair<int, std::string>, int> others;  // number of runs by grade and class
  int all = 0, stable = 0, unsupported = 0;
  for (const Row* r : g) {
    const int grade = grade_of(*r);
    const std::string& klass = r->run->outcome.klass;
    all += r->status() != "missing";
    stable += grade == 0;
    unsupported += r->status() == "unsupported";
    if (grade > 0) ++others[{grade, klass == "ok" || klass.empty() ? "F3" : klass}];
  }
  if (all == unsupported) return {unsupported > 0 ? "unsupported" : "", kMissing, "dim"};
  std::string out = fmt::format("{}/{} stable", stable, all);
  for (const auto& [kind, runs] : others) out += fmt::format(", {} {} ({})", runs, kGrades[kind.first], kind.second);
  if (unsupported > 0) out += fmt::format(", {} unsupported", unsupported);
  return {out, static_cast<double>(stable) / all};
}

View robustness() {
  View v{"stability", "Robustness", note("robustness"), [](const Row& r) { return r.part == Part::Stability; }};
  v.keys = {{"case", [](const Row& r) { return Keys{case_of(r), {"all", true}}; }}};
  v.across = {solver_key(), tally};
  v.by_key = true;
  return v;
}

View failed() {
  View v{"failed", "Runs that failed", note("failed"),
         [](const Row& r) { return r.published < 0 && (r.status() != "ok" || grade_of(r) > 0); }};
  const auto status = [](const Row& r) {
    const Outcome& o = r.run->outcome;
    return o.status == "ok" ? fmt::format("ended, but {} ({})", kGrades[grade_of(r)], o.klass) : status_with_class(o);
  };
  v.keys = {solver_key(), key("status", status), key("message", [](const Row& r) { return r.run->outcome.message; })};
  v.columns = {{"scenes", [](const Group& g, const Keys&) {
                  const std::string names = joined(g, ", ", [](const Row* r) {
                    const int frame = r->run->outcome.failed_frame;
                    return r->scene + (frame >= 0 ? fmt::format(" (frame {})", frame) : "");
                  });
                  return Cell(g.size() > 1 ? fmt::format("{} runs: {}", g.size(), names) : names);
                }}};
  return v;
}

/// Unit in which tables show a criterion, and its number per SI unit.
std::pair<std::string, double> unit_of(const std::string& name) {
  const Scalar* s = find_scalar(name);
  if (name.starts_with("stretch_")) return {" %", 100};
  if (s != nullptr && s->units == "m" && !name.starts_with("lowest_height")) return {" mm", 1e3};
  return {s == nullptr || s->units == "1" ? "" : " " + s->units, 1};
}

/// One row per violated criterion. A failed verdict without a violated criterion is a row with its own text.
View violated() {
  const auto broken = [](const Row& r) {
    Keys out;
    for (const std::string& name : violated_bounds(*r.run)) out.emplace_back(name);
    if (out.empty() && r.run->outcome.expect.starts_with("fail")) out.emplace_back(r.run->outcome.expect, true);
    return out;
  };
  View v{"failed", "Acceptance criteria that are violated", note("violated"),
         [](const Row& r) { return r.published < 0 && r.part != Part::Stability && !r.in_sweep(); }};
  v.keys = {scene_key(), solver_key(), {"criterion", broken}};
  const auto is_text = [](const KeyValue& criterion) { return criterion.all || criterion.text == "motion"; };
  v.columns = {{"found",
                [=](const Group& g, const Keys& k) {
                  return is_text(k[2]) ? Cell("fail", kMissing, "bad") : found_of(*g.front(), k[2].text);
                }},
               {"expected", [](const Group& g, const Keys& k) { return Cell(expected_of(*g.front(), k[2].text)); }},
               {"meaning", [=](const Group& g, const Keys& k) {
                  const Scalar* s = find_scalar(k[2].text);
                  return Cell(s != nullptr ? s->doc : k[2].text == "motion" ? found_of(*g.front(), "motion").text : "");
                }}};
  v.explains = true;
  return v;
}

constexpr const char* kStated[] = {"gpu",         "gpu_is_software", "device_profile", "driver",        "cpu",
                                   "cpu_threads", "shader_compiler", "clock_policy",   "power_limit_W", "ecc",
                                   "protocol",    "git_commit",      "git_dirty",      "source_sha256", "build_type",
                                   "assets"};

std::string stated(const Row& r, const char* name) {
  const json e = environment_of(*r.run, name);
  if (e.is_boolean()) return e.get<bool>() ? "yes" : "no";
  return e.is_null() ? "" : e.is_string() ? e.get<std::string>() : dump(e);
}

View environment() {
  View v{"environment", "Machines of the runs", "As stated in each result file.",
         [](const Row& r) { return r.run->header.environment.is_object() && !r.run->header.environment.empty(); }};
  v.keys = {key(
      "", [](const Row& r) { return joined(kStated, "\n", [&](auto* name) { return or_dash(stated(r, name)); }); })};
  v.columns = {{"runs", [](const Group& g, const Keys&) {
                  std::map<std::string, int> runs;
                  for (const Row* r : g) ++runs[r->solver];
                  return joined(runs, ", ", [](const auto& n) { return fmt::format("{} ({})", n.first, n.second); });
                }}};
  for (const char* name : kStated)
    v.columns.push_back(column(spaced(name), [=](const Row& r) { return stated(r, name); }));
  v.in_full = true;
  return v;
}

/// Support of a feature, as declared in the first run that contains a declaration.
Cell declared(const Group& g, const Keys& keys) {
  json features;
  for (const Row* r : g)
    if (features.is_null()) features = environment_of(*r->run, "solver_features");
  if (features.is_null()) return "not built";
  const auto has = [&](const char* list) {
    const json& names = features.at(list);
    return std::any_of(names.begin(), names.end(),
                       [&](const json& name) { return spaced(name.get<std::string>()) == keys.front().text; });
  };
  if (has("ignores")) return "ignored";
  if (!has("supports")) return "no";
  std::string text = "yes";
  for (const json& pair : features.at("only_with"))
    if (spaced(pair.at(0).get<std::string>()) == keys.front().text)
      text += " (only with " + spaced(pair.at(1).get<std::string>()) + ")";
  return text;
}

}  // namespace

std::string expected_of(const Row& r, const std::string& name) {
  const auto [unit, per_si] = unit_of(name);
  if (const double exact = r.value(name + kBound); std::isfinite(exact))
    return fmt::format("at most {:.3g}{}", exact * per_si, unit);
  const json e = r.scenario.value("expect", json::object()).value(name, json());
  if (e.is_string()) return e.get<std::string>();
  std::string text;
  for (const auto& [bound, words] : {std::pair{"at_least", "at least "}, std::pair{"at_most", "at most "}})
    if (e.is_object() && e.contains(bound))
      text += fmt::format("{}{}{:.6g}{}", text.empty() ? "" : ", ", words, e[bound].get<double>() * per_si, unit);
  return text;
}

Cell found_of(const Row& r, const std::string& name) {
  if (name == "outcome") return ending_cell(*r.run);
  if (name == "motion") {  // only the violated laws; the criteria after them have rows of their own
    const std::string& all = r.run->outcome.expect;
    std::size_t end = all.size();
    for (const std::string& criterion : violated_bounds(*r.run)) end = std::min(end, all.find("; " + criterion + " "));
    return Cell(all.substr(0, end));
  }
  const double found = r.value(name);
  const auto [unit, per_si] = unit_of(name);
  return std::isfinite(found) ? Cell(fmt::format("{:.4g}{}", found * per_si, unit), found) : Cell();
}

std::string case_of(const Row& r) {
  const std::string name = r.name.size() > 4 && r.name[3] == '-' ? r.name.substr(4) : r.name;
  return r.scenario.value(json::json_pointer("/stability/case"), std::string()) + " " + name;
}

int grade_of(const Row& r) {
  if (r.part != Part::Stability || r.status() == "unsupported" || r.status() == "missing") return -1;
  const double grade = r.value("stability_grade");
  return std::isfinite(grade) ? static_cast<int>(grade) : 2;
}

View feature_view() {
  View v{"features", "Table 4: features", note("features"),
         [](const Row& r) { return r.published < 0 && r.status() != "missing"; }};
  v.keys = {{"feature", [](const Row&) {
               Keys out;
               for (const FeatureRow& f : kFeatures) out.emplace_back(spaced(f.name), true);
               return out;
             }}};
  v.across = {key("", &Row::solver, true), declared};
  v.in_full = true;
  return v;
}

std::vector<View> accuracy_views() {
  return {work(), reference_cases(), robustness(), failed(), violated(), environment(), feature_view()};
}

}  // namespace clothbench
