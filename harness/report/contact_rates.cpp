#include "report/contact_rates.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/columns.hpp"
#include "report/grid.hpp"
#include "report/penetration.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kAll = "all";

/// Lower ends of the speed bands [m/s].
constexpr std::array kBands = {0.0, 2.0, 5.0, 10.0};

std::string band_name(std::size_t k) {
  return k + 1 == kBands.size() ? fmt::format("≥ {:g}", kBands[k]) : fmt::format("{:g}–{:g}", kBands[k], kBands[k + 1]);
}

/// Every band and all of them.
std::vector<std::string> band_names() {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < kBands.size(); ++k) out.push_back(band_name(k));
  out.emplace_back(kAll);
  return out;
}

std::string band_of(double speed_m_per_s) {
  std::size_t k = kBands.size() - 1;
  while (k > 0 && !(speed_m_per_s >= kBands[k])) --k;
  return band_name(k);
}

struct DrawnRun {
  const RunRecord* run;
  std::string kind, assets, study;
  std::uint64_t seed = 0;
  double speed_m_per_s = 0;
};

/// Runs that tables may judge.
std::vector<DrawnRun> drawn_runs(const std::vector<RunRecord>& runs) {
  std::vector<DrawnRun> out;
  for (const RunRecord& c : runs) {
    if (!is_drawn_contact(c) || c.outcome.status == "missing" || verdict(c) == "–") continue;
    const json s = scenario_of(c);
    out.push_back({&c, s["drawn"].value("kind", ""), s["drawn"].value("assets", ""), s["drawn"].value("study", ""),
                   s.value("seed", std::uint64_t{0}), s["drawn"].value("speed_m_per_s", NAN)});
  }
  return out;
}

/// Rows of tables: procedural assets stand in for scans, so that they are another kind.
std::string shown_kind(const std::string& kind, const std::string& assets) {
  return assets == "procedural" ? kind + " (procedural)" : kind;
}

std::string rate_text(const ContactRate& r) {
  const Interval i = r.interval();
  return fmt::format("{}/{} ({:.0f}–{:.0f} %)", r.passed, r.drawn, 100 * i.low, 100 * i.high);
}

std::size_t broken_bounds(const RunRecord& c) {
  std::size_t n = 0;
  for (const BoundResult& b : bound_results(c)) n += b.passed == 1 ? 0 : 1;
  return n;
}

std::string command_of(const DrawnRun& d) {
  const bool quick = environment_of(*d.run, "protocol") == "quick";
  return fmt::format("clothbench study {} --seed {} --count 1 --solver {}{}{}", d.study, d.seed, d.run->header.solver,
                     quick ? " --quick" : "", d.assets == "procedural" ? " --procedural" : "");
}

Columns<ContactRate> rate_columns() {
  return {{"solver", In::Both, &ContactRate::solver},
          {"setting", In::Both, &ContactRate::setting},
          {"kind", In::Both, &ContactRate::kind},
          {"speed_m_per_s", In::Both, &ContactRate::band},
          {"assets", In::Both, &ContactRate::assets},
          {"held_at_mm", In::Both, &ContactRate::held_at},
          {"passed", In::Both, &ContactRate::passed},
          {"drawn", In::Both, &ContactRate::drawn},
          {"unsupported", In::Both, &ContactRate::unsupported},
          {"not_ended", In::Both, &ContactRate::not_ended},
          {"rate_low", In::Both, [](auto& r) { return r.interval().low; }},
          {"rate_high", In::Both, [](auto& r) { return r.interval().high; }}};
}

Columns<WorstContact> worst_columns() {
  return {{"solver", "solver", [](auto& w) { return label_of(*w.run); }},
          {"kind", "kind", [](auto& w) { return shown_kind(w.kind, w.assets); }},
          {"speed_m_per_s", "speed [m/s]", &WorstContact::speed_m_per_s, digits(3)},
          {"scene", In::Both, [](auto& w) { return w.run->header.scene; }},
          {"verdict", "verdict",
           [](auto& w) { return w.run->outcome.status == "ok" ? w.run->outcome.expect : ending(w.run->outcome); }},
          {"command", "runs it again", &WorstContact::command}};
}

}  // namespace

bool is_drawn_contact(const RunRecord& c) { return has_block(c, "drawn"); }

