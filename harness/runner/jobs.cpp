#include "runner/jobs.hpp"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "clothbench";

struct Process {
  int parent = 0;
  bool is_job = false;
};

/// Of /proc/<pid>/stat: "pid (name) state parent …"; the name may hold anything, so what follows is found from its last
/// ')'.
Process process_of(const fs::path& stat) {
  std::ifstream in(stat);
  std::string text;
  std::getline(in, text);
  const std::size_t open = text.find('('), close = text.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close + 4 >= text.size()) return {};
  const char state = text[close + 2];
  const bool alive = state != 'Z' && state != 'X' && state != 'T';  // dead, or stopped
  return {std::atoi(text.c_str() + close + 4), alive && text.substr(open + 1, close - open - 1) == kProgram};
}

/// Whether `who` descends from `of`.
bool descends(const std::map<int, Process>& all, int who, int of) {
  for (std::size_t steps = 0; steps <= all.size(); ++steps) {
    if (who == of) return true;
    const auto at = all.find(who);
    if (at == all.end()) return false;
    who = at->second.parent;
  }
  return false;
}

}  // namespace

int jobs_in(const fs::path& proc, int self) {
  std::map<int, Process> all;
  std::error_code ec;
  for (fs::directory_iterator at(proc, ec), end; !ec && at != end; at.increment(ec)) {
    const std::string name = at->path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos)
      all[std::atoi(name.c_str())] = process_of(at->path() / "stat");
  }
  int jobs = 1;
  for (const auto& [pid, p] : all) jobs += p.is_job && !descends(all, pid, self) && !descends(all, self, pid);
  return jobs;
}

int jobs_now() {
  const char* given = std::getenv("CLOTHBENCH_JOBS");
  const int jobs = given == nullptr ? 0 : std::atoi(given);
  return jobs > 0 ? jobs : jobs_in("/proc", getpid());
}

}  // namespace clothbench
