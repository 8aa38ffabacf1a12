// How many clothbench jobs share the machine.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "runner/environment.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Jobs : public WithFolder {
 protected:
  void process(int pid, const std::string& name, int parent, char state = 'S') {
    fs::create_directories(dir_ / std::to_string(pid));
    std::ofstream(dir_ / std::to_string(pid) / "stat")
        << pid << " (" << name << ") " << state << " " << parent << " 1 1 0";
  }
};

TEST_F(Jobs, AreProcessesOfTheProgramBesideThisOne) {
  process(1, "init", 0);
  process(10, "sh", 1);
  process(11, "clothbench", 10);
  fs::create_directories(dir_ / "self");
  fs::create_directories(dir_ / "99");  // ended meanwhile
  EXPECT_EQ(jobs_in(dir_, 11), 1);
  for (int k = 0; k < 10; ++k) process(20 + k, "clothbench", 10);
  EXPECT_EQ(jobs_in(dir_, 11), 11) << "ten more started by the same shell";
  process(20, "clothbench", 10, 'Z');
  process(21, "clothbench", 10, 'T');
  EXPECT_EQ(jobs_in(dir_, 11), 9) << "a dead and a stopped one take no time";
  process(40, "a) S 1 (clothbench", 1);
  process(41, "clothbench-report", 1);
  EXPECT_EQ(jobs_in(dir_, 11), 9) << "other names";
}

TEST_F(Jobs, WhatStartedWhatIsOneJob) {
  process(1, "init", 0);
  process(5, "clothbench", 1);
  process(6, "clothbench", 5);
  process(7, "clothbench", 5);
  EXPECT_EQ(jobs_in(dir_, 5), 1) << "its own workers";
  EXPECT_EQ(jobs_in(dir_, 6), 2)
      << "a worker shares the machine with another, not with the process that waits for both";
  EXPECT_EQ(jobs_in(dir_ / "nothing", 6), 1);
}

/// Waits until the process has become the program, or a second has passed.
bool runs(pid_t child, const std::string& name) {
  for (int k = 0; k < 100; ++k) {
    std::string now;
    std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm"), now);
    if (now == name) return true;
    usleep(10000);
  }
  return false;
}

TEST_F(Jobs, ARealOneIsSeenAndToldNumbersCount) {
  const char* before = std::getenv("CLOTHBENCH_JOBS");
  const std::string kept = before == nullptr ? "" : before;
  unsetenv("CLOTHBENCH_JOBS");
  // A child would be one job with its parent: it is left to init.
  const fs::path program = dir_ / "clothbench";
  fs::copy_file("/bin/sleep", program);
  int tell[2];
  ASSERT_EQ(pipe2(tell, O_CLOEXEC), 0);
  const int alone = jobs_now();
  const pid_t between = fork();
  if (between == 0) {
    const pid_t child = fork();
    if (child == 0) {
      execl(program.c_str(), "clothbench", "20", nullptr);
      _exit(1);
    }
    (void)!write(tell[1], &child, sizeof child);
    _exit(0);
  }
  pid_t child = 0;
  ASSERT_EQ(read(tell[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  waitpid(between, nullptr, 0);
  ASSERT_TRUE(runs(child, "clothbench"));
  EXPECT_GE(jobs_now(), 2);
  EXPECT_GE(alone, 1);
  kill(child, SIGKILL);
  setenv("CLOTHBENCH_JOBS", "7", 1);
  EXPECT_EQ(jobs_now(), 7);
  if (kept.empty())
    unsetenv("CLOTHBENCH_JOBS");
  else
    setenv("CLOTHBENCH_JOBS", kept.c_str(), 1);
}

}  // namespace
}  // namespace clothbench
