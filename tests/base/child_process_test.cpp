#include "base/child_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

using namespace std::chrono_literals;

ChildEnd end_of(const std::string& script) { return ChildProcess({"sh", "-c", script}).wait(); }

TEST(ChildProcess, TellsHowItEnded) {
  EXPECT_EQ(end_of("exit 3").text(), "exit status 3");
  const ChildEnd killed = end_of("kill -SEGV $$");
  EXPECT_EQ(killed.how, ChildEnd::How::Signalled);
  EXPECT_EQ(killed.code, SIGSEGV);
}

TEST(ChildProcess, IsKilled) {
  ChildProcess child({"sleep", "60"});
  const ChildEnd end = child.kill();
  EXPECT_EQ(end.how, ChildEnd::How::TimedOut);
  EXPECT_LT(end.wall_s, 30);
  EXPECT_EQ(child.wait().how, ChildEnd::How::TimedOut) << "an end is an end";
}

TEST(ChildProcess, AnswersOnItsSocketUntilItEnds) {
  ChildProcess child({"sh", "-c", "read line; test \"$line\" = ask && printf y >&0"}, {.socket = true});
  EXPECT_TRUE(child.write("ask\n"));
  char byte = 0;
  ChildProcess::Heard heard = ChildProcess::Heard::Nothing;
  while (heard == ChildProcess::Heard::Nothing) heard = child.read(byte, 50ms);
  EXPECT_EQ(heard, ChildProcess::Heard::Byte);
  EXPECT_EQ(byte, 'y');
  EXPECT_EQ(child.wait().code, 0);
  EXPECT_EQ(child.read(byte, 50ms), ChildProcess::Heard::End);
  EXPECT_FALSE(child.write("more\n")) << "an error and no signal";
}

TEST(ChildProcess, OneThatIsNotThereIsAnError) { EXPECT_THROW(ChildProcess({"no-such-program-anywhere"}), Error); }

}  // namespace
}  // namespace clothbench
