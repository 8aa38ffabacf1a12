// A process that writes trials is killed at 200 random times: its finished trials must be there and complete, and the
// run can be completed to a file equal to that of an undisturbed run.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

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

/// Writes the missing ones of kTrials trials, reporting each finished one through the pipe, and finishes the run.
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

class Kill : public WithFolder {};

TEST_F(Kill, TwoHundredTimesNothingFinishedIsLost) {
  const std::string run = run_name(sample_run().header);
  work(dir_ / "whole", -1);
  std::mt19937 random(7);
  int interrupted = 0, completed = 0;
  fs::path dir = dir_ / "0";
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
      EXPECT_EQ(content_of(dir / (run + ".h5")), content_of(dir_ / "whole" / (run + ".h5"))) << "kill " << kill_number;
      ++completed;
      fs::remove_all(dir);
      dir = dir_ / std::to_string(kill_number + 1);
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
  EXPECT_EQ(content_of(dir / (run + ".h5")), content_of(dir_ / "whole" / (run + ".h5")));
  std::printf("killed %d times in mid-run, %d runs completed in between\n", interrupted, completed);
  EXPECT_GT(interrupted, 50) << "the kills must meet runs in progress";
}

// Full disk: a limit on file sizes makes the same writes fail with an error, for any user.

/// 1.5 MB of positions that do not compress.
RunRecord large_run() {
  RunRecord r = sample_run();
  std::uint32_t noise = 1;
  for (TimedTrial& t : r.trials) t.stage_device_s.assign(t.stage_device_s.size(), 1e-4);
  r.header.vertices = 25000;
  r.accuracy.position.resize(r.accuracy.time_s.size() * 3 * r.header.vertices);
  for (float& x : r.accuracy.position) x = static_cast<float>((noise = noise * 1664525u + 1013904223u) >> 8);
  return r;
}

/// Runs `work` in a process that may write files of at most 256 kB. Returns its exit status: 0 if an Error was thrown
/// that names `file`, 10 if nothing was thrown.
int with_little_room(const std::string& file, const auto& work) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{256 * 1024, 256 * 1024};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(11);
    try {
      work();
    } catch (const Error& e) {
      _exit(std::string(e.what()).find(file) != std::string::npos ? 0 : 12);
    }
    _exit(10);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::size_t temporary_files(const fs::path& dir) {
  std::size_t n = 0;
  for (const auto& entry : fs::recursive_directory_iterator(dir))
    n += entry.path().filename().string().find(".tmp.") != std::string::npos;
  return n;
}

class FullDisk : public WithFolder {};

TEST_F(FullDisk, AWriteThatFailsIsAnErrorAndWhatWasFinishedStays) {
  const RunRecord r = large_run();
  RunWriter writer(dir_, r.header);
  for (const TimedTrial& t : r.trials) writer.write_trial(t);
  EXPECT_EQ(with_little_room(".part", [&] { writer.write_accuracy(r.accuracy); }), 0);
  EXPECT_EQ(temporary_files(dir_), 0u);
  EXPECT_EQ(writer.recovered().trials.size(), 3u);
  EXPECT_TRUE(writer.recovered().accuracy.time_s.empty());

  const fs::path h5 = dir_ / "x.h5";
  EXPECT_EQ(with_little_room("x.h5", [&] { write_hdf5(h5, r); }), 0);
  EXPECT_FALSE(fs::exists(h5)) << "half a file must not look like one";
  EXPECT_EQ(temporary_files(dir_), 0u);
  // With room again, everything is still there and can be finished.
  writer.write_accuracy(r.accuracy);
  EXPECT_EQ(read_run(writer.finish(r.outcome, r.summary)).accuracy.position, r.accuracy.position);
}

}  // namespace
}  // namespace clothbench
