// Folders for results: an unusable one is refused with exit code 2 before a solver runs.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/files.hpp"
#include "cli/command_line.hpp"
#include "command.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

using testing_command::Answer, testing_command::command, testing_command::Streams;

class Out : public WithFolder {
 protected:
  static Answer run(const std::string& out, const std::string& more = "") {
    return command("run paper/gravity --solver ballistic --trials 1 --set cloth.grid=[8,8] --out '" + out + "' " +
                   more);
  }
};

TEST_F(Out, ThatCannotBeAFolderExitsTwo) {
  std::ofstream(dir_ / "file") << "mine";
  for (const std::string command_line :
       {"run paper/gravity --solver ballistic", "study table3 --quick --solver ballistic",
        "study stability --quick --solver ballistic"}) {
    const Answer a = command(command_line + " --out '" + (dir_ / "file").string() + "'");
    EXPECT_EQ(a.code, 2) << a.text;
    EXPECT_NE(a.text.find("it is a file"), std::string::npos) << a.text;
  }
  std::string text;
  std::getline(std::ifstream(dir_ / "file"), text);
  EXPECT_EQ(text, "mine");
}

TEST_F(Out, OfOtherCommandsThatCannotBeMadeExitsTwo) {
  std::ofstream(dir_ / "file") << "mine";
  const std::string file = (dir_ / "file").string(), results = (dir_ / "out").string();
  ASSERT_EQ(run(results, "--set time.duration_s=0.1").code, 0);
  for (const std::string& arguments :
       {"report " + results + " -o " + file, "render " + results + " --frames 0 --no-movie -o " + file,
        "compare " + results + " " + results + " --markdown " + dir_.string(),
        "check " + results + " --update --baseline " + file + "/b.json",
        "check " + results + " --baseline " + std::string(300, 'x')}) {
    const Answer a = command(arguments);
    EXPECT_EQ(a.code, 2) << arguments << ": " << a.text;
    EXPECT_EQ(a.text.find("internal error"), std::string::npos) << a.text;
  }
  for (const fs::path& folder : {dir_, dir_.parent_path()})
    for (const auto& entry : fs::directory_iterator(folder))
      EXPECT_FALSE(entry.path().string().starts_with(dir_.string() + ".tmp.")) << "left behind";
}

TEST_F(Out, OfTwoCommandsAtOnceTheSecondIsRefused) {
  const std::string out = (dir_ / "out").string();
  Answer first;
  std::thread slow([&] { first = run(out, "--set time.duration_s=20 --set cloth.grid=[32,32]"); });
  for (int k = 0; k < 2000 && !fs::exists(fs::path(out) / ".lock"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const Answer second = run(out);
  slow.join();
  EXPECT_EQ(first.code, 0) << first.text;
  EXPECT_EQ(second.code, 2) << second.text;
  EXPECT_NE(second.text.find("writes its results there"), std::string::npos) << second.text;
  EXPECT_NE(second.text.find("clothbench run paper/gravity"), std::string::npos) << second.text;
  EXPECT_EQ(run((dir_ / "third").string()).code, 0);
}

TEST_F(Out, NamesTooLongForFilesExitTwo) {
  const std::string study = (dir_ / "study.json").string();
  std::ofstream(study) << R"({"name":"long","why":"A label too long.","protocol":"fps","trials":1,"scenes":[{"file":")"
                       << CLOTHBENCH_SOURCE_DIR
                       << R"(/scenarios/paper/gravity.json"}],"solvers":[{"solver":"ballistic",)"
                       << R"("label":")" << std::string(250, 'a') << R"("}],)"
                       << R"("rules":{"frames":1,"max_wall_s":0,"min_frames":1,"warmup_s":0}})";
  for (const std::string& arguments : {"validate " + study, "study " + study + " --out " + (dir_ / "out").string()}) {
    const Answer b = command(arguments);
    EXPECT_EQ(b.code, 2) << b.text;
    EXPECT_NE(b.text.find("its result files would have names of"), std::string::npos) << b.text;
  }
}

// `clothbench study contact` as users see it: generates, runs, resumes, reports, and repeats a stored scene.

class DrawnStudy : public WithFolder {
 protected:
  std::string out() const { return (dir_ / "out").string(); }
};

TEST_F(DrawnStudy, RunsResumesReportsAndItsScenesRunAgain) {
  // Seeds 5 to 7 give a stretch, a sphere and a box.
  const std::string study =
      "study contact --quick --procedural --seed 5 --solver ballistic --set time.duration_s=0.1 --out " + out();
  const Answer first = command(study + " --count 2 --jobs 2");
  ASSERT_EQ(first.code, 0) << first.text;
  EXPECT_NE(first.text.find("contact-5-stretch: speed"), std::string::npos) << first.text;
  EXPECT_NE(first.text.find("0 of 2 runs passed"), std::string::npos) << "without contact no scene is passed";
  const Answer more = command(study + " --count 3 --resume");
  ASSERT_EQ(more.code, 0) << more.text;
  EXPECT_NE(more.text.find("0 of 3 runs passed"), std::string::npos) << more.text;
  const fs::path report = dir_ / "report";
  ASSERT_EQ(command("report " + out() + " -o " + report.string()).code, 0);
  const std::string tables = content_of(report / "report.md");
  EXPECT_NE(tables.find("stretch (procedural)"), std::string::npos) << tables;
  EXPECT_NE(tables.find("box (procedural)"), std::string::npos) << "every row says \"procedural\"\n" << tables;
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
      {"study contact --procedural --solver ballistic --count 1000000000", "100000"},
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
  // If no assets are fetched, the message names the script that fetches them.
  const Answer a = command("study contact --seed 1 --count 1 --solver ballistic", Streams::Both,
                           "CLOTHBENCH_ASSETS=" + dir_.string());
  EXPECT_EQ(a.code, 2);
  EXPECT_NE(a.text.find("scripts/fetch-assets.sh"), std::string::npos) << a.text;
}

// Several commands one after another in one process, as in an app's session: none may inherit another's arguments.

using Words = std::vector<std::string>;

Answer in_this_process(const Words& words) {
  setenv("CLOTHBENCH_IN_PROCESS", "1", 1);  // this program cannot be a worker
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  testing::internal::GetCapturedStderr();
  return {code, testing::internal::GetCapturedStdout()};
}

Answer in_a_new_process(const Words& words) {
  std::string quoted;
  for (const std::string& word : words) quoted += " '" + word + "'";
  return command(quoted, Streams::Out);
}

TEST(Commands, TheSecondIsAsIfItWereTheFirst) {
  for (const auto& [first, second] : std::vector<std::pair<Words, Words>>{
           {{"list", "features"}, {"--json", "list"}},
           {{"validate", "no-such-scene"}, {"--json", "validate", "paper/gravity"}},
           {{"plan", "paper/gravity", "--solver", "ballistic", "--set", "cloth.grid=[5,5]", "--json"},
            {"--json", "plan", "paper/gravity", "--solver", "ballistic"}},
           {{"conformance", "ballistic", "--set", "cloth.grid=[3,3]"},
            {"--json", "conformance", "ballistic", "--scene", "conformance/sheet", "--no-whole"}},
           {{"study", "table3", "--quick", "--only", "nothing", "--job", "0"},
            {"--json", "study", "table3", "--list-jobs"}}}) {
    in_this_process(first);
    const Answer here = in_this_process(second), only = in_a_new_process(second);
    EXPECT_EQ(only.code, 0) << only.text;
    EXPECT_EQ(here.code, only.code) << second.at(1);
    EXPECT_EQ(here.text, only.text);
  }
}

}  // namespace
}  // namespace clothbench
