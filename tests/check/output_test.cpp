// The baseline file, and the output as text and for machines: terminal, JUnit XML, JSON.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "refusal.hpp"
#include "results.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A run for each verdict, with text that every format must escape.
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

class Junit : public WithFolder {};

TEST_F(Junit, IsReadBackByAnXmlParser) {
  std::ofstream(dir_ / "check.xml") << junit_xml(sample());
  json expected = json::array();
  for (const CheckedRun& c : sample().runs) {
    const std::string name = c.key.solver + " " + c.key.setting;
    json item = {{"classname", c.key.scene}, {"name", name}, {"failures", json::array()}, {"notes", json::array()}};
    for (const Finding& f : c.findings) item[f.verdict == Verdict::Failed ? "failures" : "notes"].push_back(f.quantity);
    expected.push_back(item);
  }
  std::ofstream(dir_ / "expected.json") << expected.dump();
  const std::string script = std::string(CLOTHBENCH_SOURCE_DIR) + "/tests/check/check_junit.py";
  const std::string command = "/usr/bin/python3 '" + script + "' '" + (dir_ / "check.xml").string() + "' '" +
                              (dir_ / "expected.json").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(Annotations, AreALinePerFailure) {
  const std::string text = github_annotations(sample());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  EXPECT_TRUE(text.starts_with("::error::desk__bad")) << text;
  EXPECT_NE(text.find("100 %25: d]]>%0A%0Anext"), std::string::npos) << text;
  EXPECT_EQ(text.find("stretch_max"), std::string::npos) << "an improvement is not annotated";
}

TEST(Console, ShowsWhatDiffersAndAVerdict) {
  const std::string text = check_text(sample(), "base.json");
  EXPECT_NE(text.find("check FAILED: 4 runs: 1 failed, 1 improved, 1 new, 1 as in base.json\n"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("good"), std::string::npos) << "an unchanged run is not listed";
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

// Baseline files are read back as written; errors have file and JSON pointer.

class BaselineFile : public WithFolder {
 protected:
  void SetUp() override {
    file_ = dir_ / "baseline.json";
    const std::vector<RunRecord> runs = {contact_run("sweep"), ended(contact_run("desk", "paper"), "diverged", "F1", 7),
                                         contact_run("desk")};
    made_ = update_baseline({}, runs).baseline;
  }

  Baseline written(const std::string& text) {
    std::ofstream(file_) << text;
    return read_baseline(file_);
  }
  std::string fault(const std::string& text) {
    const std::string why = refusal([&] { written(text); }, ExitCode::BadInput);
    EXPECT_TRUE(why.empty() || mentions(why, file_.string())) << why;
    return why;
  }

  fs::path file_;
  Baseline made_;
};

TEST_F(BaselineFile, ReadsBackExactly) {
  made_.runs[0].scalars["depth_max_m"] = 0.1 + 0.2;
  const std::string text = baseline_text(made_);
  const Baseline read = written(text);
  EXPECT_EQ(baseline_text(read), text);
  EXPECT_EQ(read.runs[0].scalars.at("depth_max_m"), 0.1 + 0.2);
  EXPECT_EQ(read.runs[0].scalars.count("slip_m"), 0u) << "not measured";
  nlohmann::json by_hand = json::parse(text);
  by_hand["runs"][0]["scalars"]["slip_m"] = nullptr;
  EXPECT_TRUE(std::isnan(written(by_hand.dump()).runs[0].scalars.at("slip_m")));
  EXPECT_EQ(read.runs[0].status, "diverged");
  EXPECT_EQ(read.runs[0].failed_frame, 7);
}

TEST_F(BaselineFile, IsSortedWithOneValueALineAndGatedScalarsAlone) {
  const std::string text = baseline_text(made_);
  EXPECT_EQ(text.find("fps"), std::string::npos);
  EXPECT_EQ(text.find("_s\""), std::string::npos) << "a time";
  EXPECT_NE(text.find("\n    \"depth_max_m\": 0.003,\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n    \"Solve (stretch, shear)\",\n"), std::string::npos) << text;
  const json j = json::parse(text);
  std::vector<std::string> scenes;
  for (const json& c : j["runs"])
    scenes.push_back(c["scene"].get<std::string>() + " " + c["solver"].get<std::string>());
  EXPECT_EQ(scenes, (std::vector<std::string>{"desk paper", "desk xpbd", "sweep xpbd"}));
}

TEST_F(BaselineFile, SaysWhatIsWrongAndWhere) {
  const json good = json::parse(baseline_text(made_));
  EXPECT_EQ(fault(good.dump()), "");
  for (const auto& [pointer, value, words] : std::vector<std::tuple<const char*, json, const char*>>{
           {"/runs/1/scalars/fps_median", 60, "/runs/1/scalars/fps_median"},
           {"/runs/1/scalars/depth_max_m", "deep", "/runs/1/scalars/depth_max_m"},
           {"/runs/1/solvr", "x", "nearest known: solver"},
           {"/runs/2/status", "fine", "/runs/2/status"},
           {"/runs/2/failed_frame", -2, "/runs/2/failed_frame"},
           {"/runs/2/stages/0", 1, "/runs/2/stages/0"},
           {"/format", "clothbench-run", "/format"},
           {"/format_version", 2, "/format_version"},
           {"/runs", json::array(), "/runs"},
           {"/runs/1", good["runs"][0], "/runs/1: this run occurs twice"}}) {
    json bad = good;
    bad[json::json_pointer(pointer)] = value;
    EXPECT_PRED2(mentions, fault(bad.dump()), words);
  }
  json bad = good;
  bad["runs"][1].erase("scalars");
  EXPECT_NE(fault(bad.dump()).find("/runs/1: \"scalars\" is missing"), std::string::npos);
  EXPECT_NE(fault("{\n \"format\": NaN}").find("line 2"), std::string::npos);
  EXPECT_NE(fault("").find("empty"), std::string::npos);
  EXPECT_NE(fault(R"({"format":1,"format":2})").find("occurs twice"), std::string::npos);
  EXPECT_NE(fault("[]"), "");
}

}  // namespace
}  // namespace clothbench
