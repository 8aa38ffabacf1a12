#include "android/packed_assets.hpp"

#include <cstdlib>
#include <fstream>
#include <map>

#include "base/files.hpp"
#include "base/sha256.hpp"
#include "refusal.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"
#include "with_folder.hpp"

namespace clothbench::android {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> file_text(const fs::path& file) {
  return fs::exists(file) ? std::optional(content_of(file)) : std::nullopt;
}

class PackedAssets : public WithFolder {
 protected:
  void TearDown() override {
    unsetenv("CLOTHBENCH_SCENARIOS");
    WithFolder::TearDown();
  }
  AssetReader reader() {
    return [this](const std::string& path) -> std::optional<std::string> {
      ++reads_;
      const auto it = packed_.find(path);
      if (it == packed_.end()) return std::nullopt;
      return it->second;
    };
  }
  void add(const std::string& path, const std::string& content) {
    packed_[path] = content;
    packed_["index.txt"] += sha256(content) + " " + path + "\n";
  }
  std::string complaint() {
    return refusal([&] { unpack_assets(reader(), dir_ / "to"); });
  }

  std::map<std::string, std::string> packed_;
  int reads_ = 0;
};

TEST_F(PackedAssets, UnpackOnceAndAgainWhenTheyChange) {
  add("scenarios/a.json", "{}");
  add("assets/room with blanks.bin", std::string("\0\1\2", 3));
  EXPECT_EQ(complaint(), "");
  EXPECT_EQ(file_text(dir_ / "to/assets/room with blanks.bin"), std::string("\0\1\2", 3));
  reads_ = 0;
  EXPECT_EQ(complaint(), "");
  EXPECT_EQ(reads_, 1) << "only the index";
  packed_.clear();
  add("scenarios/b.json", "[]");
  EXPECT_EQ(complaint(), "");
  EXPECT_FALSE(fs::exists(dir_ / "to/scenarios/a.json")) << "what is no longer packed is gone";
  // Interrupted before its end: no index, so all of it is done again.
  fs::remove(dir_ / "to/index.txt");
  fs::remove(dir_ / "to/scenarios/b.json");
  EXPECT_EQ(complaint(), "");
  EXPECT_TRUE(fs::exists(dir_ / "to/scenarios/b.json"));
}

TEST_F(PackedAssets, FaultsNameTheFile) {
  EXPECT_NE(complaint().find("index.txt"), std::string::npos);
  add("scenarios/a.json", "{}");
  packed_["scenarios/a.json"] = "[]";
  EXPECT_NE(complaint().find("scenarios/a.json: differs"), std::string::npos) << "same size, other bytes";
  packed_.erase("scenarios/a.json");
  EXPECT_NE(complaint().find("scenarios/a.json: missing"), std::string::npos) << complaint();
}

TEST_F(PackedAssets, WhatTheScriptPacksIsWhatTheProgramNeeds) {
  const fs::path rooms = dir_ / "rooms";
  fs::create_directories(rooms / "@iwer/sem/captures");
  std::ofstream(rooms / "@iwer/sem/captures/room.json") << "room";
  std::ofstream(rooms / "@iwer/sem/unused.js") << "code";
  const std::string command = std::string(PYTHON) + " " + CLOTHBENCH_SOURCE_DIR + "/harness/android/pack_assets.py " +
                              (dir_ / "packed").string() + " --assets " + rooms.string() + " >/dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const auto first = file_text(dir_ / "packed/index.txt");
  ASSERT_EQ(std::system(command.c_str()), 0) << "again into the same folder";
  EXPECT_EQ(file_text(dir_ / "packed/index.txt"), first);
  unpack_assets([&](const std::string& path) { return file_text(dir_ / "packed" / path); }, dir_ / "to");
  EXPECT_EQ(file_text(dir_ / "to/assets/@iwer/sem/captures/room.json"), "room");
  EXPECT_FALSE(fs::exists(dir_ / "to/assets/@iwer/sem/unused.js"));
  setenv("CLOTHBENCH_SCENARIOS", (dir_ / "to/scenarios").c_str(), 1);
  const Study study = load_study("table3");
  EXPECT_EQ(study.scenes.size(), 15u);
  EXPECT_EQ(study.scenes.front().scene.source.rfind((dir_ / "to").string(), 0), 0u)
      << study.scenes.front().scene.source;
}

}  // namespace
}  // namespace clothbench::android
