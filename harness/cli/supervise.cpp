#include "cli/supervise.hpp"

#include <fmt/format.h>
#include <spawn.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "runner/child.hpp"
#include "runner/environment.hpp"
#include "scenario/json_text.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr char kVariable[] = "CLOTHBENCH_SUPERVISED";  // "new:<folder>" or "again:<folder>"

fs::path note_file(const fs::path& out) { return out / "running.txt"; }

double limit_s() {
  constexpr double kUsual = 900;
  const char* given = std::getenv("CLOTHBENCH_PLUGIN_LIMIT_S");
  const double s = given != nullptr ? std::atof(given) : kUsual;
  return s > 0 ? s : kUsual;
}

pid_t start(const Console& console, const fs::path& out, bool resume) {
  setenv(kVariable, ((resume ? "again:" : "new:") + out.string()).c_str(), 1);
  std::vector<std::string> words = {own_program().string()};
  words.insert(words.end(), console.words.begin(), console.words.end());
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A group of its own: Ctrl-C comes to it once, from here, since a second one would cut it off.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t pid = -1;
  const int failed = posix_spawn(&pid, argv[0], nullptr, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  unsetenv(kVariable);
  if (failed != 0) throw Error(words[0] + ": cannot be started: " + std::strerror(failed), ExitCode::CheckFailed);
  return pid;
}

/// "<cell>: trial 2 of 5" -> the cell, if it is one of the plan.
const CellSpec* cell_of(const CellPlan& plan, const std::string& note) {
  const std::string name = note.substr(0, note.find(": "));
  for (const auto& group : plan.groups)
    for (const CellSpec& c : group) {
      CellHeader h;
      h.scene = c.scene->name;
      h.solver = c.entry->info.name;
      h.setting = c.setting;
      if (cell_name(h) == name) return &c;
    }
  return nullptr;
}

/// Waits for the child's end; kills it where a plugin's cell stands still.
ChildEnd wait_for(pid_t pid, const CellPlan& plan, const fs::path& note) {
  using Clock = std::chrono::steady_clock;
  constexpr useconds_t kLook_us = 20000;
  std::string doing;
  auto since = Clock::now();
  bool told = false;
  for (int status = 0;;) {
    const pid_t ended = waitpid(pid, &status, WNOHANG);
    const double waited_s = std::chrono::duration<double>(Clock::now() - since).count();
    if (ended == pid && WIFSIGNALED(status)) return {ChildEnd::How::Signalled, WTERMSIG(status), waited_s};
    if (ended == pid) return {ChildEnd::How::Exited, WEXITSTATUS(status), waited_s};
    if (interrupt_requested() && !told) {
      kill(pid, SIGINT);
      told = true;
    }
    std::error_code ignored;
    std::string now = fs::exists(note, ignored) ? read_text(note.string()) : "";
    if (now != doing) {
      doing = std::move(now);
      since = Clock::now();
    } else if (const CellSpec* c = waited_s > limit_s() ? cell_of(plan, doing) : nullptr;
               c != nullptr && is_external(c->entry->info)) {
      kill(pid, SIGKILL);
      waitpid(pid, &status, 0);
      return {ChildEnd::How::TimedOut, 0, waited_s};
    }
    usleep(kLook_us);
  }
}

void write_row(const CellSpec& c, const CellPlan& plan, const fs::path& out, const Outcome& outcome) {
  CellRecord r;
  CellHeader& h = r.header;
  h.scene = c.scene->name;
  h.solver = c.entry->info.name;
  h.setting = c.setting;
  h.settings = c.settings;
  h.scenario_json = c.scene->json;
  h.scenario_sha256 = c.scene->sha256;
  h.environment = describe_environment({}, plan.protocol);
  h.vertices = static_cast<std::uint32_t>(c.scene->cloth.vertex_count());
  for (const auto& t : triangles(c.scene->cloth)) h.triangles.insert(h.triangles.end(), t.begin(), t.end());
  r.outcome = outcome;
  std::error_code ignored;
  fs::remove_all(out / (cell_name(h) + ".part"), ignored);  // its trials are those of a solver that crashes
  CellWriter(out, h).finish(outcome, summarise(c, {}, r));
}

}  // namespace

bool needs_supervision(const CellPlan& plan) {
  if (supervised()) return false;
  for (const auto& group : plan.groups)
    for (const CellSpec& c : group)
      if (is_external(c.entry->info)) return true;
  return false;
}

void supervise(const CellPlan& plan, const fs::path& out, bool resume, Console& console) {
  const fs::path note = note_file(out);
  std::error_code ignored;
  fs::remove(note, ignored);
  for (std::size_t children = 0; children <= plan.size(); ++children) {
    const ChildEnd end = wait_for(start(console, out, resume || children > 0), plan, note);
    if (!fs::exists(note, ignored)) {  // it came to its end, good or bad
      console.exit_code = static_cast<ExitCode>(end.how == ChildEnd::How::Exited ? end.code : 1);
      return;
    }
    const std::string doing = read_text(note.string());
    const CellSpec* c = cell_of(plan, doing);
    fs::remove(note, ignored);
    if (c == nullptr)
      throw Error(fmt::format("{}: the process that ran the cells: {}", doing, end.text()), ExitCode::CheckFailed);
    const std::string message = fmt::format("its process: {}, at \"{}\"", end.text(), doing);
    fmt::print(stderr, "{}\n", message);
    write_row(*c, plan, out, {end.how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F8", -1, message});
  }
  throw Error("the process that runs the cells crashed more often than there are cells", ExitCode::CheckFailed);
}

std::optional<Supervised> supervised() {
  const char* given = std::getenv(kVariable);
  if (given == nullptr) return std::nullopt;
  const std::string text = given;
  const std::size_t colon = text.find(':');
  return Supervised{text.substr(colon + 1), text.substr(0, colon) == "again"};
}

RunningNote::RunningNote(const std::optional<Supervised>& s) : file_(s ? note_file(s->out) : fs::path()) {
#ifdef __linux__
  // Whoever ends the parent means this process too, which may hang in a plugin.
  if (s) prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  write("before the first cell");
}

RunningNote::~RunningNote() {
  std::error_code ignored;
  if (!file_.empty()) fs::remove(file_, ignored);
}

/// Not synced: it need only outlive this process.
void RunningNote::write(const std::string& what) const {
  if (file_.empty()) return;
  const fs::path temporary = file_.string() + ".tmp";
  std::ofstream(temporary) << what;
  std::error_code ignored;
  fs::rename(temporary, file_, ignored);
}

}  // namespace clothbench
