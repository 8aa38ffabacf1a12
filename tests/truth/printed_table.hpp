#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace clothbench::truth {

/// A table of published numbers: comment lines with its source, "# digits N" (significant) or "# decimals N", a line of
/// column names, rows.
class PrintedTable {
 public:
  using Row = std::map<std::string, double>;

  explicit PrintedTable(const std::string& file) {
    std::ifstream in(std::string(CLOTHBENCH_SOURCE_DIR) + "/tests/truth/data/" + file);
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("# digits ", 0) == 0) digits_ = std::stoi(line.substr(9));
      if (line.rfind("# decimals ", 0) == 0) decimals_ = std::stoi(line.substr(11));
      if (line.empty() || line[0] == '#') continue;
      std::istringstream cells(line);
      Row row;
      std::size_t column = 0;
      for (std::string cell; std::getline(cells, cell, ','); ++column) {
        if (names_.size() <= column)
          names_.push_back(cell);
        else
          row[names_[column]] = std::stod(cell);
      }
      if (!row.empty()) rows_.push_back(row);
    }
    EXPECT_FALSE(rows_.empty()) << file;
    EXPECT_TRUE(digits_ > 0 || decimals_ > 0) << file;
  }

  const std::vector<Row>& rows() const { return rows_; }

  /// Half a unit of the last printed place.
  double half_unit(double printed) const {
    if (decimals_ > 0) return 0.5 * std::pow(10.0, -decimals_);
    if (printed == 0) return 1e-15;
    return 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(printed))) - digits_ + 1);
  }

  /// `uncertainty`: the printed value's own beyond rounding, from the table.
  void expect(double computed, double printed, const std::string& what, double uncertainty = 0) const {
    if (std::isinf(printed)) {
      EXPECT_EQ(computed, printed) << what;
      return;
    }
    EXPECT_NEAR(computed, printed, half_unit(printed) * (1 + 1e-6) + uncertainty) << what;
  }

 private:
  int digits_ = 0, decimals_ = 0;
  std::vector<std::string> names_;
  std::vector<Row> rows_;
};

inline std::string row_text(const PrintedTable::Row& row) {
  std::ostringstream out;
  for (const auto& [name, value] : row) out << name << '=' << value << ' ';
  return out.str();
}

constexpr double kDegree = 3.14159265358979323846 / 180;

}  // namespace clothbench::truth
