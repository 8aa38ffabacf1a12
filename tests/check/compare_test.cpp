// Every rule of the check, on runs as the runner would store them.
#include "check/compare.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "refusal.hpp"
#include "results.hpp"

namespace clothbench {
namespace {

Baseline baseline_of(const std::vector<RunRecord>& runs) { return update_baseline({}, runs).baseline; }

std::vector<Finding> findings(const RunRecord& was, const RunRecord& is) { return compare_run(gated_part(was), is); }

/// Verdict of one changed scalar.
Verdict verdict_of(const std::string& name, double was, double is) {
  const std::vector<Finding> f = findings(with(contact_run(), name, was), with(contact_run(), name, is));
  if (f.empty()) return Verdict::Same;
  EXPECT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].quantity, name);
  return f[0].verdict;
}

TEST(Gates, EveryPenetrationScalarHasOneAndNoTimeDoes) {
  for (const char* name : {"contact_length_settled_m", "contact_length_max_m", "crossings_max", "depth_max_m",
                           "stretch_max", "stretch_max_end", "expect.anything", "free_fall_error", "dispatches"})
    EXPECT_NE(find_gate(name), nullptr) << name;
  for (const char* name : {"fps_median", "fps_at_72", "frame_wall_median_s", "frame_device_median_s",
                           "read_B_per_frame", "write_B_per_frame", "bandwidth_read_peak_B_per_s", "bandwidth_window_s",
                           "device_memory_B", "load_s", "trials"})
    EXPECT_EQ(find_gate(name), nullptr) << name;
}

TEST(Gates, SlackScalesWithTheCloth) {
  const Gate& depth = *find_gate("depth_max_m");
  EXPECT_DOUBLE_EQ(slack(depth, 0, 2), 2 * slack(depth, 0, 1));
  EXPECT_GT(slack(depth, 1, 1), slack(depth, 0, 1));
  EXPECT_EQ(slack(*find_gate("crossings_max"), 0, 1), 0);
}

TEST(Compare, MoreThanSlackFailsLessIsBetter) {
  for (const std::string& name : gated_names()) {
    if (is_verdict(name)) continue;
    const double was = 1, room = slack(*find_gate(name), was, 0.5);
    EXPECT_EQ(verdict_of(name, was, was), Verdict::Same) << name;
    EXPECT_EQ(verdict_of(name, was, was + 0.99 * room), Verdict::Same) << name;
    EXPECT_EQ(verdict_of(name, was, was - 0.99 * room), Verdict::Same) << name;
    EXPECT_EQ(verdict_of(name, was, was + 1.01 * room + 1e-12), Verdict::Failed) << name;
    EXPECT_EQ(verdict_of(name, was, was - 1.01 * room - 1e-12), Verdict::Improved) << name;
  }
}

TEST(Compare, NothingTunnelledStaysNothing) {
  EXPECT_EQ(verdict_of("crossings_max", 0, 1e-12), Verdict::Failed);
  EXPECT_EQ(verdict_of("contact_length_settled_m", 0, 1e-12), Verdict::Failed);
  EXPECT_EQ(verdict_of("depth_max_m", 0, 1e-12), Verdict::Same);
}

TEST(Compare, NotANumberFailsWhereTheBaselineHasOne) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const char* name : {"depth_max_m", "crossings_max", "dispatches", "free_fall_error", "expect.depth_max_m"}) {
    EXPECT_EQ(verdict_of(name, 1, kMissing), Verdict::Failed) << name;
    EXPECT_EQ(verdict_of(name, 0, kMissing), Verdict::Failed) << name;
    EXPECT_EQ(verdict_of(name, 1, inf), Verdict::Failed) << name;
    EXPECT_EQ(verdict_of(name, 1, -inf), Verdict::Failed) << name;
    EXPECT_EQ(verdict_of(name, kMissing, kMissing), Verdict::Same) << name;
    EXPECT_EQ(verdict_of(name, kMissing, 1), Verdict::New) << name;
  }
  RunRecord absent = contact_run();
  absent.summary.erase("depth_max_m");
  ASSERT_EQ(findings(contact_run(), absent).size(), 1u);
  EXPECT_EQ(findings(contact_run(), absent)[0].verdict, Verdict::Failed);
  EXPECT_EQ(findings(absent, contact_run())[0].verdict, Verdict::New);
}

TEST(Compare, TheScenesOwnVerdict) {
  EXPECT_EQ(verdict_of("expect.depth_max_m", 1, 0), Verdict::Failed);
  EXPECT_EQ(verdict_of("expect.depth_max_m", 0, 1), Verdict::Improved);
  EXPECT_EQ(verdict_of("expect.depth_max_m", 0, 0), Verdict::Same);
}

