// The command as users see it: arguments, exit codes, files.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "command.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

using testing_command::Answer, testing_command::command, testing_command::Streams;

nlohmann::json json_of(const std::string& arguments) {
  const Answer a = command("--json " + arguments, Streams::Out);
  EXPECT_EQ(a.code, 0) << a.text;
  return nlohmann::json::parse(a.text, nullptr, false);
}

class Cli : public WithFolder {
 protected:
  /// A study of ballistic runs, long enough to be interrupted at any time.
  std::string small_study() const {
    const fs::path file = dir_ / "small.json";
    std::ofstream(file) << R"({"name":"small","why":"A test.","protocol":"fps",
      "scenes":[{"file":")"
                        << CLOTHBENCH_SOURCE_DIR << R"(/scenarios/paper/gravity.json",
        "axes":[{"key":"cloth.grid","values":[[8,8],[9,7]],"labels":["8","9x7"]}]}],
      "solvers":[{"solver":"ballistic"}],"trials":3,
      "rules": {"frames":24,"max_wall_s":1,"min_frames":12,"warmup_s":0.05},
      "drop_frames":12,"accuracy_duration_s":0.5})";
    return file.string();
  }
};

TEST_F(Cli, HelpNamesEveryCommand) {
  const Answer a = command("--help");
  EXPECT_EQ(a.code, 0);
  for (const char* word : {"list", "run", "study", "plan", "report", "validate", "import", "check", "conformance"})
    EXPECT_NE(a.text.find(word), std::string::npos) << word;
  EXPECT_EQ(command("help").text, a.text);
  EXPECT_EQ(command("help run").text, command("run --help").text);
}

TEST_F(Cli, BadInputExitsTwoAndSaysWhere) {
  const fs::path bad = dir_ / "bad.json";
  std::ofstream(bad) << R"({"name":"x","why":"y","cloth":{"gird":[8,8]}})";
  const Answer a = command("run " + bad.string() + " --solver ballistic --out " + (dir_ / "o").string());
  EXPECT_EQ(a.code, 2) << a.text;
  EXPECT_NE(a.text.find("bad.json"), std::string::npos) << a.text;
  EXPECT_EQ(command("run no-such-scene").code, 2);
  for (const char* arguments : {"frob", "help frob", "run", "run paper/gravity --frob", "compare a b --allow frob"}) {
    const Answer answer = command(std::string(arguments) + " --json", Streams::Out);
    EXPECT_EQ(answer.code, 2) << answer.text;
    EXPECT_EQ(nlohmann::json::parse(answer.text).at("exit_code"), 2) << answer.text;
    EXPECT_TRUE(nlohmann::json::parse(answer.text).contains("error")) << answer.text;
  }
  for (const auto& [words, near] : {std::pair{"stduy table3", "study"},
                                    {"study table3 --quik", "--quick"},
                                    {"study tabel3", "table3"},
                                    {"list solvrs", "solvers"},
                                    {"run paper/gravty", "paper/gravity"},
                                    {"run paper/gravity --solver balistic", "ballistic"},
                                    {"run paper/gravity --set cloth.gird=[4,4]", "grid"}}) {
    const Answer unknown = command(words);
    EXPECT_EQ(unknown.code, 2) << words;
    EXPECT_NE(unknown.text.find(std::string("nearest known: ") + near), std::string::npos) << unknown.text;
  }
  for (const char* arguments :
       {"run paper/gravity --sustained=soon", "run paper/gravity --sustained=0", "study table3 --sustained --trials 2",
        "study contact --sustained", "run paper/gravity --sustained --trials 2"})
    EXPECT_EQ(command(arguments).code, 2) << arguments;
  const Answer setting =
      command("run paper/gravity --solver ballistic --set solver.x=1 --out " + (dir_ / "q").string());
  EXPECT_EQ(setting.code, 2) << setting.text;
}

TEST_F(Cli, ListsAreReadableByMachines) {
  for (const char* what :
       {"solvers", "features", "scenarios", "studies", "devices", "metrics", "scalars", "assets", "terms"}) {
    const nlohmann::json rows = json_of(std::string("list ") + what);
    EXPECT_TRUE(rows.is_array()) << what;
    EXPECT_FALSE(std::string(what) != "devices" && rows.empty()) << what;
  }
}

TEST_F(Cli, PlanNamesStagesAndWhatIsLeftOut) {
  const nlohmann::json plan = json_of("plan paper/gravity --solver ballistic");
  ASSERT_TRUE(plan.is_array() && plan.size() == 1);
  EXPECT_FALSE(plan[0]["stages"].empty());
  EXPECT_TRUE(plan[0].contains("left_out"));
}

