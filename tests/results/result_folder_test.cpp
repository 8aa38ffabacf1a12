// Only one process at a time writes into a results folder, and a dead process blocks nothing; a full disk.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "refusal.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using Runs = std::vector<std::size_t>;
const Runs kAlone;

class Folder : public WithFolder {
 protected:
  static std::string refusal_of(const fs::path& folder, const Runs& runs) {
    return refusal([&] { const ResultFolder held(folder, runs, "clothbench study second"); }, ExitCode::BadInput);
  }
};

TEST_F(Folder, IsMadeAndHeldByOneAtATime) {
  const fs::path out = dir_ / "a" / "b";
  {
    const ResultFolder held(out, kAlone, "clothbench study first");
    for (const Runs& runs : {kAlone, Runs{0}}) {
      const std::string why = refusal_of(out, runs);
      EXPECT_NE(why.find("process " + std::to_string(getpid()) + " on "), std::string::npos) << why;
      EXPECT_NE(why.find("clothbench study first"), std::string::npos) << why;
      EXPECT_NE(why.find(out.string()), std::string::npos) << why;
    }
    EXPECT_EQ(refusal_of(dir_ / "a", kAlone), "") << "another folder";
  }
  EXPECT_EQ(refusal_of(out, kAlone), "");
  EXPECT_TRUE(fs::is_empty(out)) << "nothing stays behind";
}

TEST_F(Folder, PartsOfOneStudyShareIt) {
  const ResultFolder one(dir_, {0}, "clothbench study --job 0");
  {
    const ResultFolder two(dir_, {1, 3}, "clothbench study --job 1,3");
    EXPECT_NE(refusal_of(dir_, kAlone), "");
    EXPECT_NE(refusal_of(dir_, {2, 3}), "") << "one run in two processes";
    EXPECT_EQ(refusal_of(dir_, {2}), "");
  }
  EXPECT_NE(refusal_of(dir_, kAlone), "") << "the first still writes";
  EXPECT_EQ(refusal_of(dir_, {1, 3}), "");
}

TEST_F(Folder, OneThatDiedBlocksNothing) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const ResultFolder held(dir_, kAlone, "clothbench study first");
    if (write(ready[1], "x", 1) == 1) pause();
    _exit(1);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_NE(refusal_of(dir_, kAlone).find("process " + std::to_string(child)), std::string::npos);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(dir_ / ".lock"));
  EXPECT_EQ(refusal_of(dir_, kAlone), "");
  EXPECT_FALSE(fs::exists(dir_ / ".lock"));
}

TEST_F(Folder, ThatCannotBeIsRefusedInPlainWords) {
  std::ofstream(dir_ / "file") << "x";
  EXPECT_NE(refusal_of(dir_ / "file", kAlone).find("it is a file; expected a folder"), std::string::npos);
  EXPECT_NE(refusal_of(dir_ / "file" / "below", kAlone).find("Not a directory"), std::string::npos);
  const std::string too_long = refusal_of(dir_ / std::string(5000, 'x'), kAlone);
  EXPECT_NE(too_long.find("File name too long"), std::string::npos) << too_long;
  EXPECT_LT(too_long.size(), 400u);
  EXPECT_NE(refusal_of("/proc/clothbench", kAlone).find("cannot be made"), std::string::npos);
  if (geteuid() == 0) return;  // may write anywhere
  fs::permissions(dir_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_NE(refusal_of(dir_, kAlone).find("no file can be made in it: Permission denied"), std::string::npos);
  EXPECT_NE(refusal_of(dir_ / "new", kAlone).find("Permission denied"), std::string::npos);
  fs::permissions(dir_, fs::perms::owner_all);
}

TEST_F(Folder, NamesOfRunsFitIntoThoseOfFiles) {
  EXPECT_NO_THROW(require_short_name(dir_, std::string(kMostRunName, 'a')));
  EXPECT_THROW(require_short_name(dir_, std::string(kMostRunName + 1, 'a')), Error);
  EXPECT_THROW(require_short_name(fs::path("/") / std::string(3000, 'a') / std::string(1000, 'a'), "run"), Error);
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
