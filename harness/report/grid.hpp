#pragma once
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// A summary value of a cell; NaN where it has none.
double summary_value(const CellRecord&, const std::string& name);

/// The scenario that a cell ran; discarded where what is stored is no JSON.
nlohmann::json scenario_of(const CellRecord&);

/// Column of a table: cloth resolution. `grid` is {0, 0} for a cloth that is no grid.
struct Resolution {
  int grid[2] = {0, 0};
  std::uint32_t vertices = 0;  ///< of a cloth that is no grid; 0 otherwise
  std::string label() const;   ///< "32²", "9×7", "1234 vertices", "–"
  auto operator<=>(const Resolution&) const = default;
};

/// Row of a table.
struct Series {
  std::string solver, setting, sides;
  int repeat = 1;  ///< 2, 3, ... where several files hold the same cell
  std::string label() const;
  bool operator==(const Series&) const = default;
  // Not <=>: strings have none yet in the libc++ of Android's NDK r25.
  bool operator<(const Series& o) const {
    return std::tie(solver, setting, sides, repeat) < std::tie(o.solver, o.setting, o.sides, o.repeat);
  }
};

/// A cell and where it stands. Points into the vector it was made from.
struct PlacedCell {
  const CellRecord* cell = nullptr;
  Resolution resolution;
  Series series;
};

/// Cells whose scenes differ in resolution and sides alone; what one set of tables shows.
class Family {
 public:
  std::string name;               ///< of the scene; " (2)" is added where another family has the same name
  int paper_table = 0;            ///< the paper's table the scene says it belongs to; 0: none
  std::vector<PlacedCell> cells;  ///< in the order given

  std::vector<Resolution> resolutions() const;  ///< ascending
  std::vector<Series> series() const;           ///< by solver and setting; single, double-duplicated, double
  const CellRecord* find(const Series&, const Resolution&) const;

  /// Rows: series; columns: resolutions. A cell that did not end well says how instead of `text`.
  Table table(const std::string& title, const std::string& note,
              const std::function<std::string(const CellRecord&)>& text) const;
};

/// Sorts cells into families by their scenes, in the order of first appearance. A cell without a readable scene is a
/// family of its own scene name, without resolution. `cells` must outlive the answer.
std::vector<Family> families(const std::vector<CellRecord>& cells);

}  // namespace clothbench