TEST(Compare, Outcome) {
  const RunRecord ok = contact_run(), blown = ended(ok, "diverged", "F2", 40);
  const auto verdict = [](const RunRecord& was, const RunRecord& is) {
    const auto f = findings(was, is);
    EXPECT_LE(f.size(), 1u);
    return f.empty() ? Verdict::Same : f[0].verdict;
  };
  EXPECT_EQ(verdict(ok, blown), Verdict::Failed);
  EXPECT_EQ(findings(ok, blown)[0].message, "what the solver said");
  EXPECT_EQ(verdict(blown, ok), Verdict::Improved);
  EXPECT_EQ(verdict(blown, blown), Verdict::Same);
  EXPECT_EQ(verdict(blown, ended(ok, "diverged", "F3", 40)), Verdict::Failed) << "another class";
  EXPECT_EQ(verdict(blown, ended(ok, "not_finite", "F2", 40)), Verdict::Failed) << "another status";
  EXPECT_EQ(verdict(ended(ok, "unsupported"), ended(ok, "diverged", "F2", 40)), Verdict::Failed);
  EXPECT_EQ(verdict(ended(ok, "unsupported"), ok), Verdict::Improved);
  EXPECT_EQ(verdict(ok, ended(ok, "unsupported")), Verdict::Failed);
  EXPECT_EQ(verdict(ok, ended(ok, "ok", "F4")), Verdict::Failed);
  EXPECT_EQ(verdict(ended(ok, "ok", "F4"), ok), Verdict::Improved);
  // 2 frames and a tenth of 40: a blow-up in frames 34 to 46 counts as the same.
  EXPECT_EQ(verdict(blown, ended(ok, "diverged", "F2", 34)), Verdict::Same);
  EXPECT_EQ(verdict(blown, ended(ok, "diverged", "F2", 33)), Verdict::Failed);
  EXPECT_EQ(verdict(blown, ended(ok, "diverged", "F2", 46)), Verdict::Same);
  EXPECT_EQ(verdict(blown, ended(ok, "diverged", "F2", 47)), Verdict::Improved);
  EXPECT_EQ(verdict(blown, ended(ok, "diverged", "F2", -1)), Verdict::Failed);
}

TEST(Compare, Stages) {
  RunRecord extra = contact_run(), fewer = contact_run(), serves = contact_run(), order = contact_run();
  extra.header.stages.push_back({"Friction", {"friction"}, 1});
  fewer.header.stages.pop_back();
  serves.header.stages[2].serves = {"moving_mesh"};
  std::swap(order.header.stages[0], order.header.stages[1]);
  for (const RunRecord& changed : {extra, fewer, serves, order}) {
    const auto f = findings(contact_run(), changed);
    ASSERT_EQ(f.size(), 1u);
    EXPECT_EQ(f[0].verdict, Verdict::Failed);
    EXPECT_EQ(f[0].quantity, "stages");
  }
  EXPECT_EQ(findings(contact_run(), extra)[0].message, "not in the baseline: Friction (friction)");
  EXPECT_EQ(findings(contact_run(), serves)[0].message,
            "not in the baseline: Contact (moving_mesh); missing: Contact (static_mesh)");
  EXPECT_NE(findings(contact_run(), order)[0].message.find("order"), std::string::npos);
}

TEST(Check, OtherConditionsAreRefusedByNameUnlessAllowed) {
  const struct {
    const char *kind, *found;
    void (*change)(RunRecord&);
  } all[] = {{"scene", "ffff", [](RunRecord& r) { r.header.scenario_sha256 = "ffff"; }},
             {"device", "Other GPU", [](RunRecord& r) { r.header.environment["gpu"] = "Other GPU"; }},
             {"precision", "float64", [](RunRecord& r) { r.header.environment["precision"] = "float64"; }},
             {"length", "1", [](RunRecord& r) { r.accuracy.time_s.assign(2, 0); }}};
  const Baseline baseline = baseline_of({contact_run()});
  for (const auto& other : all) {
    RunRecord changed = contact_run();
    other.change(changed);
    const std::string refused = refusal([&] { check_runs(baseline, {changed}); });
    for (const char* word : {other.kind, other.found, "desk__xpbd__default", "--allow"})
      EXPECT_NE(refused.find(word), std::string::npos) << refused;
    const Checked allowed = check_runs(baseline, {changed}, {other.kind});
    EXPECT_TRUE(allowed.passed()) << other.kind;
    EXPECT_NE(allowed.differing.marks().find(other.found), std::string::npos);
    EXPECT_NE(check_text(allowed, "b.json").find(other.found), std::string::npos);
    EXPECT_NE(junit_xml(allowed).find(other.found), std::string::npos);
    EXPECT_EQ(check_json(allowed, "b.json")["overridden"][0]["kind"], other.kind);
  }
}

/// Results do not depend on the machine of a CPU solver, on drivers, or on timed trials, so these are no conditions.
TEST(Check, WhatResultsDoNotHangOnIsNoCondition) {
  RunRecord changed = contact_run();
  changed.header.environment["cpu"] = "Other CPU";
  changed.header.environment["driver"] = "other";
  changed.trials.resize(1);
  changed.trials[0].frame_wall_s = {1, 2, 3};
  EXPECT_TRUE(check_runs(baseline_of({contact_run()}), {changed}).passed());
}

