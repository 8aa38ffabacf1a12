#include "report/view.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "report/report.hpp"

namespace clothbench {
namespace {

const Cell kNotRun("not run", kMissing, "dim", "no run of this solver in this scene in the studies of this report");

/// A row of a table before its cells are computed.
struct TableRow {
  Keys keys;
  Group runs;
  std::map<std::string, Group> across = {};
};

/// Every combination of a run's values, one per key.
std::vector<Keys> combinations(const View& v, const Row& r) {
  std::vector<Keys> out = {{}};
  for (const Key& k : v.keys) {
    std::vector<Keys> longer;
    for (const Keys& start : out)
      for (const KeyValue& value : k.of(r)) {
        longer.push_back(start);
        longer.back().push_back(value);
      }
    out = std::move(longer);
  }
  return out;
}

std::vector<TableRow> rows_of(const View& v, const Group& runs) {
  std::vector<TableRow> out;
  std::map<Keys, std::size_t> index;
  for (const Row* r : runs)
    for (const Keys& keys : combinations(v, *r)) {
      const auto [at, is_new] = index.try_emplace(keys, out.size());
      if (is_new) out.push_back({keys, {}, {}});
      TableRow& row = out[at->second];
      row.runs.push_back(r);
      if (v.across)
        for (const KeyValue& value : v.across->key.of(*r)) row.across[value.text].push_back(r);
    }
  if (v.order)
    std::stable_sort(out.begin(), out.end(), [&](auto& a, auto& b) { return v.order(a.runs) < v.order(b.runs); });
  if (v.by_key) std::stable_sort(out.begin(), out.end(), [](auto& a, auto& b) { return a.keys < b.keys; });
  return out;
}

/// Values of the columns that depend on the runs, in order.
Texts values_across(const Across& a, const Group& runs) {
  Texts out;
  std::map<std::string, double> order;
  for (const Row* r : runs)
    for (const auto& [unused, value] : a.key.of(*r)) {
      if (!contains(out, value)) out.push_back(value);
      if (a.order) order[value] = a.order(*r);
    }
  if (a.order) std::stable_sort(out.begin(), out.end(), [&](auto& x, auto& y) { return order[x] < order[y]; });
  return out;
}

/// Adds a column if a row has a value for it. Returns whether it was added.
bool add_column(ViewTable& t, const std::string& head, const std::vector<Cell>& cells, bool always,
                const std::string& solver = "") {
  if (!always && std::all_of(cells.begin(), cells.end(), std::mem_fn(&Cell::is_missing))) return false;
  t.solvers.push_back(solver);
  t.rows[0].push_back(head);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    t.rows[k + 1].push_back(or_dash(cells[k].text));
    t.cells[k].push_back(cells[k]);
    t.cells[k].back().text = t.rows[k + 1].back();
  }
  return true;
}

std::string note_of(const View& v, const Group& runs) {
  Texts parts = {v.note, v.more ? v.more(runs) : "", v.timed ? withheld_note(runs) : ""};
  std::erase(parts, "");
  return joined(parts, "\n");
}

/// Has no rows if no cell has a value and no time is withheld.
ViewTable table_of(const View& v, const std::string& title, const Group& runs) {
  ViewTable t{{title, note_of(v, runs), {}, v.in_full}};
  const std::vector<TableRow> rows = rows_of(v, runs);
  t.rows.resize(rows.size() + 1);
  t.cells.resize(rows.size());
  t.explains = v.explains;
  for (const TableRow& r : rows) t.again.push_back(r.runs);
  for (std::size_t k = 0; k < v.keys.size(); ++k) {
    if (v.keys[k].head.empty()) continue;
    std::vector<Cell> cells;
    for (const TableRow& r : rows) {
      cells.emplace_back(r.keys[k].text);
      if (v.keys[k].is_solver && !r.keys[k].all) cells.back().run = r.runs.front();
    }
    if (add_column(t, v.keys[k].head, cells, k == 0) && v.keys[k].is_solver)
      t.solver_column = static_cast<int>(t.rows[0].size()) - 1;
  }
  t.keys = std::max<std::size_t>(1, t.rows[0].size());
  bool any = v.columns.empty() && !v.across;
  const Texts across = v.across ? values_across(*v.across, runs) : Texts();
  for (std::size_t n = 0; n < across.size(); ++n) {
    std::vector<Cell> cells;
    std::string solver;
    for (const TableRow& r : rows) {
      const auto at = r.across.find(across[n]);
      const bool found = at != r.across.end();
      cells.push_back(found ? v.across->cell(at->second, r.keys) : v.across->key.is_solver ? kNotRun : Cell());
      any = any || (found && !cells.back().is_missing());
      if (at != r.across.end() && v.across->key.is_solver) solver = at->second.front()->solver;
    }
    if (across.size() - n <= v.across->leading) t.lead.push_back(t.rows[0].size());
    add_column(t, across[n], cells, true, solver);
  }
  for (const ViewColumn& c : v.columns) {
    std::vector<Cell> cells;
    for (const TableRow& r : rows) {
      cells.push_back(c.cell(r.runs, r.keys));
      if (v.timed && r.runs.size() == 1 && cells.back().is_missing()) cells.back().why = r.runs.front()->not_timed();
    }
    std::set<std::string> texts;
    for (const Cell& cell : cells)
      if (!cell.is_missing()) texts.insert(cell.text);
    const bool added = (!c.if_differs || texts.size() > 1) && add_column(t, c.head, cells, false);
    if (added && c.leads) t.lead.push_back(t.rows[0].size() - 1);
    any = any || added;
  }
  if (!any && (!v.timed || withheld_note(runs).empty())) t.rows.resize(1);
  return t;
}

}  // namespace

