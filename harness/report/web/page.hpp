#pragma once
#include <array>
#include <filesystem>

#include "report/report.hpp"
#include "report/view.hpp"

namespace clothbench {

/// The page without data, and the script that draws its figures, from bundle.mjs at build time.
struct PageTemplate {
  std::string html;          ///< empty if it could not be built
  std::string missing;       ///< in that case the reason, as the end of a sentence
  std::string figures = {};  ///< script for Node, from src/stills.js
};

PageTemplate page_template();
/// Draws the figures of `out`/index.html into `out`/figures with Node (src/stills.js), after removing an earlier
/// report's images. Returns a sentence on why there are no images (empty if there are), and Markdown that shows them.
std::pair<std::string, std::string> draw_pictures(const std::filesystem::path& out, const PageTemplate&);

/// A section of the report with equal tables in report.md and on the page.
struct PageSection {
  std::string id, title;
  std::vector<ViewTable> tables;
};

struct Page {
  Heading heading;
  std::vector<std::string> warnings;  ///< sentences on the whole report: a software device, invalid measurements
  std::vector<Tile> tiles;
  std::vector<std::string> notes;  ///< on plugins, verdicts
  std::vector<PageSection> sections;
  nlohmann::json history;  ///< lines of a log of `check --log`; empty: none
};

/// A cloth's motion, thinned in time and quantised. Frame f, axis a, vertex v: x = low_m[a] + step_m · q with
/// 0 ≤ q < 2^16. `bytes`: zlib of q (frame, axis, vertex; 16 bits) minus its prediction, modulo 2^16. The prediction:
/// 2 q(f-1) - q(f-2); in frame 1, q(0); in frame 0, the previous value (0 for the first one).
struct PackedMotion {
  std::vector<std::size_t> frames;  ///< frames of the run that are kept
  double step_m = 0;
  std::array<double, 3> low_m = {};
  std::string bytes;
  /// First frame that is omitted because the cloth is not finite or has 20 times its initial extent; -1: none.
  long cut_at = -1;
};

/// Packs all frames of a replay; the result has no frames if the first is not finite.
PackedMotion pack_motion(const Replay&);

/// Motions for the viewer. The document has `runs` (index into the page's runs, frames, index into `blobs`), `first`
/// (run whose scene is shown first), `colliders` (by scene; arrays as 32-bit words) and `left_out` (a number). `blobs`:
/// base64 of zlib.
struct Motions {
  nlohmann::json document;
  std::vector<std::string> blobs;
};

/// Reads trajectories from the runs' files by priority, at most 150 frames each, until the base64 reaches this size.
Motions motions_of(const RunTable&, std::size_t budget_B = 2'800'000);
/// Base64 of zlib of the text.
std::string packed(const nlohmann::json&);
/// Rounded to six digits; null if not finite.
nlohmann::json rounded(double);
/// The document of the page: tables, one object per run, study folders; neither series nor motions.
nlohmann::json page_document(const RunTable&, const Page&);
/// One self-contained HTML page. `html` has the placeholders of bundle.mjs.
std::string page_html(const std::string& html, const Page&, const nlohmann::json& document, const Motions&);
/// Writes `index.html`. If it cannot be made, removes an older one and returns the reason; otherwise returns "". Throws
/// Error if a file cannot be read or written.
std::string write_page(const std::filesystem::path& out, const RunTable&, const Page&, const PageTemplate&);

}  // namespace clothbench
