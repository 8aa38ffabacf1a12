#include "check/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "report/run_table.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

/// Results by file name, the only key of a planned run without a result; such a run has the status "missing".
std::map<std::string, const RunRecord*> by_name(const std::vector<RunRecord>& runs) {
  std::map<std::string, const RunRecord*> out;
  for (const RunRecord& r : runs) {
    const std::string name = gated_part(r).key.file_name();
    const RunRecord*& at = out[name];
    if (at != nullptr && r.outcome.status != "missing" && at->outcome.status != "missing")
      throw Error(name + ": this run occurs twice among the results; give each run once");
    if (at == nullptr || at->outcome.status == "missing") at = &r;
  }
  return out;
}

std::map<std::string, const BaselineRun*> by_name(const Baseline& b) {
  std::map<std::string, const BaselineRun*> out;
  for (const BaselineRun& c : b.runs) out[c.key.file_name()] = &c;
  return out;
}

bool is_missing(const RunRecord* r) { return r == nullptr || r->outcome.status == "missing"; }

Finding missing(const RunRecord* planned) {
  return {Verdict::Failed, "run", "present",
          "missing",       "",    planned != nullptr ? planned->outcome.message : "no such run among the results"};
}

std::vector<Finding> new_run(const RunRecord& r) {
  std::vector<Finding> out = motion_findings(r);
  const std::string motion = kExpect + "motion";
  if (const auto at = r.summary.find(motion); at != r.summary.end() && !(at->second == 1))
    out.push_back({Verdict::Failed, motion, "–", "fail", "", r.outcome.expect});
  out.push_back({Verdict::New, "run", "–", r.outcome.status, "", "not in the baseline; --update adds it"});
  return out;
}

bool same_values(const BaselineRun& a, const BaselineRun& b) {
  return baseline_text(Baseline{{a}}) == baseline_text(Baseline{{b}});
}

/// One run, with its results from the processes of two builds.
struct Pair {
  RunKey key;
  std::vector<const RunRecord*> a = {}, b = {};
};

/// Adds the conditions that differ between A's first run and the other runs. The order of A and B affects only times.
void add_conditions(const Pair& p, const std::vector<std::string>& allowed, CheckedRun& run, DifferingRuns& differing) {
  const RunRecord& first = *p.a.front();
  const std::vector<Condition> conditions = conditions_of(first);
  std::vector<std::string> kinds;
  for (const auto* side : {&p.a, &p.b})
    for (const RunRecord* r : *side)
      for (ConditionDifference d : differences(conditions, conditions_of(*r))) {
        if (const std::string keys = d.kind == "scene" ? scene_difference(first, *r) : ""; !keys.empty())
          d.what += " (" + keys + ")";
        differing.add(p.key.file_name(), d);
        if (!contains(kinds, d.kind)) kinds.push_back(d.kind);
      }
  run.in_turns = in_turns(p.a, p.b);
  if (!run.in_turns && contains(allowed, std::string("order"))) {
    differing.add(p.key.file_name(), {"order", "processes", "A", "B one after the other, not interleaved"});
    kinds.emplace_back("order");
    run.in_turns = true;
  }
  run.marks = joined(kinds);
}

/// Refuses a file with damaged positions, because it proves nothing about a build.
void require_motions(const Pair& p) {
  for (const auto* side : {&p.a, &p.b})
    for (const RunRecord* r : *side)
      if (const std::string fault = r->file.empty() ? "" : trajectory_fault(r->file); !fault.empty())
        throw Error(fmt::format("{}: {}; repeat the run", r->file, fault));
}

void compare_pair(const Pair& p, CheckedRun& run) {
  const auto ended = [](const auto& side) {
    return side.empty() ? std::string("–") : status_with_class(side.front()->outcome);
  };
  if (p.a.empty() || p.b.empty()) {
    run.findings = {{Verdict::Changed, "run", ended(p.a), ended(p.b), "", ""}};
    return;
  }
  const std::vector<double> a = process_times(p.a), b = process_times(p.b);
  run.time = compare_times(a, b);
  run.time_a_s = quantile(a, 0.5);
  run.time_b_s = quantile(b, 0.5);
  run.findings = compare_records(*p.a.front(), *p.b.front());
}

