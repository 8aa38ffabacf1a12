#include "android/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <iomanip>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "runner/environment.hpp"
#include "runner/interrupt.hpp"

namespace clothbench::android {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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

bool writes_results(const std::vector<std::string>& words) {
  return !words.empty() && (words[0] == "study" || words[0] == "run" || words[0] == "xr");
}

/// "runs/<study or command>-<UTC>", the first of its kind that is not there yet.
fs::path fresh_folder(const fs::path& files, const std::vector<std::string>& words) {
  std::string name = words[0] == "study" && words.size() > 1 ? fs::path(words[1]).stem().string() : words[0];
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '-';
  std::string stamp = utc_now();
  stamp.erase(std::remove_if(stamp.begin(), stamp.end(), [](char c) { return c == '-' || c == ':'; }), stamp.end());
  const fs::path first = files / "runs" / (name + "-" + stamp);
  fs::path folder = first;
  for (int k = 2; fs::exists(folder); ++k) folder = first.string() + fmt::format("-{}", k);
  return folder;
}

}  // namespace

std::vector<std::string> split_words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> std::quoted(word);) words.push_back(word);
  return words;
}

struct Session::Shared {
  Launch launch;
  std::shared_ptr<System> system;
  Command command;
  std::mutex mutex;
  std::condition_variable changed;
  bool running = false;  ///< it is this session's turn
  bool paused = false, destroyed = false, ended = false;

  /// The intent's extra, else the first line of args.txt that is neither empty nor a comment, else the default.
  std::string line() const {
    std::istringstream given(launch.extra + "\n" + content_of(launch.files / "args.txt"));
    for (std::string l; std::getline(given, l);) {
      const auto first = l.find_first_not_of(" \t\r");
      if (first != std::string::npos && l[first] != '#')
        return l.substr(first, l.find_last_not_of(" \t\r") - first + 1);
    }
    return "study table3";
  }

  /// Runs the command; true if it passed. `where` receives the folder of its results.
  bool run(fs::path& where) {
    const std::string text = line();
    std::vector<std::string> words = split_words(text);
    if (words[0] == "clothbench") words.erase(words.begin());
    const fs::path note = launch.files / "session.json";
    std::string happens = "running " + text;
    if (writes_results(words)) {
      const json before = json::parse(content_of(note), nullptr, false);
      // A live session cannot be continued: the user was elsewhere.
      const bool again = words[0] != "xr" && before.is_object() && before.value("line", json()) == text &&
                         before.value("out", json()).is_string();
      const std::string given = option_value(words, "--out");
      const fs::path out = again           ? fs::path(before["out"].get<std::string>())
                           : given.empty() ? fresh_folder(launch.files, words)
                                           : fs::path(given);
      if (given.empty()) words.insert(words.end(), {"--out", out.string()});
      if (again) words.push_back("--resume");
      happens = fmt::format("{} {}: results in {}", again ? "continuing" : "running", text, out.string());
      write_file_atomically(note, json{{"line", text}, {"out", out.string()}}.dump(1) + "\n");
      where = out;
    }
    system->log(happens);
    const int code = command(words);
    if (code == static_cast<int>(ExitCode::Interrupted)) {
      system->log("interrupted; a start with the same arguments continues it");
      return false;
    }
    fs::remove(note);
    if (code != 0) system->log(fmt::format("{}: exit code {}", text, code));
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
    fs::path where = launch.files;
    try {
      pass = starts && run(where);
    } catch (const std::exception& e) {
      system->log(std::string("error: ") + e.what());
    }
    system->flush();
    system->log(fmt::format("RESULT {} {}", pass ? "PASS" : "FAIL", where.string()));
    const std::lock_guard lock(mutex);
    hold_runs(false);
    running = false;
    ended = true;
    if (!destroyed) system->finish();
    changed.notify_all();
  }
};

Session::Session(Launch launch, std::shared_ptr<System> system, Command command) : shared_(std::make_shared<Shared>()) {
  shared_->launch = std::move(launch);
  shared_->system = std::move(system);
  shared_->command = std::move(command);
  std::thread([shared = shared_] { shared->work(); }).detach();
}

Session::~Session() { destroy(); }

void Session::pause() {
  const std::lock_guard lock(shared_->mutex);
  shared_->paused = true;
  if (shared_->running && !shared_->destroyed) hold_runs(true);
  if (!shared_->ended) shared_->system->log("paused: the run holds between frames");
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
