// The quick study from the command line to its report.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

int run(const std::string& arguments) {
  const int status = std::system((std::string(CLOTHBENCH_COMMAND) + " " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(QuickStudy, RunsReportsAndDraws) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-work-precision-" + std::to_string(getpid()));
  ASSERT_EQ(run("study work-precision --quick --out " + (dir / "run").string() + " > /dev/null"), 0);
  ASSERT_EQ(run("report " + (dir / "run").string() + " -o " + (dir / "report").string() + " > /dev/null"), 0);
  std::ifstream in(dir / "report/runs.json");
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
    EXPECT_GT(fs::file_size(dir / "report/figures" / ("work-precision-" + scene + ".pdf")), 5000u);
  }
  std::ifstream page(dir / "report/report.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(text.find("### Error against run time"), std::string::npos);
  EXPECT_EQ(text.find("REFUSED"), std::string::npos);
  fs::remove_all(dir);
}

}  // namespace
}  // namespace clothbench
