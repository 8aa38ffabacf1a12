#include "check/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

using Entries = std::vector<const BaselineCell*>;

/// The results of one cell, whatever its assets: those that are there, and what is known of one that is not.
struct Found {
  std::vector<const CellRecord*> records;
  const CellRecord* missing = nullptr;
};

/// By file name, because that is all there is of a planned cell without a result.
std::map<std::string, Found> by_name(const std::vector<CellRecord>& cells) {
  std::map<std::string, Found> out;
  std::map<CellKey, int> seen;
  for (const CellRecord& c : cells) {
    const CellKey key = gated_part(c).key;
    Found& found = out[key.file_name()];
    if (c.outcome.status == "missing") {
      found.missing = &c;
      continue;
    }
    if (seen[key]++ > 0) throw Error(key.text() + ": stands twice among the results; give each cell once");
    found.records.push_back(&c);
  }
  return out;
}

std::map<std::string, Entries> by_name(const Baseline& b) {
  std::map<std::string, Entries> out;
  for (const BaselineCell& c : b.cells) out[c.key.file_name()].push_back(&c);
  return out;
}

const BaselineCell* entry_for(const Entries& entries, const CellKey& key) {
  for (const BaselineCell* e : entries)
    if (e->key == key) return e;
  return nullptr;
}

std::string outcome_of(const CellRecord& c) { return c.outcome.status; }

Finding missing(const Found& found) {
  return {Verdict::Failed,
          "cell",
          "present",
          "missing",
          "",
          found.missing != nullptr ? found.missing->outcome.message : "no such cell among the results"};
}

std::string kind(const std::string& assets) { return assets.empty() ? "unnamed" : assets; }

/// No verdict is made of two rules.
void refuse_other_versions(const BaselineCell& was, const BaselineCell& is) {
  for (const VersionDifference& v : version_differences(was, is))
    throw Error(
        fmt::format("{}: metric {}: the baseline has version {} of its rule, the result version {}; the two cannot be "
                    "compared. Accept the "
                    "result with `clothbench check RUNS --baseline FILE --update`, or run the cell again with the "
                    "program the baseline was made with",
                    is.key.text(), v.metric, v.baseline, v.found));
}

