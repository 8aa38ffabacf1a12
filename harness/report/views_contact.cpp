// Tables of contact: verdicts, penetration, pass rates.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "metrics/registry.hpp"
#include "report/verdict.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kAllKinds = "all";
/// Lower ends of the speed bands [m/s].
constexpr std::array kBands = {0.0, 2.0, 5.0, 10.0};

const std::map<std::string, std::string> kSetUps = {{"rooms", "Cloth on static meshes"},
                                                    {"capsules", "A hand of capsules sweeps through cloth"},
                                                    {"hand", "A hand mesh pushes cloth"},
                                                    {"grip", "Hands grip and pull cloth"},
                                                    {"wave", "Bars pull a strip with an exact solution"},
                                                    {"shapes", "Cloth on plain shapes"}};

bool in_contact(const Row& r) { return r.part == Part::Contact; }

/// A length in mm; a value other than 0 is never printed as 0.
std::string mm(double v) {
  if (!std::isfinite(v)) return "–";
  return v == 0 ? "0" : v < 0.01 ? "<0.01" : significant(v, v < 1 ? 2 : 3);
}

std::string percent(double v) {
  if (!std::isfinite(v)) return "–";
  return v == 0 ? "0" : std::abs(v) < 0.1 ? "<0.1" : significant(v, v < 10 ? 2 : 3);
}

std::string number(double v) { return std::isinf(v) ? "never" : significant(v, 2); }
std::string whole(double v) { return std::isfinite(v) ? fmt::format("{:.0f}", v) : "–"; }

/// Summary values in one column, separated by " / ".
ViewColumn values(const char* head, std::vector<const char*> names, std::string (*form)(double), double per_si = 1) {
  return column(head, [=](const Row& r) {
    std::string text;
    bool any = false;
    for (const char* name : names) {
      any = any || std::isfinite(r.value(name));
      text += (text.empty() ? "" : " / ") + form(per_si * r.value(name));
    }
    return any ? text : std::string();
  });
}

std::string offset_of(const Row& r) {
  const auto [least, most] = r.offset_m();
  if (!std::isfinite(most)) return "–";
  return least == most ? fmt::format("{:.3g}", 1e3 * most) : fmt::format("{:.3g} to {:.3g}", 1e3 * least, 1e3 * most);
}

View verdicts() {
  View v{"contact", "Verdict on the acceptance criteria of each scene",
         "Pass: the run meets every criterion of the scene's `expect`. Ignored: the criteria are met, but the solver "
         "handles no contact. –: not run, or the scene has no criteria.",
         in_contact};
  v.keys = {scene_key()};
  v.across = {solver_key(), [](const Group& g) { return verdict(*g.front()->run); }};
  return v;
}

View contact() {
  View v{
      "contact", "Contact",
      "Contact offset: distance at which the solver keeps the cloth from colliders; compare solvers at equal "
      "offsets. Crossings: passages of cloth and colliders through each other between two frames, at most in one "
      "frame. "
      "Contour: length of the curves in which cloth and colliders intersect; settled: the maximum in the last 0.5 s. "
      "Depth: how far the cloth is inside a collider, without the margin. Popping: "
      "maximum displacement of a vertex within 1/36 s beyond twice the displacement of its neighbours, colliders "
      "and grips. Strain: strain of the structural edges. Times: section Frame times.",
      in_contact};
  v.each = [](const Row& r) { return "Contact: " + kSetUps.at(r.set_up); };
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {column("verdict", [](const Row& r) { return verdict(*r.run); }),
               column("contact offset [mm]", offset_of),
               values("crossings", {"crossings_max"}, whole),
               values("contour, max / settled [mm]", {"contact_length_max_m", "contact_length_settled_m"}, mm, 1e3),
               values("depth [mm]", {"depth_max_m"}, mm, 1e3),
               values("self-contact contour, max / settled [mm]",
                      {"self_contact_length_max_m", "self_contact_length_settled_m"}, mm, 1e3),
               values("popping [mm]", {"pop_max_m"}, mm, 1e3),
               values("strain, max / end [%]", {"stretch_max", "stretch_max_end"}, percent, 100),
               values("error of maximum strain, max / RMS [of v0/c]",
                      {"truth_quantity_error_max", "truth_quantity_error"}, number)};
  return v;
}

/// The criterion of the scene for a summary value, as text: "at most 0".
std::string criterion(const Row& r, const std::string& name) {
  if (const double exact = r.value(name + kBound); std::isfinite(exact)) return fmt::format("at most {:.3g}", exact);
  const json e = r.scenario.is_object() ? r.scenario.value("expect", json::object()).value(name, json()) : json();
  if (e.is_string()) return e.get<std::string>();
  std::string text;
  for (const auto& [bound, words] : {std::pair{"at_least", "at least "}, std::pair{"at_most", "at most "}})
    if (e.is_object() && e.contains(bound)) text += (text.empty() ? "" : ", ") + std::string(words) + e[bound].dump();
  return or_dash(text);
}

View violated() {
  const auto broken = [](const Row& r) {
    Texts out;
    for (const BoundResult& b : bound_results(*r.run))
      if (b.passed == 0) out.push_back(b.name);
    return out;
  };
  View v{"contact", "Acceptance criteria that are violated", "", in_contact};
  v.keys = {scene_key(), solver_key(), {"criterion", broken}};
  v.columns = {{"expected", [](const Group& g, const Texts& k) { return criterion(*g.front(), k[2]); }},
               {"found", [](const Group& g, const Texts& k) {
                  if (k[2] == "outcome") return ending(g.front()->run->outcome);
                  return fmt::format("{:.4g}", g.front()->value(k[2]));
                }}};
  return v;
}

