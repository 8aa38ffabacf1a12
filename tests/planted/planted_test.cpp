// One fault at a time in solver, metrics and records. Each must be detected by `clothbench check`, with a healthy run
// as its baseline.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "trial.hpp"

namespace clothbench {
namespace {

const Stage& stage(const std::string& name) {
  static const std::vector<Stage> all = stages();
  for (const Stage& s : all)
    if (s.name == name) return s;
  throw std::runtime_error("no stage " + name);
}

/// The stages with contact planes take half of the time, so only the slow tier (planted.whole) runs them.
bool left_to_slow_tier(const std::string& stage) {
  return std::getenv("CLOTHBENCH_WHOLE_MATRIX") == nullptr &&
         (stage == "struck" || stage == "wrapped" || stage == "heaped");
}

const RunRecord& healthy(const std::string& name) {
  static std::map<std::string, RunRecord> known;
  if (!known.contains(name)) known.emplace(name, execute_run(stage(name)));
  return known.at(name);
}

/// The failures of a run that `clothbench check` reports; empty if it passes.
std::string caught_by(const RunRecord& was, const RunRecord& is) {
  try {
    std::string out;
    for (const CheckedRun& run : check_runs({{gated_part(was)}}, {is}).runs)
      for (const Finding& f : run.findings)
        if (f.verdict == Verdict::Failed) out += (out.empty() ? "" : "; ") + f.sentence();
    return out;
  } catch (const Error& e) {  // runs that cannot be compared
    return e.what();
  }
}

// One test, because both parts need the healthy runs.
TEST(Planted, AHealthyRunPassesTwiceAndEveryFaultIsCaught) {
  for (const Stage& s : stages()) {
    if (left_to_slow_tier(s.name)) continue;
    EXPECT_EQ(healthy(s.name).outcome.status, "ok") << s.name << ": " << healthy(s.name).outcome.message;
    EXPECT_EQ(caught_by(healthy(s.name), execute_run(stage(s.name))), "") << s.name;
  }
  const std::vector<Fault> all = faults();
  int planted = 0, missed = 0;
  for (const Fault& f : all) {
    if (left_to_slow_tier(f.stage)) continue;
    ++planted;
    std::string caught;
    try {
      const RunRecord is = execute_run(stage(f.stage), &f);
      caught = caught_by(healthy(f.stage), is);
    } catch (const std::exception& e) {
      ADD_FAILURE() << f.name << ": " << e.what();
      continue;
    }
    fmt::print("  {:<52} {:<11} {}\n", f.name, f.stage, caught.empty() ? "MISSED" : caught.substr(0, 150));
    std::fflush(stdout);
    missed += caught.empty();
    EXPECT_NE(caught, "") << f.name;
  }
  fmt::print("  {} faults, {} caught\n", planted, planted - missed);
  EXPECT_GE(planted, 35);
}

TEST(Planted, AFaultThatIsNowhereIsAnError) {
  Fault gone{"gone", "fall"};
  gone.shader = ShaderFault{"lines.glsl", "no such text", ""};
  EXPECT_THROW(execute_run(stage("fall"), &gone), std::runtime_error);
  gone.shader = ShaderFault{"paper/collision_pass.comp", "void main() {", "void main() { return;"};
  EXPECT_THROW(execute_run(stage("fall"), &gone), std::runtime_error) << "no kernel of the run contains the fault";
}

}  // namespace
}  // namespace clothbench