class Check {
 public:
  Checked run(const Baseline& baseline, const std::vector<CellRecord>& cells) {
    const auto results = by_name(cells);
    const auto entries = by_name(baseline);
    for (const auto& [name, group] : entries) {
      const auto at = results.find(name);
      known(group, at == results.end() ? Found{} : at->second);
    }
    for (const auto& [name, found] : results)
      if (entries.count(name) == 0) unknown(found);
    std::sort(out_.cells.begin(), out_.cells.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    return out_;
  }

 private:
  void known(const Entries& entries, const Found& found) {
    if (found.records.empty()) return add(entries.front()->key, {missing(found)});
    std::size_t compared = 0;
    for (const CellRecord* r : found.records)
      if (const BaselineCell* e = entry_for(entries, gated_part(*r).key); e != nullptr) {
        refuse_other_versions(*e, gated_part(*r));
        add(e->key, compare_cell(*e, *r));
        ++compared;
      }
    if (compared == 0) return add(entries.front()->key, {other_assets(*entries.front(), *found.records.front())});
    out_.other_assets += entries.size() - compared;
    for (const CellRecord* r : found.records)
      if (const CellKey key = gated_part(*r).key; entry_for(entries, key) == nullptr) add_new(key, *r);
  }

  void unknown(const Found& found) {
    for (const CellRecord* r : found.records) add_new(gated_part(*r).key, *r);
    if (found.records.empty() && found.missing != nullptr) add(gated_part(*found.missing).key, {missing(found)});
  }

  /// Procedural rooms and hands are other scenes than real ones: a run without the real ones must not pass for them.
  static Finding other_assets(const BaselineCell& entry, const CellRecord& r) {
    return {Verdict::Failed,
            "assets",
            kind(entry.key.assets),
            kind(gated_part(r).key.assets),
            "",
            "the baseline has this cell only with other assets: fetch them (scripts/fetch-assets.sh), or add this kind "
            "with --update"};
  }

  void add_new(const CellKey& key, const CellRecord& r) {
    add(key, {{Verdict::New, "cell", "–", outcome_of(r), "", "not in the baseline; --update adds it"}});
  }
  void add(const CellKey& key, std::vector<Finding> findings) { out_.cells.push_back({key, std::move(findings)}); }

  Checked out_;
};

/// Adds what `from` has and `to` lacks.
void merge(std::vector<std::string>& to, const std::vector<std::string>& from) {
  for (const std::string& text : from)
    if (std::find(to.begin(), to.end(), text) == to.end()) to.push_back(text);
  std::sort(to.begin(), to.end());
}

/// Entries of `old` whose cell has results, but only with other assets, stay with their origin; those without any
/// result are removed.
void keep_other_assets(const Baseline& old, const std::map<std::string, Found>& results, Updated& out) {
  for (const BaselineCell& e : old.cells) {
    const auto at = results.find(e.key.file_name());
    if (at == results.end()) {
      out.removed.push_back(e.key);
      continue;
    }
    const auto& records = at->second.records;
    if (std::any_of(records.begin(), records.end(), [&](const CellRecord* r) { return gated_part(*r).key == e.key; }))
      continue;
    out.baseline.cells.push_back(e);
    merge(out.baseline.origin.runs, old.origin.runs);
    merge(out.baseline.origin.commits, old.origin.commits);
    merge(out.baseline.origin.devices, old.origin.devices);
  }
}

bool same_values(const BaselineCell& a, const BaselineCell& b) {
  return baseline_text({{}, {a}}) == baseline_text({{}, {b}});
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

Verdict CheckedCell::verdict() const {
  Verdict worst = Verdict::Same;
  for (const Finding& f : findings) worst = std::max(worst, f.verdict);
  return worst;
}

std::size_t Checked::count(Verdict v) const {
  return static_cast<std::size_t>(
      std::count_if(cells.begin(), cells.end(), [&](const CheckedCell& c) { return c.verdict() == v; }));
}

Checked check_cells(const Baseline& baseline, const std::vector<CellRecord>& cells) {
  return Check().run(baseline, cells);
}

Updated update_baseline(const Baseline& old, const std::vector<CellRecord>& cells, BaselineOrigin origin) {
  const auto results = by_name(cells);
  const auto entries = by_name(old);
  if (cells.empty()) throw Error("--update: no cell among the results");
  Updated out;
  out.baseline.origin = std::move(origin);
  for (const auto& [name, found] : results) {
    if (found.records.empty())
      throw Error(fmt::format("--update: {}: {}; a baseline is made of whole studies (`clothbench study … --resume`)",
                              name, found.missing->outcome.message));
    const auto group = entries.find(name);
    for (const CellRecord* r : found.records) {
      out.baseline.cells.push_back(gated_part(*r));
      const BaselineCell& now = out.baseline.cells.back();
      const BaselineCell* e = group == entries.end() ? nullptr : entry_for(group->second, now.key);
      const std::vector<Finding> findings =
          e == nullptr ? std::vector<Finding>{{Verdict::New, "cell", "–", outcome_of(*r), "", ""}}
                       : compare_cell(*e, *r);
      if (!findings.empty())
        out.changes.push_back({now.key, findings});
      else if (!same_values(*e, now))
        ++out.within_slack;
    }
  }
  keep_other_assets(old, results, out);
  const auto by_key = [](const auto& a, const auto& b) { return a.key < b.key; };
  std::sort(out.baseline.cells.begin(), out.baseline.cells.end(), by_key);
  std::sort(out.changes.begin(), out.changes.end(), by_key);
  return out;
}

}  // namespace clothbench