std::string band_name(std::size_t k) {
  return k + 1 == kBands.size() ? fmt::format("≥ {:g}", kBands[k]) : fmt::format("{:g}–{:g}", kBands[k], kBands[k + 1]);
}

Texts band_names() {
  Texts out;
  for (std::size_t k = 0; k < kBands.size(); ++k) out.push_back(band_name(k));
  out.emplace_back(kAllKinds);
  return out;
}

double speed_of(const Row& r) { return r.drawn().value("speed_m_per_s", kMissing); }

std::string band_of(const Row& r) {
  std::size_t k = kBands.size() - 1;
  while (k > 0 && !(speed_of(r) >= kBands[k])) --k;
  return band_name(k);
}

/// Procedural assets replace scans, so their scenes are another kind.
std::string with_assets(const std::string& kind, const Row& r) {
  return r.drawn().value("assets", "") == "procedural" ? kind + " (procedural)" : kind;
}

std::string kind_of(const Row& r) { return with_assets(r.drawn().value("kind", ""), r); }

bool is_judged(const Row& r) { return r.part == Part::Generated && r.status() != "missing" && verdict(*r.run) != "–"; }

View pass_rates() {
  View v{
      "generated", "Randomly generated contact scenes: pass rate by speed [m/s]",
      "Passed of generated, by the speed of the hand, or of the cloth where it first touches; in brackets the 95 % "
      "interval of the probability (Wilson). Unsupported and timed out count as not passed. Contact offset: distance "
      "at which the solver keeps the cloth from colliders.",
      [](const Row& r) { return r.part == Part::Generated; }};
  v.keys = {{"solver", [](const Row& r) { return is_judged(r) ? Texts{label_of(*r.run)} : Texts(); }, true},
            {"kind", [](const Row& r) {
               return Texts{kind_of(r), with_assets(kAllKinds, r)};
             }}};
  v.across = {{"",
               [](const Row& r) {
                 return Texts{band_of(r), kAllKinds};
               }},
              [](const Group& g) {
                std::vector<const RunRecord*> runs;
                for (const Row* r : g) runs.push_back(r->run);
                const VerdictCounts n = count_verdicts(runs);
                return share_text(n.passed, n.runs);
              },
              nullptr,
              band_names()};
  v.columns = {{"contact offset [mm]", [](const Group& g, const Texts&) {
                  std::set<std::string> all;
                  for (const Row* r : g)
                    if (const std::string at = offset_of(*r); at != "–") all.insert(at);
                  return fmt::format("{}", fmt::join(all, ", "));
                }}};
  v.by_key = true;
  v.more = [](const Group& g) {
    const auto missing = std::count_if(g.begin(), g.end(), [](const Row* r) { return r->status() == "missing"; });
    return missing == 0 ? std::string()
                        : fmt::format(
                              "{} of {} runs are missing. The longest run first, so rates of an unfinished "
                              "study are biased; --resume completes it.",
                              missing, g.size());
  };
  return v;
}

/// Compares greater for runs that are further from passing.
std::tuple<bool, std::ptrdiff_t, double> badness(const Row& r) {
  const std::vector<BoundResult> bounds = bound_results(*r.run);
  const double contour = r.value("contact_length_max_m");
  return {r.status() != "ok", std::count_if(bounds.begin(), bounds.end(), [](auto& b) { return b.passed != 1; }),
          std::isnan(contour) ? 0 : contour};
}

ViewColumn worst(const std::string& head, std::function<std::string(const Row&)> text) {
  return {head, [text](const Group& g, const Texts&) {
            return text(**std::max_element(g.begin(), g.end(),
                                           [](const Row* a, const Row* b) { return badness(*a) < badness(*b); }));
          }};
}

std::string command_of(const Row& r) {
  const bool quick = environment_of(*r.run, "protocol") == "quick";
  return fmt::format("clothbench study {} --seed {} --count 1 --solver {}{}{}", r.drawn().value("study", ""),
                     r.scenario.value("seed", std::uint64_t{0}), r.solver, quick ? " --quick" : "",
                     r.drawn().value("assets", "") == "procedural" ? " --procedural" : "");
}

View worst_scenes() {
  View v{"generated", "Randomly generated contact scenes: the worst run of each kind",
         "The run that did not end, otherwise the run that violates the most criteria, then the longest contour. The "
         "command runs this seed again with every setting of the solver.",
         [](const Row& r) { return is_judged(r) && verdict(*r.run) != "pass" && r.status() != "unsupported"; }};
  v.keys = {label_key(), key("kind", kind_of)};
  v.by_key = true;
  v.columns = {worst("speed [m/s]", [](const Row& r) { return significant(speed_of(r), 3); }),
               worst("scene", [](const Row& r) { return r.scene; }),
               worst("verdict",
                     [](const Row& r) { return r.status() == "ok" ? r.run->outcome.expect : ending(r.run->outcome); }),
               worst("runs it again", command_of)};
  return v;
}

}  // namespace

std::vector<View> contact_views() {
  return {verdicts(), contact(), violated(), cost_view(), pass_rates(), worst_scenes()};
}

}  // namespace clothbench
