#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "report/web/page.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Quotes a path as one word of a shell command.
std::string quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

bool runs(const std::string& command) { return std::system(command.c_str()) == 0; }

/// Name of the Node program; empty if there is none. Older versions of Debian name it nodejs.
std::string find_node() {
  for (const char* node : {"node", "nodejs"})
    if (runs(std::string(node) + " --version >/dev/null 2>&1")) return node;
  return "";
}

/// A temporary folder for drawing.
class Scratch {
 public:
  explicit Scratch(fs::path path) : path_(std::move(path)) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool is_file_name(const std::string& name) {
  return !name.empty() && fs::path(name).filename() == name && name != "." && name != "..";
}

/// Pictures that an earlier report wrote.
std::set<std::string> listed_pictures(const fs::path& out) {
  std::set<std::string> names;
  if (!fs::exists(out / kPicturesList)) return names;
  const json j = json::parse(content_of(out / kPicturesList), nullptr, false);
  if (!j.is_object() || j.value("format", "") != "clothbench-report-pictures" || !j.contains("pictures") ||
      !j["pictures"].is_array())
    throw Error((out / kPicturesList).string() +
                ": expected the list of a report's pictures; move the file away or give another folder with -o");
  for (const json& name : j["pictures"])
    if (name.is_string() && is_file_name(name.get<std::string>())) names.insert(name.get<std::string>());
  return names;
}

void write_list(const fs::path& out, const std::set<std::string>& names) {
  const json j = {{"format", "clothbench-report-pictures"}, {"format_version", 1}, {"pictures", names}};
  write_file_atomically(out / kPicturesList, j.dump(1) + "\n");
}

/// Makes a PDF of every SVG in a folder, and a PNG of the wide ones. If one fails, removes them all and returns false.
bool draw_png(const fs::path& folder) {
  std::vector<fs::path> svg;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".svg") svg.push_back(entry.path());
  const auto convert = [](fs::path file, const std::string& kind, const std::string& options) {
    const fs::path to = fs::path(file).replace_extension(kind);
    // A PDF file states when it was made; the same runs are to give the same file.
    return runs(
        fmt::format("SOURCE_DATE_EPOCH=0 rsvg-convert {} {} -o {} 2>/dev/null", options, quoted(file), quoted(to)));
  };
  const bool drawn = std::all_of(svg.begin(), svg.end(), [&](const fs::path& file) {
    return convert(file, ".pdf", "--format pdf") &&
           (!file.stem().string().ends_with("-wide") || convert(file, ".png", "--zoom 3"));
  });
  for (const fs::path& file : svg)
    for (const char* kind : {".pdf", ".png"})
      if (!drawn) fs::remove(fs::path(file).replace_extension(kind));
  return drawn;
}

/// Puts the figure for readers without JavaScript into the page.
void add_first_figure(const fs::path& index, const std::string& svg) {
  std::string page = content_of(index);
  constexpr std::string_view kMark = "<!--clothbench:figure-->";
  if (const std::size_t at = page.find(kMark); at != std::string::npos)
    write_file_atomically(index, page.replace(at, kMark.size(), svg));
}

void put_in_place(const fs::path& out, const fs::path& from) {
  const std::set<std::string> old = listed_pictures(out);
  std::set<std::string> drawn;
  for (const auto& entry : fs::directory_iterator(from))
    if (const std::string kind = entry.path().extension(); kind == ".svg" || kind == ".png" || kind == ".pdf")
      drawn.insert(entry.path().filename().string());
  for (const std::string& name : drawn)
    if (!old.contains(name) && fs::exists(out / name))
      throw Error((out / name).string() +
                  ": a picture of this name must be written, but no report wrote this file; move it away or give "
                  "another folder with -o");
  // Lists old and new pictures first, so that after a kill all files left here are known as a report's.
  std::set<std::string> both = old;
  both.insert(drawn.begin(), drawn.end());
  if (!both.empty()) write_list(out, both);
  for (const std::string& name : drawn) fs::rename(from / name, out / name);
  for (const std::string& name : old)
    if (!drawn.contains(name)) fs::remove(out / name);
  if (!both.empty()) write_list(out, drawn);
}

}  // namespace

Drawn draw_pictures(const fs::path& out, const PageTemplate& page) {
  const auto without = [&](const std::string& why) {
    return Drawn{"Figures were left out: " + why + "." +
                     (listed_pictures(out).empty() ? "" : " The pictures in this folder come from an earlier report."),
                 ""};
  };
  if (page.figures.empty())
    return without(page.missing.empty() ? "this build was made without them (CLOTHBENCH_WITH_PAGE)" : page.missing);
  const std::string node = find_node();
  if (node.empty()) return without("Node 18 or later was not found (Debian: nodejs)");
  const Scratch scratch(temporary_name(fs::absolute(out) / "pictures"));
  const fs::path script = scratch.path() / "figures.cjs";
  std::ofstream(script, std::ios::binary) << page.figures;
  if (!runs(fmt::format("{} {} {} {}", node, quoted(script), quoted(fs::absolute(out) / "index.html"),
                        quoted(scratch.path()))))
    return without("Node could not draw them; 18 or later is needed (Debian: nodejs)");
  Drawn drawn{"", content_of(scratch.path() / "figures.md")};
  add_first_figure(out / "index.html", content_of(scratch.path() / "hero.html"));
  if (!draw_png(scratch.path()))
    drawn.fault = "PNG and PDF pictures were left out: rsvg-convert was not found (Debian: librsvg2-bin).";
  put_in_place(out, scratch.path());
  return drawn;
}

}  // namespace clothbench
