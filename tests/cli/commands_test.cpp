// Several commands one after another in one process, as an app's session runs them: none inherits another's arguments.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "cli/command_line.hpp"
#include "command.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

using testing_command::Answer;

Answer in_this_process(const Words& words) {
  setenv("CLOTHBENCH_IN_PROCESS", "1", 1);  // this program is no worker
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  testing::internal::GetCapturedStderr();
  return {code, testing::internal::GetCapturedStdout()};
}

Answer in_a_new_process(const Words& words) {
  std::string quoted;
  for (const std::string& word : words) quoted += " '" + word + "'";
  return testing_command::command(quoted, testing_command::Streams::Out);
}

struct Pair {
  Words first, second;
};

void PrintTo(const Pair& p, std::ostream* out) { *out << p.second.at(1); }

class Commands : public ::testing::TestWithParam<Pair> {};

TEST_P(Commands, TheSecondIsAsIfItWereTheFirst) {
  in_this_process(GetParam().first);
  const Answer here = in_this_process(GetParam().second), alone = in_a_new_process(GetParam().second);
  EXPECT_EQ(alone.code, 0) << alone.text;
  EXPECT_EQ(here.code, alone.code);
  EXPECT_EQ(here.text, alone.text);
}

const std::vector<Pair> kPairs = {
    {{"list", "features"}, {"--json", "list"}},
    {{"validate", "no-such-scene"}, {"--json", "validate", "paper/gravity"}},
    {{"plan", "paper/gravity", "--solver", "ballistic", "--set", "cloth.grid=[5,5]", "--json"},
     {"--json", "plan", "paper/gravity", "--solver", "ballistic"}},
    {{"conformance", "ballistic", "--set", "cloth.grid=[3,3]"},
     {"--json", "conformance", "ballistic", "--scene", "conformance/sheet", "--no-whole"}},
    {{"study", "table3", "--quick", "--only", "nothing", "--job", "0"}, {"--json", "study", "table3", "--list-jobs"}},
};

INSTANTIATE_TEST_SUITE_P(Every, Commands, ::testing::ValuesIn(kPairs),
                         [](const auto& one) { return one.param.second.at(1); });

}  // namespace
}  // namespace clothbench
