#include "report/web/page.hpp"

#include <fmt/format.h>

#include <map>

#include "base/child_process.hpp"
#include "base/files.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

extern "C" const char _binary_page_json_start[], _binary_page_json_end[];  // bundle.mjs, embedded by the linker

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Summary values that figures use.
constexpr const char* kFigureValues[] = {"fps_median", "free_fall_error", "bandwidth_read_peak_B_per_s",
                                         "device_memory_B"};
constexpr const char* kParts[] = {"rates", "contact", "generated", "claims", "accuracy", "stability", ""};

/// [p50, low, high, p95, p99, worst] in seconds, for each clock with frames.
void add_times(const Row& r, json& out) {
  const RunTimes& t = *r.times;
  if (t.wall.sorted.empty()) return;
  out["trials"] = r.run->trials.size();
  out["trust"] = r.trust();
  for (const auto& [name, times] : {std::pair{"wall", &t.wall},
                                    {"gpu_time", &t.device},
                                    {"contact_wall", &t.contact_wall},
                                    {"contact_gpu_time", &t.contact_device}})
    if (!times->sorted.empty())
      for (const double s :
           {times->at(0.5), times->median.low, times->median.high, times->at(0.95), times->at(0.99), times->at(1)})
        out[name].push_back(rounded(s));
}

/// A run or published value as data for figures. Missing = null.
json figure_row(const Row& r) {
  json out = {{"part", kParts[static_cast<int>(r.part)]},
              {"scene", r.scene},
              {"solver", r.solver},
              {"setting", r.setting},
              {"label", r.label()},
              {"status", r.status()},
              {"verdict", verdict(*r.run)}};
  const auto add = [&](const char* name, const std::string& text) {
    if (!text.empty()) out[name] = text;
  };
  add("sides", r.sides);
  add("frames", r.frames_mark());
  add("message", r.not_judged());
  const std::string commit = commit_of(*r.run), device = device_of(*r.run);
  if (!commit.empty()) add("made", "at " + commit + (device.empty() ? "" : ", on " + device));
  if (const json plugin = environment_of(*r.run, "plugin"); plugin.is_object())
    add("plugin", fs::path(plugin.value("path", "")).filename());
  add("file", fs::path(r.run->file).filename());
  if (environment_text(*r.run, "gpu") == "CPU") out["cpu"] = true;
  if (r.repeat > 1) out["repeated"] = true;
  if (!r.in_sweep())
    for (const std::string& name : violated_bounds(*r.run))
      out["violated"].push_back({name, found_of(r, name).text, expected_of(r, name)});
  add_times(r, out);
  if (r.part == Part::Generated)
    out.update({{"kind", r.drawn().value("kind", "")}, {"speed", rounded(r.drawn().value("speed_m_per_s", kMissing))}});
  if (r.part == Part::Claims) out.update(claim_fields(r));
  if (r.scaled) {
    out["family"] = r.family;
    out["paper_table"] = r.paper_table;
    out["published"] = r.published >= 0;
    out["width"] = std::sqrt(r.resolution.size());  // vertices per side; for a mesh, of a square grid with as many
    out["resolution"] = r.resolution.label();
    out["is_grid"] = r.resolution.grid[0] > 0;
    for (const char* name : kFigureValues) out[name] = rounded(r.value(name));
    out["fps_low"] = rounded(r.times->wall.rate.low);
    out["fps_high"] = rounded(r.times->wall.rate.high);
    if (r.published >= 0) out["fps_median"] = r.value("fps_at_72");
  }
  if (r.part == Part::Stability) out.update({{"case", case_of(r)}, {"grade", grade_of(r)}});
  if (r.part != Part::Truth) return out;
  out["wall_ms_per_s"] = rounded(r.wall_ms_per_s());
  out["device_ms_per_s"] = rounded(r.device_ms_per_s());
  out["error"] = rounded(r.error());
  out["not_ranked"] = r.not_ranked();
  out["ranking"] = r.truth->ranking;
  out["space_error"] = rounded(r.truth->space_error);
  out["reference_uncertainty"] = rounded(r.truth->uncertainty);
  out["refused"] = r.truth->refused();
  return out;
}

