#include "runner/supervise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>

#include "base/files.hpp"
#include "base/plugin_environment.hpp"
#include "runner/again.hpp"
#include "runner/run_process.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr char kVariable[] = "CLOTHBENCH_SUPERVISED";  // "new:<folder>" or "again:<folder>"

fs::path note_file(const fs::path& out) { return out / "running.txt"; }

/// "<run>: trial 2 of 5" -> that run; null if it is not the plan's.
const RunSpec* run_of(const RunPlan& plan, const std::string& note) {
  const std::string name = note.substr(0, note.find(": "));
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (run_name(c) == name) return &c;
  return nullptr;
}

/// This command in a child process, which is killed if a plugin's run makes no progress.
ChildEnd run_watched(const std::vector<std::string>& words, const std::string& variable, const RunPlan& plan,
                     const fs::path& note) {
  using Clock = std::chrono::steady_clock;
  std::string doing;
  auto since = Clock::now();
  return run_again(words, variable, false, [&] {
    std::string now = content_of(note);
    if (now != doing) {
      doing = std::move(now);
      since = Clock::now();
    }
    const RunSpec* at = run_of(plan, doing);
    return at != nullptr && is_external(at->entry->info) &&
           std::chrono::duration<double>(Clock::now() - since).count() > plugin_limit_s();
  });
}

void write_row(const RunSpec& c, const RunPlan& plan, const fs::path& out, const Outcome& outcome) {
  RunRecord r;
  r.header = header_of(*c.scene, c.entry->info.name, c.setting, c.settings, plan.protocol);
  r.outcome = outcome;
  write_failed_run(out, r.header, outcome, summarise(c, {}, r));
}

}  // namespace

bool needs_supervision(const RunPlan& plan) {
  if (plan.apart || supervised() || plugins_in_process()) return false;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (is_external(c.entry->info)) return true;
  return false;
}

ExitCode supervise(const RunPlan& plan, const fs::path& out, bool resume, const std::vector<std::string>& words) {
  const fs::path note = note_file(out);
  std::error_code ignored;
  fs::remove(note, ignored);
  for (std::size_t children = 0; children <= plan.size(); ++children) {  // one row per child at least
    const bool again = resume || children > 0;
    const ChildEnd end =
        run_watched(words, fmt::format("{}={}:{}", kVariable, again ? "again" : "new", out.string()), plan, note);
    if (!fs::exists(note, ignored))  // it came to its end, good or bad
      return static_cast<ExitCode>(end.how == ChildEnd::How::Exited ? end.code : 1);
    const std::string doing = content_of(note);
    const RunSpec* at = run_of(plan, doing);
    fs::remove(note, ignored);
    if (at == nullptr)
      throw Error(fmt::format("{}: the study's process: {}", doing, end.text()), ExitCode::CheckFailed);
    const std::string message = fmt::format("its process: {}, at \"{}\"", end.text(), doing);
    fmt::print(stderr, "{}\n", message);
    write_row(*at, plan, out, {end.how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F8", -1, message});
  }
  throw Error("the study's process crashed more often than there are runs", ExitCode::CheckFailed);
}

std::optional<Supervised> supervised() {
  const char* given = std::getenv(kVariable);
  if (given == nullptr) return std::nullopt;
  const std::string text = given;
  const std::size_t colon = text.find(':');
  return Supervised{text.substr(colon + 1), text.substr(0, colon) == "again"};
}

RunningNote::RunningNote(const std::optional<Supervised>& s) : file_(s ? note_file(s->out) : fs::path()) {
  if (s) end_with_parent();
  write("before the first run");
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
