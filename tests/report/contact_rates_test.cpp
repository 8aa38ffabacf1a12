#include "report/contact_rates.hpp"

#include <gtest/gtest.h>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

RunRecord drawn(const std::string& solver, const std::string& kind, int seed, double speed, const std::string& ending,
                double contour = 0, const std::string& assets = "npm") {
  RunRecord c;
  c.header.solver = solver;
  c.header.setting = "default";
  c.header.scene = "contact-" + std::to_string(seed) + "-" + kind;
  c.header.environment = {{"protocol", "short"}};
  c.header.scenario_json =
      nlohmann::json{
          {"name", c.header.scene},
          {"seed", seed},
          {"drawn",
           {{"study", "contact"}, {"kind", kind}, {"assets", assets}, {"speed_m_per_s", speed}, {"values", {}}}}}
          .dump();
  const bool ended = ending == "pass" || ending == "fail";
  c.outcome.status = ended ? "ok" : ending;
  c.outcome.expect = ending == "fail" ? "fail: contact_length_max_m" : ended ? ending : "not measured";
  c.summary["contact_length_max_m"] = contour;
  c.summary["expect.contact_length_max_m"] = !ended ? NAN : ending == "pass" ? 1 : 0;
  return c;
}

std::vector<RunRecord> sample() {
  return {drawn("xpbd", "sweep", 1, 0.5, "pass"),        drawn("xpbd", "sweep", 3, 1.99, "pass"),
          drawn("xpbd", "sweep", 5, 2, "fail", 0.02),    drawn("xpbd", "sweep", 7, 14, "fail", 0.3),
          drawn("xpbd", "desk", 2, 6, "timed_out"),      drawn("xpbd", "desk", 4, 6, "pass"),
          drawn("paper", "desk", 2, 6, "unsupported"),   drawn("paper", "desk", 4, 6, "crashed"),
          drawn("paper", "sweep", 1, 0.5, "pass", 0.01), RunRecord{}};
}

TEST(ContactRates, CountWhatDidNotRunAsNotPassed) {
  const std::vector<RunRecord> runs = sample();
  const auto rate = [&](const std::string& solver, const std::string& kind, const std::string& band) -> ContactRate {
    for (const ContactRate& r : contact_rates(runs))
      if (r.solver == solver && r.kind == kind && r.band == band) return r;
    return {};
  };
  EXPECT_EQ(rate("xpbd", "sweep", "0–2").passed, 2u);
  EXPECT_EQ(rate("xpbd", "sweep", "0–2").drawn, 2u);
  EXPECT_EQ(rate("xpbd", "sweep", "2–5").drawn, 1u) << "2 m/s is in the upper band";
  EXPECT_EQ(rate("xpbd", "sweep", "≥ 10").passed, 0u);
  EXPECT_EQ(rate("xpbd", "desk", "5–10").drawn, 2u);
  EXPECT_EQ(rate("xpbd", "desk", "5–10").passed, 1u);
  EXPECT_EQ(rate("xpbd", "desk", "5–10").not_ended, 1u);
  const ContactRate all = rate("xpbd", "all", "all"), paper = rate("paper", "all", "all");
  EXPECT_EQ(all.passed, 3u);
  EXPECT_EQ(all.drawn, 6u);
  EXPECT_EQ(paper.drawn, 3u);
  EXPECT_EQ(paper.passed, 1u);
  EXPECT_EQ(paper.unsupported, 1u);
  EXPECT_EQ(paper.not_ended, 1u);
  EXPECT_EQ(all.interval().low, wilson_95(3, 6).low);
}

TEST(ContactRates, TableHasARowAKindAndAColumnASpeedBand) {
  const Table t = contact_rate_table(sample());
  EXPECT_EQ(t.rows[0], (std::vector<std::string>{"solver", "kind", "0–2", "2–5", "5–10", "≥ 10", "all"}));
  EXPECT_EQ(t.rows[1], (std::vector<std::string>{"xpbd", "sweep", "2/2 (34–100 %)", "0/1 (0–79 %)", "–", "0/1 (0–79 %)",
                                                 "2/4 (15–85 %)"}));
  EXPECT_EQ(contact_rate_table({drawn("xpbd", "desk", 1, 1, "pass", 0, "procedural")}).rows[1][1], "desk (procedural)");
}

TEST(ContactRates, ATableSaysWhereTheSolverHoldsTheCloth) {
  std::vector<RunRecord> runs = {drawn("xpbd", "desk", 1, 1, "pass", 0, "procedural")};
  runs[0].header.plan["contact_margins"] = {{{"collider", "mesh"}, {"margin_m", 0.02}}};
  const Table t = contact_rate_table(runs);
  EXPECT_EQ(t.rows[0][2], "holds at [mm]");
  EXPECT_EQ(t.rows[1][2], "20");
  EXPECT_EQ(t.rows[1].size(), t.rows[0].size());
  EXPECT_EQ(contact_rates(runs).front().held_at, "20");
}

TEST(ContactRates, AnUnfinishedStudySaysSo) {
  std::vector<RunRecord> runs = sample();
  EXPECT_EQ(contact_rate_table(runs).note.find("missing"), std::string::npos);
  runs.front().outcome.status = "missing";
  EXPECT_NE(contact_rate_table(runs).note.find("1 of 10 runs are missing"), std::string::npos);
}

TEST(ContactRates, WorstIsWhatDidNotEndThenTheLongestContour) {
  const std::vector<RunRecord> runs = sample();
  const std::vector<WorstContact> worst = worst_contacts(runs);
  ASSERT_EQ(worst.size(), 3u) << "an unsupported scene is none, a kind without a fault has none";
  EXPECT_EQ(worst[0].run->header.scene, "contact-7-sweep");
  EXPECT_EQ(worst[0].command, "clothbench study contact --seed 7 --count 1 --solver xpbd");
  EXPECT_EQ(worst[1].run->header.scene, "contact-2-desk");
  EXPECT_EQ(worst[2].run->header.scene, "contact-4-desk");
  const auto j = contact_rates_json(runs);
  EXPECT_EQ(j["worst"][0]["scene"], "contact-7-sweep");
  EXPECT_NE(contact_rates_csv(runs).find(
                "solver,setting,kind,speed_m_per_s,assets,held_at_mm,passed,drawn,unsupported,not_ended,"
                "rate_low,rate_high"),
            std::string::npos);
}

TEST(ContactRates, WithheldVerdictsAreLeftOut) {
  RunRecord c = drawn("xpbd", "sweep", 1, 0.5, "pass");
  c.withheld["expect.contact_length_max_m"] = "an older version";
  EXPECT_TRUE(contact_rates({c}).empty());
}

}  // namespace
}  // namespace clothbench
