#include "check/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "report/run_table.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using Entries = std::vector<const BaselineRun*>;

/// The results of one run, whatever its assets: those that are there, and what is known of one that is not.
struct Found {
  std::vector<const RunRecord*> records;
  const RunRecord* missing = nullptr;
};

/// By file name, because that is all there is of a planned run without a result.
std::map<std::string, Found> by_name(const std::vector<RunRecord>& runs) {
  std::map<std::string, Found> out;
  std::map<RunKey, int> seen;
  for (const RunRecord& c : runs) {
    const RunKey key = gated_part(c).key;
    Found& found = out[key.file_name()];
    if (c.outcome.status == "missing") {
      found.missing = &c;
      continue;
    }
    if (seen[key]++ > 0) throw Error(key.text() + ": this run occurs twice among the results; give each run once");
    found.records.push_back(&c);
  }
  return out;
}

std::map<std::string, Entries> by_name(const Baseline& b) {
  std::map<std::string, Entries> out;
  for (const BaselineRun& c : b.runs) out[c.key.file_name()].push_back(&c);
  return out;
}

const BaselineRun* entry_for(const Entries& entries, const RunKey& key) {
  for (const BaselineRun* e : entries)
    if (e->key == key) return e;
  return nullptr;
}

std::string outcome_of(const RunRecord& c) { return c.outcome.status; }

Finding missing(const Found& found) {
  return {Verdict::Failed,
          "run",
          "present",
          "missing",
          "",
          found.missing != nullptr ? found.missing->outcome.message : "no such run among the results"};
}

std::string kind(const std::string& assets) { return assets.empty() ? "unnamed" : assets; }

class Check {
 public:
  explicit Check(const std::vector<std::string>& allowed) { out_.differing = DifferingRuns(allowed); }

  Checked run(const Baseline& baseline, const std::vector<RunRecord>& runs) {
    const auto results = by_name(runs);
    const auto entries = by_name(baseline);
    for (const auto& [name, group] : entries)
      if (const auto at = results.find(name); at != results.end()) add_differences(group, at->second);
    out_.differing.refuse("the baseline", "the results");
    for (const auto& [name, group] : entries) {
      const auto at = results.find(name);
      known(group, at == results.end() ? Found{} : at->second);
    }
    for (const auto& [name, found] : results)
      if (entries.count(name) == 0) unknown(found);
    std::sort(out_.runs.begin(), out_.runs.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    return out_;
  }

 private:
  void add_differences(const Entries& entries, const Found& found) {
    for (const RunRecord* r : found.records) {
      const BaselineRun is = gated_part(*r);
      if (const BaselineRun* e = entry_for(entries, is.key); e != nullptr)
        for (const ConditionDifference& d : differences(e->conditions, is.conditions))
          out_.differing.add(is.key.text(), d);
    }
  }

  void known(const Entries& entries, const Found& found) {
    if (found.records.empty()) return add(entries.front()->key, {missing(found)});
    std::size_t compared = 0;
    for (const RunRecord* r : found.records)
      if (const BaselineRun* e = entry_for(entries, gated_part(*r).key); e != nullptr) {
        add(e->key, compare_run(*e, *r));
        ++compared;
      }
    if (compared == 0) return add(entries.front()->key, {other_assets(*entries.front(), *found.records.front())});
    out_.other_assets += entries.size() - compared;
    for (const RunRecord* r : found.records)
      if (const RunKey key = gated_part(*r).key; entry_for(entries, key) == nullptr) add_new(key, *r);
  }

  void unknown(const Found& found) {
    for (const RunRecord* r : found.records) add_new(gated_part(*r).key, *r);
    if (found.records.empty() && found.missing != nullptr) add(gated_part(*found.missing).key, {missing(found)});
  }

  /// Procedural rooms and hands are other scenes than real ones: a run without the real ones must not pass for them.
  static Finding other_assets(const BaselineRun& entry, const RunRecord& r) {
    return {Verdict::Failed,
            "assets",
            kind(entry.key.assets),
            kind(gated_part(r).key.assets),
            "",
            "the baseline has this run only with other assets: fetch them (scripts/fetch-assets.sh), or add this kind "
            "with --update"};
  }

  void add_new(const RunKey& key, const RunRecord& r) {
    std::vector<Finding> findings = motion_findings(r);
    const std::string motion = kExpect + "motion";
    if (const auto at = r.summary.find(motion); at != r.summary.end() && !(at->second == 1))
      findings.push_back({Verdict::Failed, motion, "–", "fail", "", r.outcome.expect});
    findings.push_back({Verdict::New, "run", "–", outcome_of(r), "", "not in the baseline; --update adds it"});
    add(key, std::move(findings));
  }
  void add(const RunKey& key, std::vector<Finding> findings) { out_.runs.push_back({key, std::move(findings)}); }

  Checked out_;
};

/// Adds what `from` has and `to` lacks.
void merge(std::vector<std::string>& to, const std::vector<std::string>& from) {
  for (const std::string& text : from)
    if (!contains(to, text)) to.push_back(text);
  std::sort(to.begin(), to.end());
}

/// Entries of `old` whose run has results, but only with other assets, stay with their origin; those without any
/// result are removed.
void keep_other_assets(const Baseline& old, const std::map<std::string, Found>& results, Updated& out) {
  for (const BaselineRun& e : old.runs) {
    const auto at = results.find(e.key.file_name());
    if (at == results.end()) {
      out.removed.push_back(e.key);
      continue;
    }
    const auto& records = at->second.records;
    if (std::any_of(records.begin(), records.end(), [&](const RunRecord* r) { return gated_part(*r).key == e.key; }))
      continue;
    out.baseline.runs.push_back(e);
    merge(out.baseline.origin.runs, old.origin.runs);
    merge(out.baseline.origin.commits, old.origin.commits);
    merge(out.baseline.origin.devices, old.origin.devices);
  }
}

bool same_values(const BaselineRun& a, const BaselineRun& b) {
  return baseline_text({{}, {a}}) == baseline_text({{}, {b}});
}

/// One run in the processes of two builds.
struct Pair {
  RunKey key;
  std::vector<const RunRecord*> a = {}, b = {};
};

/// Adds what differs between the first run of A and every other one. Another order is no difference of the
/// runs, only no basis for a statement on times.
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
    differing.add(p.key.file_name(), {"order", "processes", "A", "B one after the other, not mixed"});
    kinds.emplace_back("order");
    run.in_turns = true;
  }
  run.marks = joined(kinds);
}

