// One process at a time writes into a folder of results, and one that died blocks nothing.
#include "results/result_folder.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "clothbench/error.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using Use = ResultFolder::Use;

class Folder : public WithFolder {
 protected:
  static std::string refusal_of(const fs::path& folder, Use use) {
    try {
      const ResultFolder held(folder, use, "clothbench study second");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::BadInput);
      return e.what();
    }
    return "";
  }
};

TEST_F(Folder, IsMadeAndHeldByOneAtATime) {
  const fs::path out = dir_ / "a" / "b";
  {
    const ResultFolder held(out, Use::Alone, "clothbench study first");
    for (const Use use : {Use::Alone, Use::Shared}) {
      const std::string why = refusal_of(out, use);
      EXPECT_NE(why.find("process " + std::to_string(getpid()) + " on "), std::string::npos) << why;
      EXPECT_NE(why.find("clothbench study first"), std::string::npos) << why;
      EXPECT_NE(why.find(out.string()), std::string::npos) << why;
    }
    EXPECT_EQ(refusal_of(dir_ / "a", Use::Alone), "") << "another folder";
  }
  EXPECT_EQ(refusal_of(out, Use::Alone), "");
  EXPECT_TRUE(fs::is_empty(out)) << "nothing stays behind";
}

TEST_F(Folder, PartsOfOneStudyShareIt) {
  const ResultFolder one(dir_, Use::Shared, "clothbench study --job 0");
  {
    const ResultFolder two(dir_, Use::Shared, "clothbench study --job 1");
    EXPECT_NE(refusal_of(dir_, Use::Alone), "");
  }
  EXPECT_NE(refusal_of(dir_, Use::Alone), "") << "the first still writes";
  EXPECT_EQ(refusal_of(dir_, Use::Shared), "");
}

TEST_F(Folder, OneThatDiedBlocksNothing) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const ResultFolder held(dir_, Use::Alone, "clothbench study first");
    if (write(ready[1], "x", 1) == 1) pause();
    _exit(1);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_NE(refusal_of(dir_, Use::Alone).find("process " + std::to_string(child)), std::string::npos);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(dir_ / ".lock"));
  EXPECT_EQ(refusal_of(dir_, Use::Alone), "");
  EXPECT_FALSE(fs::exists(dir_ / ".lock"));
}

TEST_F(Folder, ThatCannotBeIsRefusedInPlainWords) {
  std::ofstream(dir_ / "file") << "x";
  EXPECT_NE(refusal_of(dir_ / "file", Use::Alone).find("it is a file; expected a folder"), std::string::npos);
  EXPECT_NE(refusal_of(dir_ / "file" / "below", Use::Alone).find("Not a directory"), std::string::npos);
  const std::string too_long = refusal_of(dir_ / std::string(5000, 'x'), Use::Alone);
  EXPECT_NE(too_long.find("File name too long"), std::string::npos) << too_long;
  EXPECT_LT(too_long.size(), 400u);
  EXPECT_NE(refusal_of("/proc/clothbench", Use::Alone).find("cannot be made"), std::string::npos);
  if (geteuid() == 0) return;  // may write anywhere
  fs::permissions(dir_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_NE(refusal_of(dir_, Use::Alone).find("no file can be made in it: Permission denied"), std::string::npos);
  EXPECT_NE(refusal_of(dir_ / "new", Use::Alone).find("Permission denied"), std::string::npos);
  fs::permissions(dir_, fs::perms::owner_all);
}

TEST_F(Folder, NamesOfRunsFitIntoThoseOfFiles) {
  EXPECT_NO_THROW(require_short_name(dir_, std::string(kMostRunName, 'a')));
  EXPECT_THROW(require_short_name(dir_, std::string(kMostRunName + 1, 'a')), Error);
  EXPECT_THROW(require_short_name(fs::path("/") / std::string(3000, 'a') / std::string(1000, 'a'), "run"), Error);
}

}  // namespace
}  // namespace clothbench
