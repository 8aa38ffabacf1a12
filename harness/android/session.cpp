#include "android/session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <condition_variable>
#include <iomanip>
#include <mutex>
#include <sstream>
#include <thread>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "runner/interrupt.hpp"

namespace clothbench::android {
namespace {

/// Held by the running session: a process has one log and one interrupt flag, so sessions follow each other.
std::mutex& running_session() {
  static auto* const mutex = new std::mutex;  // outlives every thread
  return *mutex;
}

}  // namespace

std::vector<std::string> split_words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> std::quoted(word);) words.push_back(word);
  return words;
}

struct Session::Shared {
  Activity activity;
  std::mutex mutex;
  std::condition_variable changed;
  bool running = false;  ///< this session holds running_session()
  bool paused = false, destroyed = false, ended = false;

  /// Runs the command; true if its exit code is 0.
  bool run() {
    std::vector<std::string> words = split_words(activity.arguments);
    if (words.empty()) words = {"study", "table3"};
    if (words[0] == "clothbench") words.erase(words.begin());
    const std::string text = fmt::format("{}", fmt::join(words, " "));
    activity.log("running " + text);
    const int code = activity.command(words);
    if (code == static_cast<int>(ExitCode::Interrupted))
      activity.log(fmt::format("interrupted; {} --resume continues it", text));
    else if (code != 0)
      activity.log(fmt::format("{}: exit code {}", text, code));
    return code == 0;
  }

  void work() {
    const std::lock_guard alone(running_session());
    bool starts = false;
    {
      const std::lock_guard lock(mutex);
      starts = !destroyed;
      clear_interrupt();
      if (destroyed) request_interrupt();
      hold_runs(paused && !destroyed);
      running = true;
    }
    bool pass = false;
    try {
      pass = starts && run();
    } catch (const std::exception& e) {
      activity.log(std::string("error: ") + e.what());
    }
    const std::lock_guard lock(mutex);
    activity.log(pass ? "RESULT PASS" : "RESULT FAIL");
    hold_runs(false);
    running = false;
    ended = true;
    if (!destroyed) activity.finish();
    changed.notify_all();
  }
};

Session::Session(Activity activity) : shared_(std::make_shared<Shared>()) {
  shared_->activity = std::move(activity);
  std::thread([shared = shared_] { shared->work(); }).detach();
}

Session::~Session() { destroy(); }

void Session::pause() {
  const std::lock_guard lock(shared_->mutex);
  shared_->paused = true;
  if (shared_->running && !shared_->destroyed) hold_runs(true);
  if (!shared_->ended) shared_->activity.log("paused: the run waits between frames");
}

void Session::resume() {
  const std::lock_guard lock(shared_->mutex);
  shared_->paused = false;
  if (shared_->running) hold_runs(false);
}

void Session::destroy() {
  constexpr std::chrono::seconds kTimeout{3};  // Android declares an activity hung after 5 s
  std::unique_lock lock(shared_->mutex);
  shared_->destroyed = true;
  if (shared_->running) request_interrupt();
  // A session that waits for its turn stops when its turn comes.
  shared_->changed.wait_for(lock, kTimeout, [&] { return shared_->ended || !shared_->running; });
}

void unpack_assets(const AssetReader& read, const std::filesystem::path& to) {
  constexpr const char* kIndex = "index.txt";
  const auto index = read(kIndex);
  if (!index || index->empty()) throw Error("assets: index.txt: expected this file in the package");
  if (content_of(to / kIndex) == *index) return;
  std::filesystem::remove_all(to);
  std::istringstream lines(*index);
  for (std::string hash, path; lines >> hash >> std::ws && std::getline(lines, path);) {
    const auto content = read(path);
    if (!content) throw Error("assets: " + path + ": missing");
    if (sha256(*content) != hash) throw Error("assets: " + path + ": differs from the file that was packed");
    std::filesystem::create_directories((to / path).parent_path());
    write_file_atomically(to / path, *content);
  }
  // Written last, so that an interrupted unpacking is repeated.
  write_file_atomically(to / kIndex, *index);
}

}  // namespace clothbench::android