/// A file whose positions are damaged proves nothing about a build.
void require_motions(const Pair& p) {
  for (const auto* side : {&p.a, &p.b})
    for (const RunRecord* r : *side)
      if (const std::string fault = r->file.empty() ? "" : trajectory_fault(r->file); !fault.empty())
        throw Error(fmt::format("{}: {}; repeat the run", r->file, fault));
}

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times.empty() ? kMissing : middle(times);
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
  run.time_a_s = median(a);
  run.time_b_s = median(b);
  run.findings = compare_records(*p.a.front(), *p.b.front());
}

}  // namespace

const char* word_for(Verdict v) {
  switch (v) {
    case Verdict::Same:
      return "same";
    case Verdict::New:
      return "new";
    case Verdict::Improved:
      return "improved";
    case Verdict::Changed:
      return "changed";
    case Verdict::Failed:
      return "FAILED";
  }
  return "";
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
                          : !time.enough() ? fmt::format("too few processes: at least {} a side", kMinProcesses)
                          : !in_turns      ? "no statement: A and B ran one after the other"
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
        const RunKey key = {r.header.scene, r.header.solver, r.header.setting, ""};
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
  return Check(allowed).run(baseline, runs);
}

Updated update_baseline(const Baseline& old, const std::vector<RunRecord>& runs, BaselineOrigin origin) {
  const auto results = by_name(runs);
  const auto entries = by_name(old);
  if (runs.empty()) throw Error("--update: expected results with at least one run");
  Updated out;
  out.baseline.origin = std::move(origin);
  for (const auto& [name, found] : results) {
    if (found.records.empty())
      throw Error(fmt::format("--update: {}: {}; a baseline is made of whole studies (`clothbench study … --resume`)",
                              name, found.missing->outcome.message));
    const auto group = entries.find(name);
    for (const RunRecord* r : found.records) {
      for (const Finding& f : motion_findings(*r))
        throw Error(fmt::format("--update: {}: {}; repeat the run", name, f.message));
      out.baseline.runs.push_back(gated_part(*r));
      const BaselineRun& now = out.baseline.runs.back();
      const BaselineRun* e = group == entries.end() ? nullptr : entry_for(group->second, now.key);
      const std::vector<Finding> findings =
          e == nullptr ? std::vector<Finding>{{Verdict::New, "run", "–", outcome_of(*r), "", ""}} : compare_run(*e, *r);
      if (!findings.empty())
        out.changes.push_back({now.key, findings});
      else if (!same_values(*e, now))
        ++out.within_slack;
    }
  }
  keep_other_assets(old, results, out);
  const auto by_key = [](const auto& a, const auto& b) { return a.key < b.key; };
  std::sort(out.baseline.runs.begin(), out.baseline.runs.end(), by_key);
  std::sort(out.changes.begin(), out.changes.end(), by_key);
  return out;
}

}  // namespace clothbench
