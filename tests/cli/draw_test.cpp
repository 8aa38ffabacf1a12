// `clothbench study contact` as a user meets it: draws, runs, resumes, reports, and runs a stored scene again.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

using testing_command::Answer, testing_command::command, testing_command::Streams;

class DrawnStudy : public WithFolder {
 protected:
  std::string out() const { return (dir_ / "out").string(); }
  static std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
};

TEST_F(DrawnStudy, RunsResumesReportsAndItsScenesRunAgain) {
  // Seeds 5 to 7 give a stretch, a sphere and a box.
  const std::string study =
      "study contact --quick --procedural --seed 5 --solver ballistic --set time.duration_s=0.1 --out " + out();
  const Answer first = command(study + " --count 2 --jobs 2");
  ASSERT_EQ(first.code, 0) << first.text;
  EXPECT_NE(first.text.find("contact-5-stretch: speed"), std::string::npos) << first.text;
  EXPECT_NE(first.text.find("0 of 2 runs passed"), std::string::npos) << "what touches nothing passes nothing";
  const Answer more = command(study + " --count 3 --resume");
  ASSERT_EQ(more.code, 0) << more.text;
  EXPECT_NE(more.text.find("0 of 3 runs passed"), std::string::npos) << more.text;
  const fs::path report = dir_ / "report";
  ASSERT_EQ(command("report " + out() + " -o " + report.string()).code, 0);
  const std::string tables = text_of(report / "report.md");
  EXPECT_NE(tables.find("stretch (procedural)"), std::string::npos) << tables;
  EXPECT_NE(tables.find("box (procedural)"), std::string::npos) << "every row says so\n" << tables;
  EXPECT_NE(tables.find("| ballistic | all (procedural) |"), std::string::npos) << tables;
  EXPECT_NE(tables.find("0/3 ("), std::string::npos) << tables;

  const RunRecord stored = read_run_summary(dir_ / "out" / "contact-6-sphere__ballistic__default.h5");
  std::ofstream(dir_ / "again.json") << stored.header.scenario_json;
  const Answer again = command("run " + (dir_ / "again.json").string() + " --solver ballistic --trials 0 --out " +
                               (dir_ / "again").string());
  ASSERT_EQ(again.code, 0) << again.text;
  const RunRecord second = read_run_summary(dir_ / "again" / "contact-6-sphere__ballistic__default.h5");
  EXPECT_EQ(second.header.scenario_sha256, stored.header.scenario_sha256);
  EXPECT_EQ(second.summary.at("stretch_max"), stored.summary.at("stretch_max"));
}

TEST_F(DrawnStudy, RefusesBadInputWithOneError) {
  const std::string away = "CLOTHBENCH_ASSETS=procedural";
  const struct {
    std::string arguments, expected, environment = {};
  } cases[] = {
      {"study contact --seed 1 --count 0", "--count"},
      {"study contact --seed many --count 1", "--seed"},
      {"study contact --seed -1 --count 1", "--seed"},
      {"study contact --seed 9007199254740992 --count 1", "--seed 9007199254740992: expected at most"},
      {"study contact --seed 1 --count 1 --solver ballistic", "assets required: CLOTHBENCH_ASSETS=procedural", away},
      {"study contact --procedural --require-assets", "--procedural"},
      {"study table3 --count 3", "--seed, --count: the scenes of this study are given in its file"},
      {"study table3 --procedural", "--procedural: this study has no random contact scenes"},
      {"study table3 --seed 1", "--seed, --count: the scenes of this study are given in its file"},
      {"study contact --seed 1 --count 1 --procedural --trials 3", "--trials"},
  };
  for (const auto& c : cases) {
    const Answer a = command(c.arguments, Streams::Both, c.environment);
    EXPECT_EQ(a.code, 2) << c.arguments << "\n" << a.text;
    EXPECT_NE(a.text.find(c.expected), std::string::npos) << c.arguments << "\n" << a.text;
  }
  // Where nothing has been fetched, the message names what fetches it.
  const Answer a = command("study contact --seed 1 --count 1 --solver ballistic", Streams::Both,
                           "CLOTHBENCH_ASSETS=" + dir_.string());
  EXPECT_EQ(a.code, 2);
  EXPECT_NE(a.text.find("scripts/fetch-assets.sh"), std::string::npos) << a.text;
}

}  // namespace
}  // namespace clothbench