Key key(std::string head, std::function<std::string(const Row&)> of, bool is_solver) {
  return {std::move(head), [of = std::move(of)](const Row& r) -> Keys { return {of(r)}; }, is_solver};
}

Key scene_key() { return key("scene", &Row::scene); }
Key solver_key() { return key("solver", &Row::label, true); }
Key sides_key() { return key("sides", &Row::sides); }

ViewColumn column(std::string head, std::function<Cell(const Row&)> cell, bool if_differs, Pick pick) {
  return {std::move(head),
          [cell = std::move(cell), pick = std::move(pick)](const Group& g, const Keys&) {
            const Row* r = pick(g);
            return r == nullptr ? Cell() : cell(*r);
          },
          if_differs};
}

Cell trials_cell(const Row& r) {
  return r.run->trials.empty() ? Cell() : number_cell(static_cast<double>(r.run->trials.size()), 1);
}
Cell rank_cell(const Row& r) { return r.rank > 0 ? number_cell(r.rank, 1) : Cell(); }

std::vector<ViewTable> tables_of(const View& v, const RunTable& table) {
  std::vector<std::pair<std::string, Group>> groups;
  for (const Row& r : table.rows()) {
    if (!v.where(r)) continue;
    const std::string title = v.each ? v.each(r) : v.title;
    find_or_add(groups, [&](auto& g) { return g.first == title; }, {title, {}}).second.push_back(&r);
  }
  std::vector<ViewTable> out;
  for (const auto& [title, runs] : groups)
    if (ViewTable t = table_of(v, title, runs); t.rows.size() > 1 && t.again[0][0]->published < 0)
      out.push_back(std::move(t));
  return out;
}

const std::vector<View>& views() {
  static const std::vector<View> all = [] {
    std::vector<View> out;
    for (auto* more : {rate_views, overview_views, contact_views, reproduction_views, accuracy_views})
      for (View& v : more()) out.push_back(std::move(v));
    return out;
  }();
  return all;
}

std::string note(const char* table) { return json_from(kNotes).at(table); }

Cell number_cell(double v, int digits) { return std::isfinite(v) ? Cell(significant(v, digits), v) : Cell(); }

Cell paired_cell(double a, double b, int digits) {
  return std::isfinite(a) || std::isfinite(b) ? Cell(paired(a, b, " / ", digits), a) : Cell();
}

Cell share_cell(std::size_t passed, std::size_t all) {
  if (all == 0) return {};
  const Interval i = wilson_95(passed, all);
  return {fmt::format("{}/{} ({:.0f}–{:.0f} %)", passed, all, 100 * i.low, 100 * i.high),
          static_cast<double>(passed) / static_cast<double>(all)};
}

Cell ending_cell(const RunRecord& c) {
  const std::string& status = c.outcome.status;
  const bool not_run = status == "unsupported" || status == "missing" || status == "over_budget";
  return {ending(c.outcome), kMissing, status == "ok" ? "" : not_run ? "dim" : "bad"};
}

Cell verdict_cell(const Row& r) {
  const std::string v = verdict(*r.run);
  Cell out = r.status() != "ok" ? ending_cell(*r.run)
                                : Cell(v == kNoVerdict ? "" : v, kMissing,
                                       v == "pass"   ? "good"
                                       : v == "fail" ? "bad"
                                                     : "dim");
  if (v == "fail") out.run = &r;
  if (v != "pass" && v != "fail") out.why = r.not_judged();
  return out;
}

}  // namespace clothbench
