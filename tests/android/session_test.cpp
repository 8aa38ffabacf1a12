// Life cycle of the activity with a fake system around it: arguments, order of life-cycle calls, RESULT line.
#include "android/session.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "base/files.hpp"
#include "refusal.hpp"
#include "runner/interrupt.hpp"
#include "scenario/study.hpp"
#include "with_folder.hpp"

namespace clothbench::android {
namespace {

using namespace std::chrono_literals;

bool is_result(const std::string& line) { return line.starts_with("RESULT "); }

class FakeSystem {
 public:
  void log(const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(line);
    changed_.notify_all();
  }
  void finish() {
    const std::lock_guard lock(mutex_);
    ++finishes_;
    changed_.notify_all();
  }
  bool wait_for_result() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 20s, [&] { return std::any_of(lines_.begin(), lines_.end(), is_result); });
  }
  bool wait_for_finish() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 20s, [&] { return finishes_ > 0; });
  }
  std::vector<std::string> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  std::string last() {
    const auto all = lines();
    return all.empty() ? "" : all.back();
  }
  int finishes() {
    const std::lock_guard lock(mutex_);
    return finishes_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> lines_;
  int finishes_ = 0;
};

/// Commands that were run, in order; each call runs `body`.
struct Commands {
  std::mutex mutex;
  std::vector<std::vector<std::string>> calls;
  std::function<int(const std::vector<std::string>&)> body = [](const auto&) { return 0; };

  int run(const std::vector<std::string>& words) {
    {
      const std::lock_guard lock(mutex);
      calls.push_back(words);
    }
    return body(words);
  }
  std::vector<std::vector<std::string>> all() {
    const std::lock_guard lock(mutex);
    return calls;
  }
};

/// Replaces a run: frames of 1 ms until interrupted.
int frames(int count) {
  for (int k = 0; k < count; ++k) {
    if (interrupt_requested()) return 130;
    std::this_thread::sleep_for(1ms);
  }
  return 0;
}

class SessionTest : public WithFolder {
 protected:
  void TearDown() override {
    sessions_.clear();
    clear_interrupt();
    hold_runs(false);
  }
  /// Starts an activity that lives until it is destroyed, or until the test ends.
  Session* start(const std::string& extra) {
    sessions_.push_back(std::make_unique<Session>(
        Activity{extra, [system = system_](const std::string& line) { system->log(line); },
                 [system = system_] { system->finish(); },
                 [commands = commands_](const std::vector<std::string>& words) { return commands->run(words); }}));
    return sessions_.back().get();
  }
  /// Makes a different activity of the same or a later process, with its own log.
  void renew() { system_ = std::make_shared<FakeSystem>(); }

  std::shared_ptr<FakeSystem> system_ = std::make_shared<FakeSystem>();
  std::shared_ptr<Commands> commands_ = std::make_shared<Commands>();
  std::vector<std::unique_ptr<Session>> sessions_;
};

TEST(Words, AreSplitAtBlanksOutsideQuotes) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(split_words("run  paper/gravity\t--set cloth.grid=[8,8]"),
            (Words{"run", "paper/gravity", "--set", "cloth.grid=[8,8]"}));
  EXPECT_EQ(split_words(R"(a "b c" pins=[{"edge":"u0"}] "" "x\"y")"),
            (Words{"a", "b c", R"(pins=[{"edge":"u0"}])", "", "x\"y"}));
  EXPECT_EQ(split_words("   "), Words{});
}

