// CSV and JSON: every value, exactly.
#include <gtest/gtest.h>

#include <cmath>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

std::string field(const std::vector<std::vector<std::string>>& csv, std::size_t row, const std::string& name) {
  for (std::size_t k = 0; k < csv.at(0).size(); ++k)
    if (csv[0][k] == name) return csv.at(row).at(k);
  ADD_FAILURE() << "no column " << name;
  return "";
}

TEST(Export, RunsCsvReadsBackExactly) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 1.0 / 3),
                                 fake_run("bullet-soft", 8, "double", 1e-300, false)};
  runs.push_back(with_outcome(fake_run("paper", 8, "single", 1), "diverged", 17, "said \"no\", twice\nand stopped"));
  const auto csv = parse_csv(runs_csv(RunTable(runs)));
  ASSERT_EQ(csv.size(), 4u);
  for (const auto& row : csv) EXPECT_EQ(row.size(), csv[0].size());
  for (std::size_t k = 0; k < 2; ++k)
    for (const auto& [name, v] : runs[k].summary) {
      const std::string text = field(csv, k + 1, name);
      if (std::isfinite(v))
        EXPECT_EQ(std::stod(text), v) << name;
      else
        EXPECT_EQ(text, "") << name;
    }
  EXPECT_EQ(field(csv, 1, "grid_x"), "8");
  EXPECT_EQ(field(csv, 1, "gpu"), "Fake GPU");
  EXPECT_EQ(field(csv, 1, "gpu_is_software"), "false");
  EXPECT_EQ(field(csv, 1, "failed_frame"), "");
  EXPECT_EQ(field(csv, 3, "failed_frame"), "17");
  EXPECT_EQ(field(csv, 3, "message"), "said \"no\", twice\nand stopped");
  EXPECT_EQ(field(csv, 3, "fps_median"), "");
}

TEST(Export, InfinityIsSaid) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 1)};
  runs[0].summary["up"] = INFINITY;
  runs[0].summary["down"] = -INFINITY;
  runs[0].summary["missing"] = kMissing;
  const auto csv = parse_csv(runs_csv(RunTable(runs)));
  EXPECT_EQ(field(csv, 1, "up"), "inf");
  EXPECT_EQ(field(csv, 1, "down"), "-inf");
  EXPECT_EQ(field(csv, 1, "missing"), "");
  const nlohmann::json run = nlohmann::json::parse(runs_json(runs).dump()).at(0), summary = run.at("summary");
  EXPECT_EQ(run.at("environment").at("cpu"), "Fake CPU");
  EXPECT_EQ(summary.at("fps_median"), 1);
  EXPECT_EQ(summary.at("up"), "inf");
  EXPECT_EQ(summary.at("down"), "-inf");
  EXPECT_TRUE(summary.at("missing").is_null());
}

}  // namespace
}  // namespace clothbench
