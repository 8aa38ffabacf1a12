#include "base/words.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cmath>

#include "base/child_process.hpp"
#include "base/dice.hpp"
#include "base/files.hpp"
#include "base/interval.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

using Words = std::vector<std::string>;

TEST(Words, JoinsItemsByTheirText) {
  EXPECT_EQ(joined(Words{}), "");
  EXPECT_EQ(joined(Words{"a"}), "a");
  EXPECT_EQ(joined(Words{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(joined(Words{"", "b"}), "b");
  const std::vector<std::pair<std::string, int>> pairs = {{"a", 1}, {"b", 2}};
  EXPECT_EQ(joined(pairs, "; ", &std::pair<std::string, int>::first), "a; b");
}

TEST(Words, FindsOneAmongOthers) {
  EXPECT_TRUE(contains(Words{"a", "b"}, "b"));
  EXPECT_FALSE(contains(Words{"a", "b"}, "c"));
  EXPECT_FALSE(contains(Words{}, "a"));
}

TEST(Words, EndsASentenceOnAnUnknownOne) {
  EXPECT_EQ(nearest_known("substep", {"iterations", "substeps"}), "; nearest known: substeps");
  EXPECT_EQ(nearest_known("xyz", {"iterations", "substeps"}), "");
  EXPECT_EQ(nearest_known("x", {}), "");
}

TEST(Words, ContentOfAFileThatIsNotThereIsEmpty) { EXPECT_EQ(content_of("/no/such/file"), ""); }

TEST(Wilson, AgreesWithPublishedIntervals) {
  // R. G. Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3.
  const struct {
    std::size_t passed, drawn;
    double low, high;
  } published[] = {{81, 263, 0.2553, 0.3662}, {15, 148, 0.0624, 0.1605}, {0, 20, 0, 0.1611}, {1, 29, 0.0061, 0.1718}};
  for (const auto& p : published) {
    const Interval i = wilson_95(p.passed, p.drawn), other = wilson_95(p.drawn - p.passed, p.drawn);
    EXPECT_NEAR(i.low, p.low, 5e-5);
    EXPECT_NEAR(i.high, p.high, 5e-5);
    EXPECT_NEAR(other.low, 1 - i.high, 1e-15);
    EXPECT_NEAR(other.high, 1 - i.low, 1e-15);
  }
  EXPECT_EQ(wilson_95(0, 20).low, 0);
  EXPECT_EQ(wilson_95(20, 20).high, 1);
  EXPECT_EQ(wilson_95(0, 0).low, 0);
  EXPECT_EQ(wilson_95(0, 0).high, 1);
  EXPECT_THROW(wilson_95(3, 2), Error);
}

TEST(Dice, ThrowTheSameForASeedAndAWord) {
  Dice a(7, "word"), b(7, "word"), other_seed(8, "word"), other_word(7, "words");
  const double first = a.unit();
  EXPECT_EQ(first, b.unit());
  EXPECT_NE(first, other_seed.unit());
  EXPECT_NE(first, other_word.unit());
  for (int k = 0; k < 1000; ++k) {
    EXPECT_TRUE(a.between(-2, 3) >= -2 && b.between(-2, 3) < 3);
    EXPECT_TRUE(a.log_between(0.1, 15) >= 0.1 && b.log_between(0.1, 15) < 15);
    const int whole = a.whole(2, 4);
    EXPECT_TRUE(whole >= 2 && whole <= 4);
    const auto r = a.rotation();
    EXPECT_NEAR(r[0][0] * r[1][0] + r[0][1] * r[1][1] + r[0][2] * r[1][2], 0, 1e-12);
    EXPECT_NEAR(std::hypot(r[2][0], r[2][1], r[2][2]), 1, 1e-12);
  }
}

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
  EXPECT_EQ(child.wait().how, ChildEnd::How::TimedOut) << "waiting after the kill reports the same end";
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
  EXPECT_FALSE(child.write("more\n")) << "the write fails, but raises no signal";
}

TEST(ChildProcess, OneThatIsNotThereIsAnError) { EXPECT_THROW(ChildProcess({"no-such-program-anywhere"}), Error); }

}  // namespace
}  // namespace clothbench
