// A process that writes trials is killed at 200 random moments: what it had finished is there and whole, and the run
// can be completed to the same file as an undisturbed one.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>

#include "base/files.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

TimedTrial trial(int k) {
  TimedTrial t = sample_run(1, 24).trials[0];
  t.index = k;
  for (double& w : t.frame_wall_s) w += 1e-6 * k;
  return t;
}

constexpr int kTrials = 12;

/// Writes what is missing of kTrials trials, telling each finished one through the pipe, and finishes the run.
void work(const fs::path& dir, int pipe_out) {
  const RunRecord r = sample_run();
  RunWriter writer(dir, r.header);
  const RunRecord before = writer.recovered();
  for (int k = 0; k < kTrials; ++k) {
    bool there = false;
    for (const TimedTrial& t : before.trials) there |= t.index == k;
    if (there) continue;
    writer.write_trial(trial(k));
    const auto byte = static_cast<unsigned char>(k);
    if (pipe_out >= 0 && write(pipe_out, &byte, 1) != 1) _exit(3);
  }
  if (before.accuracy.metrics.empty()) writer.write_accuracy(r.accuracy);
  writer.finish(r.outcome, r.summary);
}

TEST(Kill, TwoHundredTimesNothingFinishedIsLost) {
  const fs::path root = fs::temp_directory_path() / ("clothbench-kill-" + std::to_string(getpid()));
  const std::string run = run_name(sample_run().header);
  fs::create_directories(root / "whole");
  work(root / "whole", -1);
  std::mt19937 random(7);
  int interrupted = 0, completed = 0;
  fs::path dir = root / "0";
  fs::create_directories(dir);
  for (int kill_number = 0; kill_number < 200; ++kill_number) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      close(ends[0]);
      work(dir, ends[1]);
      _exit(0);
    }
    close(ends[1]);
    usleep(random() % 12000);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    std::vector<int> reported;
    for (unsigned char k = 0; read(ends[0], &k, 1) == 1;) reported.push_back(k);
    close(ends[0]);
    if (run_finished(dir, run)) {
      EXPECT_EQ(content_of(dir / (run + ".h5")), content_of(root / "whole" / (run + ".h5"))) << "kill " << kill_number;
      ++completed;
      fs::remove_all(dir);
      dir = root / std::to_string(kill_number + 1);
      fs::create_directories(dir);
      continue;
    }
    ++interrupted;
    if (!fs::exists(dir / (run + ".part"))) {
      EXPECT_TRUE(reported.empty());
      continue;
    }
    const RunRecord kept = read_run(dir / (run + ".part"));
    for (int k : reported) {
      bool found = false;
      for (const TimedTrial& t : kept.trials) found |= same(t, trial(k));
      EXPECT_TRUE(found) << "kill " << kill_number << ": trial " << k << " was finished and is not there";
    }
    for (const TimedTrial& t : kept.trials) EXPECT_TRUE(same(t, trial(t.index)));
  }
  work(dir, -1);
  EXPECT_EQ(content_of(dir / (run + ".h5")), content_of(root / "whole" / (run + ".h5")));
  std::printf("killed %d times in mid-run, %d runs completed in between\n", interrupted, completed);
  EXPECT_GT(interrupted, 50) << "the kills must meet runs in progress";
  fs::remove_all(root);
}

}  // namespace
}  // namespace clothbench
