// The figures of a report as files.
#include "base/child_process.hpp"
#include "base/files.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "report/web/page.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

bool run_by_node(const fs::path& script, const fs::path& page, const fs::path& folder) {
  try {
    const ChildEnd end = ChildProcess({"node", script.string(), page.string(), folder.string()}).wait();
    return end.how == ChildEnd::How::Exited && end.code == 0;
  } catch (const Error&) {
    return false;  // there is no Node
  }
}

}  // namespace

Drawn draw_pictures(const fs::path& out, const PageTemplate& page) {
  const fs::path folder = out / "figures", script = folder / "figures.cjs", markdown = folder / "figures.md";
  const auto without = [](const std::string& why) { return Drawn{"Figures were left out: " + why + ".", ""}; };
  if (fs::exists(folder))
    for (const fs::path& file : std::vector<fs::path>(fs::directory_iterator(folder), fs::directory_iterator()))
      if (contains(std::array{".svg", ".pdf"}, file.extension())) fs::remove(file);
  if (page.figures.empty()) return without(page.missing);
  fs::create_directories(folder);
  write_file_atomically(script, page.figures);
  const bool drawn = run_by_node(script, out / "index.html", folder);
  fs::remove(script);
  if (!drawn) return without("Node 18 or later was not found, or failed (Debian: nodejs)");
  Drawn done{"", content_of(markdown)};
  fs::remove(markdown);
  return done;
}

}  // namespace clothbench
