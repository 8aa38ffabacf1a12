#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "refusal.hpp"

namespace clothbench {

/// A scene of a cloth that is a mesh.
inline nlohmann::json mesh_scenario(nlohmann::json mesh) {
  return {{"name", "mesh"},
          {"why", "a mesh for the tests"},
          {"cloth", {{"mesh", std::move(mesh)}, {"areal_density_kg_per_m2", 0.3}, {"sides", "single"}}},
          {"material", {{"membrane_stiffness_N_per_m", 1000}}},
          {"time", {{"frame_rate_hz", 60}, {"duration_s", 0.5}}}};
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
