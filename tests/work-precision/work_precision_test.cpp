// The quick study from the command line to its report.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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
  const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
  const std::string device = allowed != nullptr && std::string(allowed) == "1" ? " --allow-no-device" : "";
  ASSERT_EQ(run("study work-precision --quick --out " + (dir / "run").string() + device + " > /dev/null"), 0);
  ASSERT_EQ(run("report " + (dir / "run").string() + " -o " + (dir / "report").string() + " > /dev/null"), 0);
  std::ifstream in(dir / "report/work-precision.json");
  const json diagrams = json::parse(in);
  ASSERT_EQ(diagrams.size(), 2u);
  for (const json& d : diagrams) {
    EXPECT_EQ(d["refused"], "") << d["scene"];
    EXPECT_LT(d["reference_truth_distance"].get<double>(), std::max(5e-7, d["reference_uncertainty"].get<double>()));
    double coarse = NAN, fine = NAN;
    for (const json& p : d["points"]) {
      if (p["solver"] != "reference") continue;
      EXPECT_EQ(p["status"], "ok");
      if (p["setting"] == "substeps=1") coarse = p["error"].get<double>();
      if (p["setting"] == "substeps=64") fine = p["error"].get<double>();
    }
    EXPECT_LT(fine, 1e-2 * coarse);
    EXPECT_GT(fs::file_size(dir / "report" / ("work-precision-" + d["scene"].get<std::string>() + ".png")), 5000u);
  }
  fs::remove_all(dir);
}

}  // namespace
}  // namespace clothbench
