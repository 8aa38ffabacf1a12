#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>

#include "clothbench/error.hpp"

namespace clothbench {

/// Test name of a table row from its words; without one GoogleTest prints the row's addresses.
inline std::string test_name(const std::string& words) {
  std::string out;
  for (char c : words) out += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return out;
}

/// The message of the Error that `call` throws; empty if it throws none.
template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// A folder only for this process and test, gone afterwards: tests of two builds may run at once.
class ScratchFolder {
 public:
  ScratchFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("clothbench-" + std::to_string(::getpid()) + "-" +
               test_name(::testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ec;
    std::filesystem::remove_all(path_, ec);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string file(const std::string& name, const std::string& text) const {
    const std::filesystem::path at = path_ / name;
    std::ofstream(at, std::ios::binary) << text;
    return at.string();
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace clothbench
