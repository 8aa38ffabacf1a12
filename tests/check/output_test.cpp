// Output for people and machines: the console, JUnit XML, JSON.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "check/print.hpp"
#include "results.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A run of each verdict, with text that every format must escape.
Checked sample() {
  const std::string nasty = "a <b> & \"c\", 100 %: d]]>\r\nnext\tline \x01\x1b \xff\xEF\xBF\xBF µ";
  Checked c;
  c.runs.push_back({{"desk", "good", "default"}, {}});
  c.runs.push_back({{"desk", "bad & <ugly>", "\"k\"=1"},
                    {{Verdict::Failed, "outcome", "ok", "diverged F2 at frame 3", "", nasty},
                     {Verdict::Failed, "depth_max_m", "0.003", "0.02", "≤ 0.0036", ""},
                     {Verdict::Improved, "stretch_max", "0.5", "0.1", "≤ 0.555", ""}}});
  c.runs.push_back({{"desk", "better", "default"}, {{Verdict::Improved, "depth_max_m", "1", "0.5", "≤ 1.1", ""}}});
  c.runs.push_back({{"desk", "newcomer", "default"}, {{Verdict::New, "run", "–", "ok", "", "not in the baseline"}}});
  return c;
}

TEST(Junit, IsReadBackByAnXmlParser) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-junit-" + std::to_string(getpid()));
  fs::create_directories(dir);
  std::ofstream(dir / "check.xml") << junit_xml(sample());
  json expected = json::array();
  for (const CheckedRun& c : sample().runs) {
    const std::string name = c.key.solver + " " + c.key.setting;
    json item = {{"classname", c.key.scene}, {"name", name}, {"failures", json::array()}, {"notes", json::array()}};
    for (const Finding& f : c.findings) item[f.verdict == Verdict::Failed ? "failures" : "notes"].push_back(f.quantity);
    expected.push_back(item);
  }
  std::ofstream(dir / "expected.json") << expected.dump();
  const std::string script = std::string(CLOTHBENCH_SOURCE_DIR) + "/tests/check/check_junit.py";
  const std::string command = "/usr/bin/python3 '" + script + "' '" + (dir / "check.xml").string() + "' '" +
                              (dir / "expected.json").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  fs::remove_all(dir);
}

TEST(Console, ShowsWhatDiffersAndAVerdict) {
  const std::string text = check_text(sample(), "base.json");
  EXPECT_NE(text.find("check FAILED: 4 runs: 1 failed, 1 improved, 1 new, 1 as in base.json\n"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("good"), std::string::npos) << "what is as it was is not listed";
  EXPECT_LT(text.find("bad"), text.find("better"));
  EXPECT_LT(text.find("better"), text.find("newcomer"));
  EXPECT_NE(text.find("100 %"), std::string::npos) << "the solver's own message";

  Checked fine;
  fine.runs.push_back({{"desk", "good", "default"}, {}});
  EXPECT_EQ(check_text(fine, "b.json"), "check passed: 1 run: 0 failed, 0 improved, 0 new, 1 as in b.json\n");
}

TEST(Console, AnUpdateChangesAndDoesNotFail) {
  Updated u;
  u.changes = sample().runs;
  u.removed = {{"sweep", "old", "default"}};
  const std::string text = update_text(u, "base.json");
  EXPECT_EQ(text.find("FAILED"), std::string::npos) << text;
  EXPECT_NE(text.find("changed"), std::string::npos) << text;
  EXPECT_NE(text.find("removed, no result: sweep__old__default\n"), std::string::npos) << text;
}

TEST(Json, HasEveryRun) {
  const json j = check_json(sample(), "base.json");
  EXPECT_EQ(j.at("passed"), false);
  EXPECT_EQ(j.at("failed"), 1);
  ASSERT_EQ(j.at("runs").size(), 4u);
  EXPECT_EQ(j["runs"][0]["verdict"], "same");
  EXPECT_EQ(j["runs"][1]["findings"][1]["allowed"], "≤ 0.0036");
}

}  // namespace
}  // namespace clothbench
