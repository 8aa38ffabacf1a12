// The quick study from the command line to its report.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

class QuickStudy : public WithFolder {};

TEST_F(QuickStudy, RunsReportsAndDraws) {
  const std::string runs = (dir_ / "run").string(), report = (dir_ / "report").string();
  ASSERT_EQ(testing_command::command("study work-precision --quick --out " + runs).code, 0);
  ASSERT_EQ(testing_command::command("report " + runs + " -o " + report).code, 0);
  std::ifstream in(report + "/runs.json");
  std::map<std::string, std::map<std::string, double>> errors;  // of the reference solver, by scene and setting
  for (const json& run : json::parse(in)) {
    if (run.at("solver") != "reference") continue;
    const json& s = run.at("summary");
    EXPECT_LT(s.at("reference_truth_distance").get<double>(),
              std::max(5e-7, s.at("reference_uncertainty").get<double>()));
    EXPECT_EQ(run.at("outcome").at("status"), "ok");
    errors[run.at("scene")][run.at("setting")] = s.at("truth_error");
  }
  ASSERT_EQ(errors.size(), 2u);
  for (const auto& [scene, error] : errors) {
    EXPECT_LT(error.at("substeps=64"), 1e-2 * error.at("substeps=1"));
    EXPECT_GT(std::filesystem::file_size(report + "/figures/work-precision-" + scene + ".pdf"), 5000u);
  }
  std::ifstream page(report + "/report.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(text.find("### Error against run time"), std::string::npos);
  EXPECT_EQ(text.find("REFUSED"), std::string::npos);
}

}  // namespace
}  // namespace clothbench
