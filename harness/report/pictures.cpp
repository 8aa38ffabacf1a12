// The figures of a report as files.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "base/files.hpp"
#include "report/web/page.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// Quotes a path as one word of a shell command.
std::string quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

bool runs(const std::string& command) { return std::system(command.c_str()) == 0; }

std::vector<fs::path> pictures_in(const fs::path& folder, const std::vector<std::string>& kinds) {
  std::vector<fs::path> out;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (contains(kinds, entry.path().extension())) out.push_back(entry.path());
  return out;
}

void remove_pictures(const fs::path& folder, const std::vector<std::string>& kinds) {
  for (const fs::path& file : pictures_in(folder, kinds)) fs::remove(file);
}

/// Makes a PDF of every SVG in a folder. If one fails, removes them all and returns false.
bool convert(const fs::path& folder) {
  const std::vector<fs::path> all = pictures_in(folder, {".svg"});
  const bool done = std::all_of(all.begin(), all.end(), [](const fs::path& svg) {
    // A PDF file states when it was made; the same runs are to give the same file.
    return runs(fmt::format("SOURCE_DATE_EPOCH=0 rsvg-convert --format pdf {} -o {} 2>/dev/null", quoted(svg),
                            quoted(fs::path(svg).replace_extension(".pdf"))));
  });
  if (!done) remove_pictures(folder, {".pdf"});
  return done;
}

}  // namespace

Drawn draw_pictures(const fs::path& out, const PageTemplate& page) {
  const fs::path folder = out / "figures", script = folder / "figures.cjs";
  remove_pictures(folder, {".svg", ".pdf"});
  const auto without = [](const std::string& why) { return Drawn{"Figures were left out: " + why + ".", ""}; };
  if (page.figures.empty()) return without(page.missing);
  fs::create_directories(folder);
  write_file_atomically(script, page.figures);
  const bool drawn =
      runs(fmt::format("node {} {} {}", quoted(script), quoted(fs::absolute(out / "index.html")), quoted(folder)));
  fs::remove(script);
  if (!drawn) return without("Node 18 or later was not found, or failed (Debian: nodejs)");
  const std::string markdown = content_of(folder / "figures.md");
  fs::remove(folder / "figures.md");
  return {convert(folder) ? "" : "PDF pictures were left out: rsvg-convert was not found (Debian: librsvg2-bin).",
          markdown};
}

}  // namespace clothbench