/// The study folders of the runs. Also stores in each row the index of its folder, the name of a missing run, and the
/// index of a run in the folder of a command `run`, by which figures.js finds its scene.
json studies_of(const RunTable& table, json& rows) {
  json out = json::array();
  std::vector<std::pair<fs::path, Texts>> folders;  // with the names of their runs
  for (const RunRecord& c : table.runs()) {
    const fs::path folder = fs::path(c.file).parent_path();
    const auto is_known = [&](const auto& f) { return f.first == folder; };
    if (c.file.empty() || std::any_of(folders.begin(), folders.end(), is_known) || !fs::exists(folder / "study.json"))
      continue;
    const StudyManifest m = read_manifest(folder);
    // Without the folders and the device of the machine that ran it.
    const std::string command = regex_replaced(regex_replaced(m.command_line, "^\\S*clothbench", "clothbench"),
                                               " (--out|-o|--device|--job)[ =]\\S+| --resume", "");
    out.push_back({{"study", m.study},
                   {"folder", fs::absolute(folder).lexically_normal().filename().string()},
                   {"command", command},
                   {"runs", m.runs.size()}});
    folders.emplace_back(folder, m.runs);
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const RunRecord& c = *table.rows()[k].run;
    const std::string name = run_name(c.header);
    const auto at = std::find_if(folders.begin(), folders.end(), [&](const auto& f) {  // a missing run has no folder
      return (c.file.empty() || f.first == fs::path(c.file).parent_path()) && contains(f.second, name);
    });
    if (at == folders.end()) continue;
    const auto n = static_cast<std::size_t>(at - folders.begin());
    rows[k]["study"] = n;
    if (c.file.empty()) rows[k]["name"] = name;
    if (out[n]["study"] == "run")
      rows[k]["job"] = std::find(at->second.begin(), at->second.end(), name) - at->second.begin();
  }
  return out;
}

/// Its rows are the head, then rows of cells. A cell is a text, or [text, value or null, tone, index of its run or
/// null, why].
json table_json(const ViewTable& t, const Row* first) {
  json rows = t.rows, again = json::array();
  for (std::size_t r = 0; r < t.cells.size(); ++r)
    for (std::size_t c = 0; c < t.cells[r].size(); ++c) {
      const Cell& cell = t.cells[r][c];
      const json run = cell.run == nullptr ? json() : json(cell.run - first);
      if (std::isfinite(cell.value) || *cell.tone != 0 || !run.is_null() || !cell.why.empty())
        rows[r + 1][c] = {cell.text, rounded(cell.value), cell.tone, run, cell.why};
    }
  for (const Group& g : t.again) {
    again.push_back(json::array());
    for (const Row* r : g) again.back().push_back(r - first);
  }
  return {{"title", t.title},     {"note", t.note}, {"rows", rows},
          {"again", again},       {"keys", t.keys}, {"solver_column", t.solver_column},
          {"solvers", t.solvers}, {"lead", t.lead}, {"explains", t.explains}};
}

std::string escaped(const std::string& text) {
  static const std::map<char, std::string> kNames = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : text) out += kNames.contains(c) ? kNames.at(c) : std::string(1, c);
  return out;
}

std::string table_html(const Table& t) {
  std::string out = "<table><caption>" + escaped(t.title) + "</caption><thead>";
  for (std::size_t k = 0; k < t.rows.size(); ++k) {
    out += "<tr>";
    for (std::size_t c = 0; c < t.rows[k].size(); ++c) {
      const std::string cell = k == 0 ? "th scope=\"col\"" : c == 0 ? "th scope=\"row\"" : "td";
      out += fmt::format("<{}>{}</{}>", cell, escaped(t.rows[k][c]), cell.substr(0, 2));
    }
    out += k == 0 ? "</tr></thead><tbody>" : "</tr>";
  }
  return out + "</tbody></table><p class=\"note\">" + escaped(t.note) + "</p>";
}

/// The part that works without scripts: title, facts, warnings, tiles and the first two tables.
std::string head_html(const Page& page) {
  std::string out = "<h1>" + escaped(page.heading.title) +
                    "</h1><p>clothbench runs cloth solvers on the same scenes and reports their speed together with "
                    "its cost in error and in contact failures.</p><p class=\"meta\" tabindex=\"0\">";
  for (const auto& [name, value] : page.heading.facts)
    out += (name == page.heading.facts.front().first ? "" : " · ") + escaped(name) + " <b>" + escaped(value) + "</b>";
  out += "</p>";
  for (const std::string& w : page.warnings) out += "<p class=\"warning\" tabindex=\"0\">" + escaped(w) + "</p>";
  out += "<div class=\"tiles\">";
  for (const Tile& t : page.tiles)
    out += fmt::format(
        "<div class=\"tile\"><p>{}</p><p class=\"v\">{} <small>{}</small></p><p class=\"more\">{}</p>{}</div>",
        escaped(t.title + ", " + t.entries[0].label), escaped(t.entries[0].value), escaped(t.entries[0].about),
        escaped(t.others()),
        t.left_out.empty() ? "" : "<p><a href=\"#first-table\">" + escaped(t.left_out) + "</a></p>");
  out +=
      "</div><h2 class=\"skip\">Error and speed</h2><div class=\"pair\"><div "
      "id=\"hero\"><!--clothbench:figure--></div><div id=\"first-table\">";
  std::size_t tables = 0;
  for (const PageSection& s : page.sections)
    for (const ViewTable& t : s.tables)
      if (++tables <= 2) out += table_html(t);
  return out + "</div></div>";
}

}  // namespace

