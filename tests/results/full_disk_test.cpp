// No more room: a limit on the size of files fails the same writes with an error as a full disk does, for any user.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "clothbench/error.hpp"
#include "results/hdf5_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// Positions that do not compress, 1.5 MB of them.
RunRecord large_run() {
  RunRecord r = sample_run();
  std::uint32_t noise = 1;
  for (TimedTrial& t : r.trials) t.stage_device_s.assign(t.stage_device_s.size(), 1e-4);
  r.header.vertices = 25000;
  r.accuracy.position.resize(r.accuracy.time_s.size() * 3 * r.header.vertices);
  for (float& x : r.accuracy.position) x = static_cast<float>((noise = noise * 1664525u + 1013904223u) >> 8);
  return r;
}

/// Runs `work` in a process that may write files of 256 kB at most. Returns its exit status: 0 if an Error was thrown
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

TEST(FullDisk, AWriteThatFailsIsAnErrorAndWhatWasFinishedStays) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-full-" + std::to_string(getpid()));
  fs::create_directories(dir);
  const RunRecord r = large_run();
  RunWriter writer(dir, r.header);
  for (const TimedTrial& t : r.trials) writer.write_trial(t);
  EXPECT_EQ(with_little_room(".part", [&] { writer.write_accuracy(r.accuracy); }), 0);
  EXPECT_EQ(temporary_files(dir), 0u);
  EXPECT_EQ(writer.recovered().trials.size(), 3u);
  EXPECT_TRUE(writer.recovered().accuracy.time_s.empty());

  const fs::path h5 = dir / "x.h5";
  EXPECT_EQ(with_little_room("x.h5", [&] { write_hdf5(h5, r); }), 0);
  EXPECT_FALSE(fs::exists(h5)) << "half a file must not look like one";
  EXPECT_EQ(temporary_files(dir), 0u);
  // With room again everything is still there to be finished.
  writer.write_accuracy(r.accuracy);
  EXPECT_EQ(read_run(writer.finish(r.outcome, r.summary)).accuracy.position, r.accuracy.position);
  fs::remove_all(dir);
}

}  // namespace
}  // namespace clothbench
