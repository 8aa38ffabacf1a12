#include "android/session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <condition_variable>
#include <iomanip>
#include <mutex>
#include <sstream>
#include <thread>

#include "clothbench/error.hpp"
#include "runner/environment.hpp"
#include "runner/interrupt.hpp"

namespace clothbench::android {
namespace {

namespace fs = std::filesystem;

/// Locked by the session that runs: the log and the interrupt are the process's.
std::mutex& running_session() {
  static auto* const mutex = new std::mutex;  // outlives every thread
  return *mutex;
}

std::string option_value(const std::vector<std::string>& words, const std::string& option) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == option && k + 1 < words.size()) return words[k + 1];
    if (words[k].rfind(option + "=", 0) == 0) return words[k].substr(option.size() + 1);
  }
  return "";
}

bool writes_results(const std::string& command) { return command == "study" || command == "run" || command == "xr"; }

/// "runs/<study or command>-<UTC>".
fs::path fresh_folder(const fs::path& files, const std::vector<std::string>& words) {
  std::string name = words[0] == "study" && words.size() > 1 ? fs::path(words[1]).stem().string() : words[0];
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '-';
  std::string stamp = utc_now();
  std::erase_if(stamp, [](char c) { return c == '-' || c == ':'; });
  return files / "runs" / (name + "-" + stamp);
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
  bool running = false;  ///< it is this session's turn
  bool paused = false, destroyed = false, ended = false;

  /// Runs the command; true if it passed. `where` receives the folder of its results.
  bool run(fs::path& where) {
    std::vector<std::string> words = split_words(activity.arguments);
    if (words.empty()) words = {"study", "table3"};
    if (words[0] == "clothbench") words.erase(words.begin());
    if (writes_results(words.at(0))) {
      const std::string given = option_value(words, "--out");
      where = given.empty() ? fresh_folder(activity.files, words) : fs::path(given);
      if (given.empty()) words.insert(words.end(), {"--out", where.string()});
    }
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
    fs::path where = activity.files;
    try {
      pass = starts && run(where);
    } catch (const std::exception& e) {
      activity.log(std::string("error: ") + e.what());
    }
    const std::lock_guard lock(mutex);
    activity.log(fmt::format("RESULT {} {}", pass ? "PASS" : "FAIL", where.string()));
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
  if (!shared_->ended) shared_->activity.log("paused: the run holds between frames");
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
  // A session that waits for its turn stops when that comes.
  shared_->changed.wait_for(lock, kTimeout, [&] { return shared_->ended || !shared_->running; });
}

}  // namespace clothbench::android
