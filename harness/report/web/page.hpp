#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/overview.hpp"
#include "results/store.hpp"

namespace clothbench {

/// The page without data and the script that draws its figures, as bundle.mjs made them at build time.
struct PageTemplate {
  std::string html;          ///< empty if it could not be built
  std::string missing;       ///< then the reason, as the end of a sentence
  std::string figures = {};  ///< script for Node, from src/stills.js
};

PageTemplate page_template();

/// File that lists the pictures in a folder that a report wrote: {"format", "format_version", "pictures"}.
inline constexpr char kPicturesList[] = "report-pictures.json";

struct Drawn {
  std::string fault;     ///< a sentence on what is missing, and why; empty if all was drawn
  std::string markdown;  ///< shows the new pictures
};

/// Draws the figures of `out`/index.html as SVG (by Node) and as PNG (by rsvg-convert), under the names that the page
/// gives them. Draws into a temporary folder and, only after success, replaces the pictures of an earlier report in
/// `out`. Never overwrites other files: throws Error naming one that has the name of a picture.
Drawn draw_pictures(const std::filesystem::path& out, const PageTemplate&);

/// A section of the report: the same tables in report.md and on the page.
struct PageSection {
  std::string id, title;
  std::vector<ViewTable> tables;
};

struct Page {
  Heading heading;
  std::vector<std::string> warnings;  ///< sentences about the whole report: a software device, invalid measurements
  std::vector<Tile> tiles;
  std::string headline;  ///< conditions of all runs (headline())
  std::vector<PageSection> sections;
};

/// Data of all figures: one object per run or published value, with the summary values that figures show. Missing =
/// null.
nlohmann::json figure_rows(const RunTable&);

/// Time series of the runs with contact: `run` is an index into figure_rows. Six digits, missing = null.
nlohmann::json figure_series(const RunTable&);

/// Maximum size of packed motions and colliders in one page, as base64.
inline constexpr std::size_t kMotionBudget_B = 13'000'000;

/// Steps that the largest extent of a cloth is divided into: positions then fit a signed 16-bit integer.
inline constexpr double kPackedSteps = 32766;

/// A cloth's motion, thinned and quantised for the page of a report.
/// Frame f, axis a, vertex v: x = step_m · (origin[3f + a] + u), u in [0, 32766]. `bytes`: zlib of all low bytes, then
/// all high bytes, of the residuals r (frame, axis, vertex; modulo 2^16) between X = origin + u and its prediction X'.
/// X' = 2 X(f-1) - X(f-2); in frame 1, X' = X(0); in frame 0, X' is the previous vertex, and for vertex 0 the origin.
struct PackedMotion {
  std::vector<std::size_t> frames;         ///< those of the run that are kept
  std::vector<std::size_t> columns, rows;  ///< those of the cloth's grid that are kept
  double step_m = 0;
  std::vector<std::int64_t> origin;  ///< (frame, axis), in steps
  std::string bytes;
  /// First frame left out because the cloth is not finite or has 20 times its initial extent; -1: none.
  long cut_at = -1;
};

/// Packs a replay (frames × columns × rows): every `grid_stride`-th row and column, and the last ones. The result has
/// no frames if the first is not finite.
PackedMotion pack_motion(const Replay&, std::size_t columns, std::size_t rows, std::size_t grid_stride);

/// zlib (RFC 1950) of the bytes of `words` in little-endian order, all first bytes, then all second, and so on.
std::string pack_words(const std::vector<std::uint32_t>& words);
std::string pack_floats(const std::vector<double>& values);  ///< the same, with each value as a 32-bit float

std::string pack_text(const std::string&);  ///< zlib
std::string base64(const std::string&);

/// Motions of the runs, for the viewer. The document has `runs` (scene, solver, strides, index into `blobs`),
/// `colliders` (each once) and `left_out` (as text). `blobs`: base64 of zlib (PackedMotion).
struct Motions {
  nlohmann::json document;
  std::vector<std::string> blobs;
};

/// Reads trajectories from the runs' files and thins them until they fit the budget: first frames, then the grid.
Motions motions_of(const std::vector<RunRecord>& runs, std::size_t budget_B = kMotionBudget_B);

/// The document of the page: tables, one object per run, study folders. It has neither series nor motions.
nlohmann::json page_document(const RunTable&, const Page&);

/// One self-contained HTML page. `html` has the placeholders that bundle.mjs leaves.
std::string page_html(const std::string& html, const Page&, const nlohmann::json& document,
                      const nlohmann::json& motions, const std::vector<std::string>& blobs);

/// Writes `index.html`. If it cannot be made, removes an older one and returns the reason; otherwise returns "". Throws
/// Error if a file cannot be read or written.
std::string write_page(const std::filesystem::path& out, const RunTable&, const Page&, const PageTemplate&);

}  // namespace clothbench