json rounded(double v) { return std::isfinite(v) ? json(std::stod(fmt::format("{:.6g}", v))) : json(); }

json page_document(const RunTable& table, const Page& page) {
  json shown = json::array(), rows = json::array(), tiles = json::array();
  for (const Tile& t : page.tiles) {
    json entries = json::array();
    for (const Tile::Entry& e : t.entries)
      entries.push_back({{"solver", e.solver}, {"label", e.label}, {"value", e.value}, {"about", e.about}});
    tiles.push_back({{"title", t.title}, {"entries", std::move(entries)}});
  }
  for (const Row& r : table.rows()) rows.push_back(figure_row(r));
  json studies = studies_of(table, rows);
  for (const PageSection& s : page.sections) {
    json tables = json::array();
    for (const ViewTable& t : s.tables) tables.push_back(table_json(t, table.rows().data()));
    shown.push_back({{"id", s.id}, {"title", s.title}, {"tables", std::move(tables)}});
  }
  return {{"title", page.heading.title}, {"notes", page.notes},
          {"sections", shown},           {"tiles", tiles},
          {"runs", std::move(rows)},     {"studies", std::move(studies)},
          {"solvers", solver_roles()},   {"history", page.history}};
}

std::string page_html(const std::string& html, const Page& page, const json& document, const Motions& motions) {
  const auto data = [](const std::string& id, const std::string& base64) {
    return "<script type=\"text/plain\" id=\"" + id + "\">" + base64 + "</script>\n";
  };
  std::string blobs, out = html;
  for (std::size_t k = 0; k < motions.blobs.size(); ++k) blobs += data(fmt::format("blob-{}", k), motions.blobs[k]);
  for (const auto& [mark, text] : {std::pair<std::string, std::string>{"<!--clothbench:motions-->", blobs},
                                   {"<!--clothbench:data-->", data("clothbench-data", packed(document)) +
                                                                  data("clothbench-motions", packed(motions.document))},
                                   {"<!--clothbench:head-->", head_html(page)},
                                   {"<!--clothbench:title-->", escaped(page.heading.title)}})
    out.replace(out.find(mark), mark.size(), text);
  return out;
}

#ifdef CLOTHBENCH_WITH_PAGE
PageTemplate page_template() {
  const json page = json_from({_binary_page_json_start, _binary_page_json_end});
  return {page["html"], page["missing"], page["figures"]};
}
#else
PageTemplate page_template() { return {"", "this build was made without it, or without Node and npm"}; }
Motions motions_of(const RunTable&, std::size_t) { return {}; }
std::string packed(const json&) { return ""; }
#endif

std::string write_page(const fs::path& out, const RunTable& table, const Page& page, const PageTemplate& from) {
  if (from.html.empty()) {
    fs::remove(out / "index.html");  // remove the page of an earlier report
    return "The interactive page was left out: " + from.missing + ".";
  }
  write_file_atomically(out / "index.html", page_html(from.html, page, page_document(table, page), motions_of(table)));
  return "";
}

std::pair<std::string, std::string> draw_pictures(const fs::path& out, const PageTemplate& page) {
  const fs::path folder = out / "figures", script = folder / "figures.cjs", markdown = folder / "figures.md";
  const auto without = [](const std::string& why) {
    return std::pair{"Figures were left out: " + why + ".", std::string()};
  };
  if (fs::exists(folder))
    for (const fs::path& file : std::vector<fs::path>(fs::directory_iterator(folder), fs::directory_iterator()))
      if (contains(std::array{".svg", ".pdf"}, file.extension())) fs::remove(file);
  if (page.figures.empty()) return without(page.missing);
  fs::create_directories(folder);
  write_file_atomically(script, page.figures);
  ChildEnd end{.code = 1};
  try {
    end = ChildProcess({"node", script.string(), (out / "index.html").string(), folder.string()}).wait();
  } catch (const Error&) {  // there is no Node
  }
  fs::remove(script);
  if (end.how != ChildEnd::How::Exited || end.code != 0)
    return without("Node 18 or later was not found, or failed (Debian: nodejs)");
  const std::string shown = content_of(markdown);
  fs::remove(markdown);
  return {"", shown};
}

}  // namespace clothbench
