// `clothbench check` as users see it: exit codes, files, for a study of the ballistic solver.
#include "command.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/files.hpp"
#include "results.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using testing_command::Streams;

class CheckCommand : public WithFolder {
 protected:
  void SetUp() override { write_study({contact_run("desk"), contact_run("sweep")}); }

  /// A study folder with these runs, as written by `clothbench study`.
  void write_study(const std::vector<RunRecord>& runs) {
    fs::remove_all(run());
    fs::create_directories(run());
    StudyManifest manifest{
        "penetration", "2026-01-01T00:00:00Z", "clothbench study penetration --quick", json::object(), {}};
    for (const RunRecord& c : runs) {
      manifest.runs.push_back(run_name(c.header));
      if (c.outcome.status != "missing") RunWriter(run(), c.header).finish(c.outcome, c.summary);
    }
    write_manifest(run(), manifest);
  }

  fs::path run() const { return dir_ / "run"; }
  fs::path baseline() const { return dir_ / "baseline.json"; }

  int command(const std::string& arguments, Streams streams = Streams::Both) {
    const testing_command::Answer a = testing_command::command(arguments, streams);
    text_ = a.text;
    return a.code;
  }
  int check(const std::string& more = "") {
    return command("check " + run().string() + " --baseline " + baseline().string() + " " + more);
  }

  std::string text_;
};

TEST_F(CheckCommand, UpdateThenCheckThenRegress) {
  ASSERT_EQ(check("--update"), 0) << text_;
  EXPECT_NE(text_.find("2 changed or new"), std::string::npos) << text_;
  const std::string made = content_of(baseline());
  EXPECT_EQ(check(), 0) << text_;
  EXPECT_NE(text_.find("check passed: 2 runs: 0 failed, 0 improved, 0 new, 2 as in"), std::string::npos) << text_;
  EXPECT_EQ(content_of(baseline()), made) << "a check writes nothing";
  ASSERT_EQ(check("--update"), 0);
  EXPECT_EQ(content_of(baseline()), made) << "the same results give the same file";

  write_study({contact_run("desk"), with(contact_run("sweep"), "crossings_max", 0.25)});
  EXPECT_EQ(check(), 1) << text_;
  EXPECT_NE(text_.find("crossings_max"), std::string::npos) << text_;
  ASSERT_EQ(check("--update"), 0);
  EXPECT_NE(text_.find("crossings_max"), std::string::npos) << text_;
  EXPECT_EQ(check(), 0) << text_;

  write_study({contact_run("desk"), contact_run("sweep")});
  EXPECT_EQ(check(), 0) << "an improvement passes";
  EXPECT_NE(text_.find("1 improved"), std::string::npos) << text_;
  EXPECT_NE(text_.find("--update"), std::string::npos) << text_;
  for (const auto& file : fs::directory_iterator(dir_))
    EXPECT_EQ(file.path().string().find(".tmp"), std::string::npos) << file.path();
}

TEST_F(CheckCommand, ResultFilesOneByOne) {
  ASSERT_EQ(check("--update"), 0);
  std::string files;
  for (const auto& file : fs::directory_iterator(run()))
    if (const auto kind = file.path().extension(); kind == ".h5" || kind == ".cbor")
      files += " " + file.path().string();
  EXPECT_EQ(command("check" + files + " --baseline " + baseline().string()), 0) << text_;
}

TEST_F(CheckCommand, BadInputExitsTwo) {
  EXPECT_EQ(check(), 2) << "no baseline";
  EXPECT_NE(text_.find("--update"), std::string::npos) << text_;
  ASSERT_EQ(check("--update"), 0);
  EXPECT_EQ(command("check " + (dir_ / "nothing").string() + " --baseline " + baseline().string()), 2) << text_;
  EXPECT_EQ(command("check " + run().string()), 2) << "no --baseline";
  EXPECT_EQ(check("--update --junit x.xml"), 2);
  EXPECT_EQ(command("check " + run().string() + " " + run().string() + " --baseline " + baseline().string()), 2);
  EXPECT_NE(text_.find("twice"), std::string::npos) << text_;
  json bad = json::parse(content_of(baseline()));
  bad["runs"][1]["scalars"]["depth_max"] = 1;
  std::ofstream(baseline()) << bad.dump();
  EXPECT_EQ(check(), 2);
  EXPECT_NE(text_.find("baseline.json: /runs/1/scalars/depth_max"), std::string::npos) << text_;
  EXPECT_EQ(check("--update"), 2) << "an unreadable baseline is not overwritten";
  EXPECT_EQ(json::parse(content_of(baseline())), bad);
}

/// Positions are checked whatever the summary states: the baseline's run has an equal summary.
TEST_F(CheckCommand, PositionsAreLookedAt) {
  const auto write = [&](const std::vector<float>& position) {
    RunRecord c = contact_run("sweep");
    c.header.vertices = 1;
    RunRecord planned = c;
    planned.outcome.status = "missing";
    write_study({planned});
    RunWriter writer(run(), c.header);
    if (!position.empty()) writer.write_accuracy({{0, 0.5}, position, {}});
    writer.finish(c.outcome, c.summary);
  };
  const std::vector<float> whole = {0, 0, 0, 0, -1, 0};
  write(whole);
  ASSERT_EQ(check("--update"), 0) << text_;
  EXPECT_EQ(check(), 0) << text_;
  for (const std::size_t k : {0, 5}) {
    std::vector<float> damaged = whole;
    damaged[k] = std::numeric_limits<float>::quiet_NaN();
    write(damaged);
    EXPECT_EQ(check(), 1) << text_;
    EXPECT_NE(text_.find("is not finite"), std::string::npos) << text_;
    EXPECT_NE(text_.find("sweep__xpbd__default"), std::string::npos) << text_;
    EXPECT_EQ(check("--update"), 2) << "no baseline is made from it";
    EXPECT_EQ(command("compare " + run().string() + " " + run().string()), 2) << text_;
    EXPECT_NE(text_.find("is not finite"), std::string::npos) << text_;
  }
  write({});
  EXPECT_EQ(check(), 2) << text_;
  EXPECT_NE(text_.find("length: frames: 1 and 0"), std::string::npos) << text_;
  EXPECT_EQ(check("--allow length"), 1) << text_;
  EXPECT_NE(text_.find("has no positions"), std::string::npos) << text_;
}