std::vector<ContactRate> contact_rates(const std::vector<RunRecord>& runs) {
  const std::vector<DrawnRun> all = drawn_runs(runs);
  std::vector<ContactRate> out;
  for (const auto& [solver, setting, assets] : distinct(
           all, [](const DrawnRun& d) { return std::tuple(d.run->header.solver, d.run->header.setting, d.assets); })) {
    std::vector<std::string> kinds = distinct(all, &DrawnRun::kind);
    kinds.emplace_back(kAll);
    for (const std::string& kind : kinds)
      for (const std::string& band : band_names()) {
        ContactRate r{solver, setting, kind, band, assets};
        std::set<std::string> held;
        std::vector<const RunRecord*> judged;
        for (const DrawnRun& d : all) {
          const RunHeader& h = d.run->header;
          if (h.solver != solver || h.setting != setting || d.assets != assets) continue;
          if ((kind != kAll && kind != d.kind) || (band != kAll && band != band_of(d.speed_m_per_s))) continue;
          judged.push_back(d.run);
          if (const std::string at = held_at(*d.run); at != "–") held.insert(at);
          const std::string& status = d.run->outcome.status;
          r.not_ended += status != "unsupported" && status != "ok" ? 1 : 0;
        }
        const VerdictCounts counts = count_verdicts(judged);
        r.passed = counts.passed;
        r.drawn = counts.runs;
        r.unsupported = counts.unsupported;
        r.held_at = fmt::format("{}", fmt::join(held, ", "));
        if (r.drawn > 0) out.push_back(std::move(r));
      }
  }
  return out;
}

Table contact_rate_table(const std::vector<RunRecord>& runs) {
  Table t{
      "Drawn contact scenes: share that keeps every bound",
      "Passed of drawn, by the speed [m/s] of the hand or of the cloth where it first touches; in brackets the 95 % "
      "interval of the probability (Wilson). Unsupported and timed out: not passed. Holds at: distance at which the "
      "solver holds the cloth off colliders.",
      {}};
  const auto missing =
      std::count_if(runs.begin(), runs.end(), [](const RunRecord& c) { return c.outcome.status == "missing"; });
  if (missing > 0)
    t.note += fmt::format(
        " {} of {} runs are missing. The longest run first, so that rates of an unfinished study are biased; "
        "--resume completes it.",
        missing, runs.size());
  const std::vector<ContactRate> rates = contact_rates(runs);
  Columns<ContactRate> columns = {
      {"", "solver", [](auto& r) { return r.setting == "default" ? r.solver : r.solver + " " + r.setting; }},
      {"", "kind", [](auto& r) { return shown_kind(r.kind, r.assets); }}};
  // Of one solver, setting and kind all bands; the band of all speeds stands for the row.
  std::vector<ContactRate> rows;
  for (const ContactRate& r : rates)
    if (r.band == kAll) rows.push_back(r);
  if (std::any_of(rows.begin(), rows.end(), [](auto& r) { return !r.held_at.empty(); }))
    columns.push_back({"", "holds at [mm]", [](auto& r) { return or_dash(r.held_at); }});
  return columns
      .across(band_names(), std::identity{},
              [&](const ContactRate& row, const std::string& band) {
                const auto key = [](const ContactRate& r) { return std::tie(r.solver, r.setting, r.kind, r.assets); };
                const auto at = std::find_if(rates.begin(), rates.end(),
                                             [&](auto& r) { return key(r) == key(row) && r.band == band; });
                return at == rates.end() ? "" : rate_text(*at);
              })
      .table(std::move(t), rows);
}

std::vector<WorstContact> worst_contacts(const std::vector<RunRecord>& runs) {
  std::vector<WorstContact> out;
  const auto badness = [](const RunRecord& c) {
    const double contour = summary_value(c, "contact_length_max_m");
    return std::tuple(c.outcome.status != "ok", broken_bounds(c), std::isnan(contour) ? 0 : contour);
  };
  for (const DrawnRun& d : drawn_runs(runs)) {
    if (verdict(*d.run) == "pass" || d.run->outcome.status == "unsupported") continue;
    const auto same = [&](const WorstContact& w) {
      return label_of(*w.run) == label_of(*d.run) && w.kind == d.kind && w.assets == d.assets;
    };
    const WorstContact fresh{d.run, d.kind, d.assets, d.speed_m_per_s, command_of(d)};
    WorstContact& w = find_or_add(out, same, fresh);
    if (badness(*d.run) > badness(*w.run)) w = fresh;
  }
  return out;
}

Table worst_contact_table(const std::vector<WorstContact>& all) {
  return worst_columns().table(
      {"Drawn contact scenes: the worst of each kind",
       "Of those that did not pass: one that did not end, else the one with the most broken bounds, then with the "
       "longest contour. The command runs this seed again with every setting of the solver.",
       {}},
      all);
}

std::string contact_rates_csv(const std::vector<RunRecord>& runs) { return rate_columns().csv(contact_rates(runs)); }

json contact_rates_json(const std::vector<RunRecord>& runs) {
  return {{"rates", rate_columns().json(contact_rates(runs))}, {"worst", worst_columns().json(worst_contacts(runs))}};
}

}  // namespace clothbench