TEST_F(Cli, StudyThenReport) {
  const fs::path out = dir_ / "study";
  const Answer a = command("study " + small_study() + " --out " + out.string());
  ASSERT_EQ(a.code, 0) << a.text;
  const StudyManifest manifest = read_manifest(out);
  ASSERT_EQ(manifest.runs.size(), 2u);
  for (const std::string& run : manifest.runs) {
    const RunRecord r = read_run(out / (run + ".h5"));
    EXPECT_EQ(r.outcome.status, "ok");
    EXPECT_EQ(r.trials.size(), 3u);
    // ballistic integrates in double by its closed form.
    EXPECT_LE(r.summary.at("free_fall_error"), 1e-12);
    EXPECT_GT(r.summary.at("fps_median"), 0);
    EXPECT_TRUE(std::isnan(r.summary.at("read_B_per_frame"))) << "bytes of a CPU solver are missing";
  }
  const Answer again = command("study " + small_study() + " --out " + out.string());
  EXPECT_EQ(again.code, 2) << "finished runs are not overwritten: " << again.text;
  const Answer report = command("report " + out.string() + " -o " + (dir_ / "report").string());
  EXPECT_EQ(report.code, 0) << report.text;
  EXPECT_TRUE(fs::exists(dir_ / "report" / "report.md"));
}

TEST_F(Cli, ASustainedRunShowsItsWindows) {
  const std::string out = (dir_ / "warm").string(), report = (dir_ / "report").string();
  const Answer run = command("run paper/gravity --solver ballistic --set cloth.grid=[4,4] --sustained=1 --out " + out);
  ASSERT_EQ(run.code, 0) << run.text;
  ASSERT_EQ(command("report " + out + " -o " + report).code, 0);
  const std::string text = read_text(fs::path(report) / "report.md"),
                    table = text.substr(text.find("Frame times over"));
  EXPECT_NE(table.find("| gravity | ballistic | single | 1 | 0 |"), std::string::npos) << table.substr(0, 2000);
}

TEST_F(Cli, SolversThatWereNotBuiltAreRows) {
  const fs::path file = dir_ / "absent.json", out = dir_ / "absent";
  std::ofstream(file) << R"({"name":"absent","why":"A test.","protocol":"penetration",
    "scenes":[{"file":")"
                      << CLOTHBENCH_SOURCE_DIR << R"(/scenarios/contact/plane.json","tags":["a"]},
              {"file":")"
                      << CLOTHBENCH_SOURCE_DIR << R"(/scenarios/contact/sphere.json"}],
    "solvers":[{"solver":"ballistic","set":{"time.duration_s":0.25}},{"solver":"nvcloth","settings":{"x":1}}],"trials":1,
    "rules": {"frames":0,"max_wall_s":0,"min_frames":1,"warmup_s":0},
    "quick":{"tags":["a"],"rules":{"frames":4,"max_wall_s":0,"min_frames":4,"warmup_s":0}}})";
  const Answer a = command("study " + file.string() + " --out " + out.string());
  ASSERT_EQ(a.code, 0) << a.text;
  const RunRecord absent = read_run(out / "plane-drop__nvcloth__default.h5");
  EXPECT_EQ(absent.outcome.status, "unsupported");
  EXPECT_EQ(absent.outcome.message, "not in this build");
  EXPECT_FALSE(absent.header.environment.contains("solver_features"));
  const RunRecord here = read_run(out / "sphere-drop__ballistic__default.h5");
  EXPECT_EQ(here.outcome.status, "ok");
  EXPECT_EQ(here.accuracy.time_s.size(), 19u) << "all frames of the scene, and the start";
  EXPECT_EQ(here.trials.at(0).frames(), 18) << "frames 0: from beginning to end";
  EXPECT_TRUE(here.header.environment.at("solver_features").at("ignores").is_array());
  const std::string report = (dir_ / "report").string();
  EXPECT_EQ(command("report " + out.string() + " -o " + report).code, 0);

  EXPECT_EQ(json_of("study " + file.string() + " --quick --out " + (dir_ / "quick").string()).at("ok"), 1);
  EXPECT_EQ(read_run(dir_ / "quick" / "plane-drop__ballistic__default.h5").header.environment.at("protocol"), "quick");
  EXPECT_EQ(command("study " + small_study() + " --quick --out " + (dir_ / "q").string()).code, 2)
      << "it has no quick form";
  EXPECT_EQ(command("study " + file.string() + " --solver balistic --out " + (dir_ / "b").string()).code, 2);
}

