#include "runner/solver_ends.hpp"

#include <fmt/format.h>

namespace clothbench {

void SolverEnds::add(const std::string& solver, const Outcome& outcome) {
  if (outcome.status == "unsupported" || outcome.status == "over_budget") return;
  Ends& e = ends_[solver];
  if (outcome.status == "ok" || outcome.expect == "pass") {
    ++e.finished;
    return;
  }
  ++e.failed;
  e.last = outcome.message.empty() ? outcome.status : outcome.status + ": " + outcome.message;
}

std::vector<std::string> SolverEnds::faults() const {
  std::vector<std::string> out;
  for (const auto& [solver, e] : ends_)
    if (e.finished == 0)
      out.push_back(fmt::format("{}: finished none of {} runs; the last: {}", solver, e.failed, e.last));
  return out;
}

}  // namespace clothbench