constexpr double kLevel = 0.95;

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// For every other split of the log times into these sizes: the shift of B that gives the split the actual difference
/// of means; ascending. This shift is the mean of the times moved from B to A minus the mean of the times moved back.
std::vector<double> shifts_of(const std::vector<double>& a, const std::vector<double>& b) {
  const std::size_t m = a.size(), n = m + b.size();
  const std::uint32_t actual = (1u << m) - 1, end = 1u << n;
  std::vector<double> out;
  // Gosper's hack: the next larger number with the same number of bits set.
  for (std::uint32_t on_a = actual; on_a < end;) {
    double moved = 0;
    int count = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const bool is_a = (on_a >> k & 1u) != 0;
      if (k < m && !is_a) moved -= a[k];
      if (k >= m && is_a) {
        moved += b[k - m];
        ++count;
      }
    }
    if (on_a != actual) out.push_back(moved / count);
    const std::uint32_t low = on_a & (0u - on_a), next = on_a + low;
    on_a = next | (((on_a ^ next) >> 2) / low);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

const char* word_for(Verdict v) {
  static constexpr const char* kWords[] = {"same", "new", "improved", "changed", "FAILED"};
  return kWords[static_cast<int>(v)];
}

std::string Finding::sentence() const {
  std::string text = fmt::format("{}: {}: {}, baseline {}", word_for(verdict), quantity, found, baseline);
  if (!allowed.empty()) text += ", allowed " + allowed;
  return message.empty() ? text : text + ": " + message;
}

Verdict CheckedRun::verdict() const {
  Verdict worst = Verdict::Same;
  for (const Finding& f : findings) worst = std::max(worst, f.verdict);
  return worst;
}

std::string CheckedRun::sentences(const std::function<bool(Verdict)>& is) const {
  std::vector<Finding> chosen = findings;
  std::erase_if(chosen, [&](const Finding& f) { return !is(f.verdict); });
  return joined(chosen, "\n", &Finding::sentence);
}

std::size_t Checked::count(Verdict v) const {
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [&](const CheckedRun& c) { return c.verdict() == v; }));
}

std::string CheckedRun::time_verdict() const {
  const std::string out = !std::isfinite(time.ratio) ? "not timed"
                          : !time.enough() ? fmt::format("too few processes: {} per side needed", kMinProcesses)
                          : !in_turns      ? "undecided: A and B ran one after the other"
                          : time.noise()   ? "noise"
                          : time.ratio < 1 ? "faster"
                                           : "slower";
  return marks.empty() ? out : out + "; other " + marks;
}

Checked compare_processes(const Processes& a, const Processes& b, const std::vector<std::string>& allowed) {
  std::vector<Pair> pairs;
  for (const auto& [side, to] : {std::pair{&a, &Pair::a}, {&b, &Pair::b}})
    for (const std::vector<RunRecord>& process : *side) {
      std::set<std::string> seen;
      for (const RunRecord& r : process) {
        const RunKey key = {r.header.scene, r.header.solver, r.header.setting};
        if (!seen.insert(key.file_name()).second)
          throw Error("compare: " + key.file_name() + " occurs twice in one folder; expected each run once");
        (find_or_add(pairs, [&](const Pair& p) { return p.key == key; }, {key}).*to).push_back(&r);
      }
    }
  Checked out;
  out.differing = DifferingRuns(allowed);
  for (const Pair& p : pairs) {
    CheckedRun& run = out.runs.emplace_back(CheckedRun{p.key});
    if (!p.a.empty() && !p.b.empty()) add_conditions(p, allowed, run, out.differing);
  }
  out.differing.refuse("A", "B");
  for (const Pair& p : pairs) require_motions(p);
  for (std::size_t k = 0; k < pairs.size(); ++k) compare_pair(pairs[k], out.runs[k]);
  return out;
}

