#include "android/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
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

/// One session runs at a time, in the order they were made: the log and the interrupt are the process's.
class Turns {
 public:
  unsigned take() {
    const std::lock_guard lock(mutex_);
    return taken_++;
  }
  void wait_for(unsigned turn) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return turn == current_; });
  }
  void end() {
    const std::lock_guard lock(mutex_);
    ++current_;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  unsigned taken_ = 0, current_ = 0;
};

Turns& turns() {
  static Turns* const all = new Turns;  // outlives every thread
  return *all;
}

bool has_option(const std::vector<std::string>& words, const std::string& option) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& w) { return w == option || w.rfind(option + "=", 0) == 0; });
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

/// What stands in session.json: each command with the folder it writes to and how far it is (pending, pass, fail).
class Ledger {
 public:
  /// Goes on with the file's list if it is of the same commands and not at its end.
  Ledger(fs::path file, const std::vector<std::string>& lines) : file_(std::move(file)) {
    const json before = json::parse(content_of(file_), nullptr, false);
    const auto state_is = [](const json& c, const char* state) { return c.value("state", "") == state; };
    if (before.is_object() && before.contains("commands") && before["commands"].is_array() &&
        before["commands"].size() == lines.size()) {
      bool same = true, open = false;
      for (std::size_t k = 0; k < lines.size(); ++k) {
        const json& c = before["commands"][k];
        same = same && c.is_object() && c.value("line", "") == lines[k];
        open = open || !(c.is_object() && (state_is(c, "pass") || state_is(c, "fail")));
      }
      if (same && open) {
        commands_ = before["commands"];
        return;
      }
    }
    for (const std::string& line : lines) commands_.push_back({{"line", line}, {"state", "pending"}, {"out", ""}});
  }

  json& operator[](std::size_t k) { return commands_[k]; }
  void save() const { write_file_atomically(file_, json{{"commands", commands_}}.dump(1) + "\n"); }

 private:
  fs::path file_;
  json commands_ = json::array();
};

}  // namespace

std::vector<std::string> split_words(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = 0;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quote != '\'' && c == '\\' && k + 1 < line.size()) {
      word += line[++k];
      in_word = true;
    } else if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        word += c;
    } else if (c == '"' || c == '\'') {
      quote = c;
      in_word = true;
    } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      if (in_word) words.push_back(std::move(word));
      word.clear();
      in_word = false;
    } else {
      word += c;
      in_word = true;
    }
  }
  if (quote != 0) throw Error(fmt::format("arguments: {}: a quote {} is not closed", line, quote));
  if (in_word) words.push_back(std::move(word));
  return words;
}

std::vector<std::string> command_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    lines.push_back(line.substr(first, line.find_last_not_of(" \t\r") - first + 1));
  }
  return lines;
}

struct Session::Shared {
  Launch launch;
  std::shared_ptr<System> system;
  Command command;
  std::mutex mutex;
  std::condition_variable changed;
  unsigned turn = turns().take();
  bool running = false;  ///< it is this session's turn
  bool paused = false, destroyed = false, ended = false;

  std::vector<std::string> lines() const {
    std::vector<std::string> all = command_lines(launch.extra);
    if (all.empty()) all = command_lines(content_of(launch.files / "args.txt"));
    if (all.empty()) all = {"study table3"};
    return all;
  }

  bool is_destroyed() {
    const std::lock_guard lock(mutex);
    return destroyed;
  }

  /// One command; where its results lie goes into `where`.
  bool run(Ledger& ledger, std::size_t k, const std::string& line, fs::path& where) {
    std::vector<std::string> words = split_words(line);
    if (!words.empty() && words[0] == "clothbench") words.erase(words.begin());
    fs::path out;
    if (writes_results(words)) {
      // A live session cannot be gone on with: the user was elsewhere.
      const bool again = words[0] != "xr" && !ledger[k].value("out", "").empty();
      if (!again) {
        const std::string given = option_value(words, "--out");
        ledger[k]["out"] = given.empty() ? fresh_folder(launch.files, words).string() : given;
      }
      out = ledger[k].value("out", "");
      if (!has_option(words, "--out")) words.insert(words.end(), {"--out", out.string()});
      if (again && !has_option(words, "--resume")) words.push_back("--resume");
      system->log(fmt::format("{} {}: results in {}", again ? "going on with" : "running", line, out.string()));
    } else {
      system->log("running " + line);
    }
    ledger.save();
    if (!out.empty()) where = out;
    const int code = command(words);
    if (code == static_cast<int>(ExitCode::Interrupted)) {
      system->log("interrupted; a start with the same arguments goes on");
      return false;
    }
    ledger[k]["state"] = code == 0 ? "pass" : "fail";
    ledger[k]["exit_code"] = code;
    ledger.save();
    if (code != 0) system->log(fmt::format("{}: exit code {}", line, code));
    return code == 0;
  }

  /// All commands; true if every one passed.
  bool run_all(fs::path& where) {
    const std::vector<std::string> all = lines();
    Ledger ledger(launch.files / "session.json", all);
    bool pass = true;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::string state = ledger[k].value("state", "");
      if (state == "pass" || state == "fail") {
        system->log(fmt::format("{}: ended before this start ({})", all[k], state));
        pass = pass && state == "pass";
        continue;
      }
      if (is_destroyed()) return false;
      pass = run(ledger, k, all[k], where) && pass;
    }
    return pass;
  }

  void work() {
    turns().wait_for(turn);
    {
      const std::lock_guard lock(mutex);
      clear_interrupt();
      if (destroyed) request_interrupt();
      hold_runs(paused && !destroyed);
      running = true;
    }
    bool pass = false;
    fs::path where = launch.files;
    try {
      pass = run_all(where);
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
    turns().end();
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

void Session::low_memory() {
  const std::lock_guard lock(shared_->mutex);
  // There is nothing to give back: a run holds what its scene needs and nothing else.
  if (!shared_->ended) shared_->system->log("the system is low on memory");
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
