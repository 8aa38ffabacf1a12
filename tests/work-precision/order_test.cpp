// The order in time that a solver's integrator declares, observed on the pendulum.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "refusal.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

constexpr int kIterations = 64;  // solved: what remains is the integrator's

bool has(const SolverInfo& info, const char* setting) {
  for (const SettingSpec& s : info.settings)
    if (s.name == setting) return true;
  return false;
}

class Order : public ::testing::TestWithParam<std::string> {};

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const SolverEntry& e : solvers())
    if (e.info.ignores.empty() && has(e.info, "substeps")) out.push_back(e.info.name);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Every, Order, ::testing::ValuesIn(names()), [](const auto& i) { return test_name(i.param); });

double truth_error(const Scene& s, const SolverEntry& entry, int substeps) {
  nlohmann::json given = {{"substeps", substeps}};
  if (has(entry.info, "iterations")) given["iterations"] = kIterations;
  if (has(entry.info, "implicit")) given["implicit"] = true;
  SolverRun run({&s, &entry, complete_settings(entry.info, given)}, {}, "test");
  TrialRules rules;
  rules.accuracy_duration_s = s.time.duration_s;
  const AccuracyPass pass = run.run_accuracy(rules);
  EXPECT_EQ(run.outcome().status, "ok");
  return scalars_of({s, pass}).at("truth_error");
}

TEST_P(Order, IsAsDeclared) {
  const SolverEntry& entry = find_solver(GetParam());
  const Scene s = load_scene("validation/pendulum");
  if (!unsupported(entry.info, s.needs).empty()) GTEST_SKIP() << "unsupported";
  try {
    const double e1 = truth_error(s, entry, 4), e2 = truth_error(s, entry, 8), e3 = truth_error(s, entry, 16);
    EXPECT_NEAR(std::log2(e1 / e2), entry.info.time_order, 0.25) << e1 << " " << e2 << " " << e3;
    EXPECT_NEAR(std::log2(e2 / e3), entry.info.time_order, 0.25) << e1 << " " << e2 << " " << e3;
    EXPECT_LT(e3, 0.01);
  } catch (const Error& e) {
    const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
    if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
    FAIL() << e.what();
  }
}

}  // namespace
}  // namespace clothbench