Checked check_runs(const Baseline& baseline, const std::vector<RunRecord>& runs,
                   const std::vector<std::string>& allowed) {
  Checked out;
  out.differing = DifferingRuns(allowed);
  const auto results = by_name(runs);
  const auto entries = by_name(baseline);
  const auto result_of = [&](const std::string& name) {
    const auto at = results.find(name);
    return at == results.end() ? nullptr : at->second;
  };
  for (const auto& [name, entry] : entries)
    if (const RunRecord* r = result_of(name); !is_missing(r))
      for (const ConditionDifference& d : differences(entry->conditions, gated_part(*r).conditions))
        out.differing.add(name, d);
  out.differing.refuse("the baseline", "the results");
  for (const auto& [name, entry] : entries) {
    const RunRecord* r = result_of(name);
    out.runs.push_back({entry->key, is_missing(r) ? std::vector<Finding>{missing(r)} : compare_run(*entry, *r)});
  }
  for (const auto& [name, r] : results) {
    if (entries.contains(name)) continue;
    out.runs.push_back({gated_part(*r).key, is_missing(r) ? std::vector<Finding>{missing(r)} : new_run(*r)});
  }
  std::sort(out.runs.begin(), out.runs.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return out;
}

Updated update_baseline(const Baseline& old, const std::vector<RunRecord>& runs) {
  const auto results = by_name(runs);
  const auto entries = by_name(old);
  if (runs.empty()) throw Error("--update: expected results with at least one run");
  Updated out;
  for (const auto& [name, r] : results) {
    if (is_missing(r))
      throw Error(fmt::format("--update: {}: {}; a baseline needs complete studies (`clothbench study … --resume`)",
                              name, r->outcome.message));
    for (const Finding& f : motion_findings(*r))
      throw Error(fmt::format("--update: {}: {}; repeat the run", name, f.message));
    out.baseline.runs.push_back(gated_part(*r));
    const BaselineRun& now = out.baseline.runs.back();
    const auto entry = entries.find(name);
    const std::vector<Finding> findings =
        entry == entries.end() ? std::vector<Finding>{{Verdict::New, "run", "–", r->outcome.status, "", ""}}
                               : compare_run(*entry->second, *r);
    if (entry != entries.end())
      for (const ConditionDifference& d : differences(entry->second->conditions, now.conditions))
        out.differing.add(name, d);
    if (!findings.empty())
      out.changes.push_back({now.key, findings});
    else if (!same_values(*entry->second, now))
      ++out.within_slack;
  }
  for (const auto& [name, entry] : entries)
    if (!results.contains(name)) out.removed.push_back(entry->key);
  const auto by_key = [](const auto& a, const auto& b) { return a.key < b.key; };
  std::sort(out.baseline.runs.begin(), out.baseline.runs.end(), by_key);
  std::sort(out.changes.begin(), out.changes.end(), by_key);
  return out;
}

TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b) {
  TimeRatio out;
  out.processes_a = a.size();
  out.processes_b = b.size();
  if (a.empty() || b.empty()) return out;
  if (a.size() > kMaxProcesses || b.size() > kMaxProcesses)
    throw Error(fmt::format("compare: {} and {} processes; at most {} on each side: leave out some folders", a.size(),
                            b.size(), kMaxProcesses));
  std::vector<double> p, q;
  for (const double t : a) p.push_back(std::log(t));
  for (const double t : b) q.push_back(std::log(t));
  out.ratio = std::exp(mean(q) - mean(p));
  if (!out.enough()) return out;
  const std::vector<double> shifts = shifts_of(p, q);
  const double assignments = static_cast<double>(shifts.size()) + 1;
  const auto tail = [&](auto is) {
    return (1 + static_cast<double>(std::count_if(shifts.begin(), shifts.end(), is))) / assignments;
  };
  out.p = std::min({1.0, 2 * tail([](double s) { return !(s > 0); }), 2 * tail([](double s) { return !(s < 0); })});
  const auto rejected = static_cast<std::size_t>((1 - kLevel) / 2 * assignments);
  out.low = std::exp(shifts[rejected - 1]);
  out.high = std::exp(shifts[shifts.size() - rejected]);
  return out;
}

std::vector<double> process_times(const std::vector<const RunRecord*>& processes) {
  std::vector<double> out;
  for (const RunRecord* r : processes) {
    std::vector<double> trials;
    for (const TimedTrial& t : r->trials)
      if (t.frames() > 0) trials.push_back(mean(t.frame_wall_s));
    if (!trials.empty()) out.push_back(quantile(std::move(trials), 0.5));
  }
  return out;
}

bool in_turns(const std::vector<const RunRecord*>& a, const std::vector<const RunRecord*>& b) {
  std::vector<std::pair<double, bool>> order;  // start time, whether on side B
  for (const auto* side : {&a, &b})
    for (const RunRecord* r : *side) {
      if (r->trials.empty() || !std::isfinite(r->trials.front().start_unix_s)) return true;
      order.emplace_back(r->trials.front().start_unix_s, side == &b);
    }
  std::sort(order.begin(), order.end());
  double changes = 0;
  for (std::size_t k = 1; k < order.size(); ++k) changes += order[k].second != order[k - 1].second ? 1 : 0;
  const auto m = static_cast<double>(a.size()), n = static_cast<double>(b.size());
  return changes >= m * n / (m + n);
}

}  // namespace clothbench
