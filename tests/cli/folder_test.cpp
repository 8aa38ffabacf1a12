// Where the command may write its results: refused with exit code 2 before a solver runs.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "command.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

using testing_command::Answer, testing_command::command;

class Out : public WithFolder {
 protected:
  static Answer run(const std::string& out, const std::string& more = "") {
    return command("run paper/gravity --solver ballistic --trials 1 --set cloth.grid=[8,8] --out '" + out + "' " +
                   more);
  }
};

TEST_F(Out, ThatCannotBeAFolderExitsTwo) {
  std::ofstream(dir_ / "file") << "mine";
  for (const auto& [out, word] : {std::pair<std::string, std::string>{(dir_ / "file").string(), "it is a file"},
                                  {(dir_ / "file" / "below").string(), "Not a directory"},
                                  {(dir_ / std::string(300, 'x')).string(), "File name too long"},
                                  {"/proc/clothbench", "cannot be made"}})
    for (const std::string command_line :
         {"run paper/gravity --solver ballistic", "study table3 --quick --solver ballistic",
          "study stability --quick --solver ballistic"}) {
      const Answer a = command(command_line + " --out '" + out + "'");
      EXPECT_EQ(a.code, 2) << a.text;
      EXPECT_NE(a.text.find(word), std::string::npos) << a.text;
      EXPECT_LT(a.text.size(), 600u) << a.text;
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
  const Answer a = run((dir_ / "out").string(), "--set name=" + std::string(120, 'a'));
  EXPECT_EQ(a.code, 2) << a.text;
  EXPECT_NE(a.text.find("/name: 120 characters"), std::string::npos) << a.text;
  const std::string study = (dir_ / "study.json").string();
  std::ofstream(study) << R"({"name":"long","why":"A label too long.","protocol":"fps","trials":1,"scenes":[{"file":")"
                       << CLOTHBENCH_SOURCE_DIR
                       << R"(/scenarios/paper/gravity.json"}],"solvers":[{"solver":"ballistic",)"
                       << R"("label":")" << std::string(250, 'a') << R"("}],)"
                       << R"("rules":{"frames":1,"max_wall_s":0,"min_frames":1,"warmup_s":0}})";
  for (const std::string& arguments : {"validate " + study, "study " + study + " --out " + (dir_ / "out").string()}) {
    const Answer b = command(arguments);
    EXPECT_EQ(b.code, 2) << b.text;
    EXPECT_NE(b.text.find("the names of its result files would have"), std::string::npos) << b.text;
  }
}

TEST_F(Out, MoreRunsThanAStudyMayHaveExitTwo) {
  const Answer a = command("study contact --procedural --solver ballistic --count 1000000000 --out " + dir_.string());
  EXPECT_EQ(a.code, 2) << a.text;
  EXPECT_NE(a.text.find("1000000000"), std::string::npos) << a.text;
  EXPECT_NE(a.text.find("100000"), std::string::npos) << a.text;
}

}  // namespace
}  // namespace clothbench
