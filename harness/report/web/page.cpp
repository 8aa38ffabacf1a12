#include "report/web/page.hpp"

#include "clothbench/error.hpp"
#include "report/plugin_marks.hpp"
#include "report/roles.hpp"
#include "report/web/template.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kDataMark[] = "<!--clothbench:data-->";

json table_json(const Table& t) { return {{"title", t.title}, {"note", t.note}, {"rows", t.rows}}; }

/// Text inside a script element ends at "</script" or changes its meaning at "<!--": neither is left.
std::string script_safe(const std::string& json_text) {
  std::string out;
  out.reserve(json_text.size());
  for (const char c : json_text)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

}  // namespace

json page_document(const std::vector<RunRecord>& runs, const Page& page, const Motions& motions) {
  json sections = json::array();
  for (const PageSection& s : page.sections) {
    json tables = json::array();
    for (const Table& t : s.tables) tables.push_back(table_json(t));
    sections.push_back({{"id", s.id}, {"title", s.title}, {"tables", std::move(tables)}});
  }
  return {{"format", "clothbench-report"},
          {"format_version", 1},
          {"runs", runs.size()},
          {"headline", page.headline},
          {"sections", std::move(sections)},
          {"rates", page.rates},
          {"penetration", page.penetration},
          {"work", page.work},
          {"maps", page.maps},
          {"cases", page.cases},
          {"commands", page.commands},
          {"solvers", solver_roles()},
          {"motions", PluginMarks(runs).data(motions.document)}};
}

std::string page_html(const std::string& html, const json& document, const std::vector<std::string>& blobs) {
  const std::size_t at = html.find(kDataMark);
  if (at == std::string::npos)
    throw Error("the page's template has no place for the data; build clothbench again", ExitCode::CheckFailed);
  std::string data = "<script type=\"application/json\" id=\"clothbench-data\">" +
                     script_safe(document.dump(-1, ' ', true, json::error_handler_t::replace)) + "</script>\n";
  for (std::size_t k = 0; k < blobs.size(); ++k)
    data += "<script type=\"text/plain\" id=\"blob-" + std::to_string(k) + "\">" + blobs[k] + "</script>\n";
  return html.substr(0, at) + data + html.substr(at + sizeof kDataMark - 1);
}

std::string write_page(const fs::path& out, const std::vector<RunRecord>& runs, const Page& page,
                       const PageTemplate& from) {
  if (from.html.empty()) {
    fs::remove(out / "index.html");  // an older run's page is not this report's
    return "The interactive page was left out: " + from.missing + ".";
  }
  const Motions motions = motions_of(runs, page.fronts);
  write_file_atomically(out / "index.html", page_html(from.html, page_document(runs, page, motions), motions.blobs));
  return "";
}

}  // namespace clothbench