TEST_F(Cli, RequiredAssetsMustBeThere) {
  const std::string to = " --solver ballistic --trials 0 --out " + (dir_ / "o").string();
  const Variable procedural("CLOTHBENCH_ASSETS", "procedural");
  EXPECT_EQ(json_of("list assets").at(0).at("name"), "procedural");
  for (const char* scene : {"paper/desk-flat-low", "paper/two-hand-stretch-2mps"}) {
    const Answer a = command(std::string("run ") + scene + " --require-assets" + to);
    EXPECT_EQ(a.code, 2) << a.text;
    EXPECT_NE(a.text.find("assets required"), std::string::npos) << a.text;
  }
  EXPECT_EQ(command("run paper/gravity --require-assets" + to).code, 0) << "a scene that uses none";
  EXPECT_EQ(command("study penetration --quick --require-assets --out " + (dir_ / "s").string()).code, 2);
  EXPECT_FALSE(fs::exists(dir_ / "s")) << "nothing has begun";
}

/// Starts the study and sends it a signal after a while.
int run_and_signal(const std::string& study, const fs::path& out, int signal_number, int after_ms, bool resume) {
  const pid_t child = fork();
  if (child == 0) {
    if (freopen("/dev/null", "w", stderr) == nullptr || freopen("/dev/null", "w", stdout) == nullptr) _exit(99);
    const std::string out_path = out.string();
    if (resume)
      execl(CLOTHBENCH_COMMAND, "clothbench", "study", study.c_str(), "--out", out_path.c_str(), "--resume", nullptr);
    execl(CLOTHBENCH_COMMAND, "clothbench", "study", study.c_str(), "--out", out_path.c_str(), nullptr);
    _exit(99);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
  kill(child, signal_number);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST_F(Cli, AnEditedSceneIsNotResumed) {
  const fs::path out = dir_ / "study", one = dir_ / "run";
  const std::string run = "run paper/gravity --solver ballistic --trials 0 --set time.duration_s=0.1 --out " +
                          one.string(),
                    some = "study " + small_study() + " --out " + out.string(),
                    edited = " --set gravity_m_per_s2=[0,-1,0]";
  ASSERT_EQ(command(some + " --job 0").code, 0);
  ASSERT_EQ(command(run).code, 0);
  const std::string manifest = content_of(out / "study.json"), manifest_of_run = content_of(one / "study.json");
  // Run 1 has not been executed yet; with --job 1 it would be added to runs of another scene.
  for (const std::string& words : {some + " --resume", some + " --job 0", some + " --job 1", run + " --resume"}) {
    const Answer a = command(words + edited);
    EXPECT_EQ(a.code, 2) << words << ": " << a.text;
    EXPECT_NE(a.text.find("stored for another scene"), std::string::npos) << a.text;
    EXPECT_NE(a.text.find("__ballistic__default"), std::string::npos) << a.text;
  }
  EXPECT_EQ(command(run).code, 2) << "a finished run is not continued";
  EXPECT_EQ(content_of(out / "study.json"), manifest);
  EXPECT_EQ(content_of(one / "study.json"), manifest_of_run);
  EXPECT_EQ(std::distance(fs::directory_iterator(out), fs::directory_iterator()), 3)
      << "study.json, one run's .h5 and .xdmf";
}

TEST_F(Cli, InterruptedOrKilledAnywhereResumeCompletes) {
  const std::string study = small_study();
  for (const int signal_number : {SIGINT, SIGKILL}) {
    const fs::path out = dir_ / std::to_string(signal_number);
    if (signal_number == SIGINT) {
      EXPECT_EQ(run_and_signal(study, out, SIGINT, 250, false), 130);
    } else {
      for (int after_ms = 5; after_ms < 700; after_ms += 60)
        run_and_signal(study, out, SIGKILL, after_ms, after_ms > 5);
    }
    const Answer a = command("study " + study + " --out " + out.string() + " --resume");
    EXPECT_EQ(a.code, 0) << a.text;
    for (const std::string& run : read_manifest(out).runs) EXPECT_EQ(read_run(out / (run + ".h5")).trials.size(), 3u);
  }
}

TEST_F(Cli, OwnOverheadIsUnderOnePercentOfAFrame) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "builds with sanitizers are not timed";
#endif
  const fs::path out = dir_ / "run";
  ASSERT_EQ(
      command(
          "run paper/gravity --solver ballistic --trials 2 --set cloth.grid=[128,128] --set time.duration_s=1 --out " +
          out.string())
          .code,
      0);
  for (const auto& file : fs::directory_iterator(out))
    if (file.path().extension() == ".h5") {
      const double frame_s = read_run_summary(file.path()).summary.at("frame_wall_median_s");
      EXPECT_LT(frame_s, 0.01 / 72);
    }
}

}  // namespace
}  // namespace clothbench