TEST_F(SessionTest, TheLastLineIsTheResultAndThenTheActivityEnds) {
  commands_->body = [](const std::vector<std::string>& words) -> int {
    if (words[0] == "list") throw std::runtime_error("wrong before the run");
    return words[1] == "a" ? 3 : 0;
  };
  for (const auto& [extra, words, result] : std::vector<std::tuple<std::string, std::vector<std::string>, std::string>>{
           {"", {"study", "table3"}, "RESULT PASS"},
           {"clothbench run paper/gravity --out mine", {"run", "paper/gravity", "--out", "mine"}, "RESULT PASS"},
           {"study a", {"study", "a"}, "RESULT FAIL"},
           {"list solvers", {"list", "solvers"}, "RESULT FAIL"}}) {
    renew();
    Session* const session = start(extra);
    ASSERT_TRUE(system_->wait_for_finish()) << extra;
    EXPECT_EQ(commands_->all().back(), words);
    EXPECT_EQ(system_->last(), result) << extra;
    EXPECT_EQ(system_->finishes(), 1) << extra;
    session->pause();
    EXPECT_EQ(system_->last(), result) << "nothing is logged after it";
  }
}

TEST_F(SessionTest, DestroyedItStopsAndSaysHowToGoOn) {
  commands_->body = [](const auto&) { return frames(5000); };
  Session* session = start("study table3 --out mine");
  while (commands_->all().empty()) std::this_thread::sleep_for(1ms);
  session->destroy();
  EXPECT_EQ(system_->last(), "RESULT FAIL");
  EXPECT_EQ(system_->finishes(), 0) << "a destroyed activity is not asked to end";
  const auto lines = system_->lines();
  EXPECT_NE(lines.at(lines.size() - 2).find("study table3 --out mine --resume"), std::string::npos);
}

TEST_F(SessionTest, PausedItHoldsAndResumedItGoesOn) {
  const int before = times_held();
  commands_->body = [](const auto&) { return frames(60); };
  Session* const session = start("study table3");
  while (commands_->all().empty()) std::this_thread::sleep_for(1ms);
  session->pause();
  session->pause();
  EXPECT_EQ(times_held(), before + 1) << "twice paused is once held";
  session->resume();
  ASSERT_TRUE(system_->wait_for_finish());
  EXPECT_EQ(system_->last(), "RESULT PASS");
}

TEST_F(SessionTest, ASecondSessionWaitsForTheFirst) {
  std::atomic<int> inside{0}, most{0};
  commands_->body = [&](const auto&) {
    most = std::max<int>(most, ++inside);
    const int code = frames(40);
    --inside;
    return code;
  };
  start("study a");
  const auto first = system_;
  renew();
  start("study b");
  ASSERT_TRUE(system_->wait_for_finish());
  ASSERT_TRUE(first->wait_for_finish());
  EXPECT_EQ(most, 1);
  EXPECT_EQ(commands_->all().size(), 2u);
}

TEST_F(SessionTest, AnyOrderOfCallsEndsInOneResult) {
  std::mt19937 random(3);
  for (int life = 0; life < 60; ++life) {
    renew();
    commands_->body = [](const auto&) { return frames(12); };
    Session* session = start("study table3");
    bool destroyed = false;
    for (int call = 0; call < 8; ++call) {
      const auto next = random() % 5;
      destroyed = destroyed || next == 2;
      if (next == 0)
        session->pause();
      else if (next == 1)
        session->resume();
      else if (next == 2)
        session->destroy();
      else
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 4));
    }
    if (!destroyed) session->resume();
    ASSERT_TRUE(system_->wait_for_result()) << "life " << life;
    session->destroy();
    const auto lines = system_->lines();
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(), is_result), 1) << "life " << life;
    EXPECT_PRED1(is_result, lines.back()) << "life " << life;
    EXPECT_LE(system_->finishes(), 1);
  }
}

namespace fs = std::filesystem;

std::optional<std::string> file_text(const fs::path& file) {
  return fs::exists(file) ? std::optional(content_of(file)) : std::nullopt;
}

class PackedAssets : public WithFolder {
 protected:
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
  // If interrupted before its end, there is no index, so all files are unpacked again.
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
  const Variable unpacked("CLOTHBENCH_SCENARIOS", (dir_ / "to/scenarios").c_str());
  const Study study = load_study("table3");
  EXPECT_EQ(study.scenes.size(), 15u);
  EXPECT_EQ(study.scenes.front().scene.source.rfind((dir_ / "to").string(), 0), 0u)
      << study.scenes.front().scene.source;
}

}  // namespace
}  // namespace clothbench::android
