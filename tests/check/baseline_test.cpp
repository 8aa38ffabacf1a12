// The baseline file: what is written is read back, what is wrong is said with file and JSON pointer.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "results.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class BaselineFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    file_ =
        fs::temp_directory_path() / ("clothbench-baseline-" + std::to_string(getpid()) + "-" + info->name() + ".json");
    const std::vector<RunRecord> runs = {contact_run("sweep"), ended(contact_run("desk", "paper"), "diverged", "F1", 7),
                                         contact_run("desk")};
    made_ = update_baseline({}, runs).baseline;
  }
  void TearDown() override { fs::remove(file_); }

  Baseline written(const std::string& text) {
    std::ofstream(file_) << text;
    return read_baseline(file_);
  }
  std::string fault(const std::string& text) {
    try {
      written(text);
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(file_.string()), std::string::npos) << e.what();
      EXPECT_EQ(e.code(), ExitCode::BadInput);
      return e.what();
    }
    return "no error";
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
  const auto with_change = [&](const char* pointer, const json& value) {
    json bad = good;
    bad[json::json_pointer(pointer)] = value;
    return fault(bad.dump());
  };
  EXPECT_EQ(fault(good.dump()), "no error");
  EXPECT_NE(with_change("/runs/1/scalars/fps_median", 60).find("/runs/1/scalars/fps_median"), std::string::npos);
  EXPECT_NE(with_change("/runs/1/scalars/depth_max_m", "deep").find("/runs/1/scalars/depth_max_m"), std::string::npos);
  EXPECT_NE(with_change("/runs/1/solvr", "x").find("nearest known: solver"), std::string::npos);
  EXPECT_NE(with_change("/runs/2/status", "fine").find("/runs/2/status"), std::string::npos);
  EXPECT_NE(with_change("/runs/2/failed_frame", -2).find("/runs/2/failed_frame"), std::string::npos);
  EXPECT_NE(with_change("/runs/2/stages/0", 1).find("/runs/2/stages/0"), std::string::npos);
  EXPECT_NE(with_change("/format", "clothbench-run").find("/format"), std::string::npos);
  EXPECT_NE(with_change("/format_version", 2).find("/format_version"), std::string::npos);
  EXPECT_NE(with_change("/runs", json::array()).find("/runs"), std::string::npos) << "nothing to hold results to";
  EXPECT_NE(with_change("/runs/1", good["runs"][0]).find("/runs/1: this run occurs twice"), std::string::npos);
  json bad = good;
  bad["runs"][1].erase("scalars");
  EXPECT_NE(fault(bad.dump()).find("/runs/1: \"scalars\" is missing"), std::string::npos);
  EXPECT_NE(fault("{\n \"format\": NaN}").find("line 2"), std::string::npos);
  EXPECT_NE(fault("").find("empty"), std::string::npos);
  EXPECT_NE(fault(R"({"format":1,"format":2})").find("occurs twice"), std::string::npos);
  EXPECT_NE(fault("[]"), "no error");
}

}  // namespace
}  // namespace clothbench