TEST_F(CheckCommand, JunitAndJson) {
  ASSERT_EQ(check("--update"), 0);
  write_study({contact_run("desk"), ended(contact_run("sweep"), "diverged", "F1", 3)});
  const fs::path junit = dir_ / "check.xml";
  EXPECT_EQ(check("--junit " + junit.string()), 1);
  EXPECT_NE(content_of(junit).find("failures=\"1\""), std::string::npos);
  EXPECT_EQ(command("check --json " + run().string() + " --baseline " + baseline().string(), Streams::Out), 1);
  const json j = json::parse(text_);
  EXPECT_EQ(j.at("passed"), false);
  EXPECT_EQ(j.at("runs").size(), 2u);
  std::ofstream(baseline()) << "{";
  EXPECT_EQ(check("--junit " + junit.string()), 2);
  EXPECT_FALSE(fs::exists(junit)) << "an older verdict";
}

TEST_F(CheckCommand, LogHasALinePerCheckThatAReportReads) {
  ASSERT_EQ(check("--update"), 0);
  const fs::path log = dir_ / "log.jsonl";
  EXPECT_EQ(check("--log " + log.string()), 0) << text_;
  write_study({contact_run("desk"), with(contact_run("sweep"), "crossings_max", 0.25)});
  EXPECT_EQ(check("--log " + log.string()), 1) << "a landing that fails is logged too";
  write_study({planned(contact_run("desk")), contact_run("sweep")});
  EXPECT_EQ(check("--log " + log.string()), 1) << "a run that was not made has no environment";
  std::istringstream lines(content_of(log));
  std::vector<double> found;
  for (std::string line; std::getline(lines, line);)
    found.push_back(json::parse(line).at("runs").at(1).at("values").at("crossings_max"));
  EXPECT_EQ(found, (std::vector<double>{0, 0.25, 0}));
  const std::string report =
      "report " + run().string() + " -o " + (dir_ / "report").string() + " --history " + log.string();
  EXPECT_EQ(command(report), 0) << text_;
  std::ofstream(log, std::ios::app) << "{}\n";
  EXPECT_EQ(command(report), 2);
  EXPECT_NE(text_.find("log.jsonl:4: no `commit`"), std::string::npos) << text_;
}

TEST_F(CheckCommand, HoldsARealStudyOfASolverThatTheStudyDoesNotName) {
  const fs::path study = dir_ / "study.json", out = dir_ / "real";
  std::ofstream(study) << R"({"name":"small","why":"A test.","protocol":"fps",
    "scenes":[{"file":")"
                       << CLOTHBENCH_SOURCE_DIR << R"(/scenarios/paper/gravity.json",
      "axes":[{"key":"cloth.grid","values":[[8,8]],"labels":["8"]}]}],
    "solvers":[{"solver":"no-such-solver"}],"trials":1,
    "rules": {"frames":12,"max_wall_s":1,"min_frames":12,"warmup_s":0.01},"accuracy_duration_s":0.1})";
  ASSERT_EQ(command("study " + study.string() + " --solver ballistic --out " + out.string()), 0) << text_;
  const std::string arguments = "check " + out.string() + " --baseline " + baseline().string();
  ASSERT_EQ(command(arguments + " --update"), 0) << text_;
  EXPECT_EQ(command(arguments), 0) << text_;
  json changed = json::parse(content_of(baseline()));
  ASSERT_EQ(changed["runs"].size(), 1u);
  EXPECT_EQ(changed["runs"][0]["solver"], "ballistic");
  ASSERT_TRUE(changed["runs"][0]["scalars"].contains("free_fall_error"));
  changed["runs"][0]["scalars"]["free_fall_error"] = -1;
  std::ofstream(baseline()) << changed.dump();
  EXPECT_EQ(command(arguments), 1) << text_;
  changed["runs"][0]["scalars"].erase("free_fall_error");
  changed["runs"][0]["conditions"]["scene SHA-256"] = "0";
  std::ofstream(baseline()) << changed.dump();
  EXPECT_EQ(command(arguments), 2);
  EXPECT_NE(text_.find("scene: scene SHA-256: 0 and "), std::string::npos) << text_;
  EXPECT_EQ(command(arguments + " --allow device"), 2) << "another kind";
  EXPECT_EQ(command(arguments + " --allow scene"), 0) << text_;
  EXPECT_NE(text_.find("Compared despite a difference"), std::string::npos) << text_;
  ASSERT_EQ(command(arguments + " --update"), 0) << text_;
  EXPECT_NE(text_.find("baseline differ: scene: scene SHA-256: 0 and "), std::string::npos) << text_;
  EXPECT_EQ(command(arguments), 0) << text_;
}

}  // namespace
}  // namespace clothbench