TEST(Compare, ASceneWithoutSizeIsBadInput) {
  RunRecord odd = contact_run();
  for (const char* json : {"{}", "not JSON", R"({"cloth":{"size_m":["a",1]}})"}) {
    odd.header.scenario_json = json;
    EXPECT_NE(refusal([&] { findings(contact_run(), odd); }).find("/cloth/size_m"), std::string::npos) << json;
  }
}

TEST(Check, MissingRunsFailNewOnesDoNot) {
  const RunRecord a = contact_run("a"), b = contact_run("b"), c = contact_run("c");
  const Checked gone = check_runs(baseline_of({a, b}), {a});
  ASSERT_EQ(gone.runs.size(), 2u);
  EXPECT_FALSE(gone.passed());
  EXPECT_EQ(gone.runs[1].findings.at(0).found, "missing");

  const Checked interrupted = check_runs(baseline_of({a, b}), {a, planned(b)});
  EXPECT_EQ(interrupted.count(Verdict::Failed), 1u);
  EXPECT_EQ(interrupted.runs[1].findings.at(0).message, "planned, not run");
  EXPECT_FALSE(check_runs(baseline_of({a}), {a, planned(b)}).passed()) << "an unfinished study";

  const Checked more = check_runs(baseline_of({a, b}), {c, b, a});
  EXPECT_TRUE(more.passed());
  EXPECT_EQ(more.count(Verdict::New), 1u);
  EXPECT_EQ(more.count(Verdict::Same), 2u);
  EXPECT_TRUE(check_runs(baseline_of({a}), {a, with(b, "expect.motion", 1)}).passed());
  for (const double motion : {0.0, kMissing})
    EXPECT_FALSE(check_runs(baseline_of({a}), {a, with(b, "expect.motion", motion)}).passed()) << "impossible";

  EXPECT_FALSE(check_runs(baseline_of({a}), {}).passed());
  EXPECT_NE(refusal([&] { check_runs(baseline_of({a}), {a, a}); }).find("twice"), std::string::npos);
}

TEST(Check, APlannedRunIsFoundByItsFileName) {
  RunRecord odd = contact_run();
  odd.header.setting = "speed=0.5 m/s";
  RunRecord as_planned = planned(odd);
  as_planned.header.setting = "speed=0.5-m-s";
  const Checked checked = check_runs(baseline_of({odd}), {as_planned});
  ASSERT_EQ(checked.runs.size(), 1u);
  EXPECT_EQ(checked.runs[0].key.setting, "speed=0.5 m/s");
}

TEST(Check, ProceduralRoomsDoNotPassForScans) {
  RunRecord scanned = contact_run(), procedural = contact_run();
  scanned.header.scenario_json = R"({"assets":"npm","cloth":{"size_m":[0.5,0.75]}})";
  procedural.header.scenario_json = R"({"assets":"procedural","cloth":{"size_m":[0.5,0.75]}})";
  const std::string refused = refusal([&] { check_runs(baseline_of({scanned}), {procedural}); });
  EXPECT_NE(refused.find("scene: rooms and hands: npm and procedural"), std::string::npos) << refused;
}

TEST(Check, ARunIsAsBadAsItsWorstFinding) {
  const RunRecord was = contact_run();
  const RunRecord is = with(with(was, "depth_max_m", 0), "crossings_max", 0.5);
  const Checked checked = check_runs(baseline_of({was}), {is});
  EXPECT_EQ(checked.runs.at(0).findings.size(), 2u);
  EXPECT_EQ(checked.runs.at(0).verdict(), Verdict::Failed);
  EXPECT_EQ(checked.count(Verdict::Improved), 0u);
}

TEST(Update, TakesTheResultsAndSaysWhatChanged) {
  const RunRecord a = contact_run("a"), b = contact_run("b"), c = contact_run("c"), d = contact_run("d");
  const Baseline old = baseline_of({a, b, d});
  const std::vector<RunRecord> results = {with(a, "depth_max_m", 0.5), c, with(d, "depth_max_m", 0.00301)};
  const Updated u = update_baseline(old, results);
  ASSERT_EQ(u.changes.size(), 2u);
  EXPECT_EQ(u.changes[0].findings.at(0).quantity, "depth_max_m");
  EXPECT_EQ(u.changes[1].verdict(), Verdict::New);
  ASSERT_EQ(u.removed.size(), 1u);
  EXPECT_EQ(u.removed[0].scene, "b");
  EXPECT_EQ(u.within_slack, 1u);
  const Checked again = check_runs(u.baseline, results);
  EXPECT_EQ(again.count(Verdict::Same), 3u);
}

TEST(Update, RefusesWhatIsNotWhole) {
  const RunRecord a = contact_run("a"), b = contact_run("b");
  EXPECT_NE(refusal([&] { update_baseline({}, {a, planned(b)}); }).find("b__xpbd__default"), std::string::npos);
  EXPECT_NE(refusal([&] { update_baseline({}, {}); }).find("expected results with at least one run"),
            std::string::npos);
  EXPECT_NE(refusal([&] { update_baseline({}, {a, a}); }).find("twice"), std::string::npos);
}

}  // namespace
}  // namespace clothbench
