#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "base/files.hpp"
#include "base/json_number.hpp"
#include "refusal.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Part : public WithFolder {
 protected:
  void SetUp() override {
    WithFolder::SetUp();
    file_ = dir_ / "x.part";
    create_part(file_, run_.header);
    ends_.push_back(fs::file_size(file_));
    append("replay", to_json(run_.replay));
    for (std::size_t k = 0; k < run_.accuracy.time_s.size(); ++k) append("frame", frame_to_json(run_.accuracy, k));
    append("accuracy", to_json(run_.accuracy.metrics));
    for (const TimedTrial& t : run_.trials) append("trial", to_json(t));
  }
  void append(const char* kind, const nlohmann::json& body) {
    append_to_part(file_, kind, body);
    ends_.push_back(fs::file_size(file_));
  }
  void write(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }

  const RunRecord run_ = sample_run();
  fs::path file_;
  std::vector<std::uintmax_t> ends_;  ///< of each item
};

TEST_F(Part, IsReadAsItWasWritten) {
  const RunRecord r = read_part(file_);
  EXPECT_EQ(header_to_json(r.header), header_to_json(run_.header));
  ASSERT_EQ(r.trials.size(), 3u);
  for (std::size_t t = 0; t < 3; ++t) EXPECT_TRUE(same(r.trials[t], run_.trials[t])) << t;
  EXPECT_EQ(r.accuracy.position, run_.accuracy.position);
  EXPECT_EQ(r.accuracy.time_s, run_.accuracy.time_s);
  ASSERT_EQ(r.accuracy.metrics.size(), 2u);
  EXPECT_TRUE(same(r.accuracy.metrics[0].values, run_.accuracy.metrics[0].values));
  ASSERT_EQ(r.replay.size(), 3u);
  EXPECT_EQ(r.replay[1].attributes, run_.replay[1].attributes);
  ASSERT_EQ(r.replay[1].arrays.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(r.replay[1].arrays[k].values, run_.replay[1].arrays[k].values);
    EXPECT_EQ(r.replay[1].arrays[k].dims, run_.replay[1].arrays[k].dims);
    EXPECT_EQ(r.replay[1].arrays[k].shape, run_.replay[1].arrays[k].shape);
    EXPECT_EQ(r.replay[1].arrays[k].integer, k == 1);
  }
}

TEST_F(Part, ALaterTrialReplacesOneOfItsIndex) {
  TimedTrial again = run_.trials[1];
  again.frame_wall_s[0] = 7;
  append("trial", to_json(again));
  const RunRecord r = read_part(file_);
  ASSERT_EQ(r.trials.size(), 3u);
  EXPECT_TRUE(same(r.trials[1], again));
}

TEST_F(Part, WhatAKillCutShortIsIgnoredAndOverwritten) {
  const std::string whole = content_of(file_);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write(whole.substr(0, size));
    if (size < ends_[0]) {
      EXPECT_THROW(read_part(file_), Error) << size;
      continue;
    }
    std::uintmax_t complete = 0;
    const RunRecord r = read_part(file_, &complete);
    EXPECT_EQ(complete, *std::prev(std::upper_bound(ends_.begin(), ends_.end(), size))) << size;
    const auto items = static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), size) - ends_.begin());
    const std::size_t frames = std::min(run_.accuracy.time_s.size(), std::max<std::size_t>(items, 2) - 2);
    const std::size_t before_trials = run_.accuracy.time_s.size() + 3;
    EXPECT_EQ(r.trials.size(), std::max(items, before_trials) - before_trials);
    ASSERT_EQ(r.accuracy.time_s.size(), frames);
    EXPECT_TRUE(std::equal(r.accuracy.position.begin(), r.accuracy.position.end(), run_.accuracy.position.begin()));
  }
  const fs::path part = dir_ / (run_name(run_.header) + ".part");
  std::ofstream(part, std::ios::binary) << whole.substr(0, whole.size() - 5);
  RunWriter writer(dir_, run_.header);
  EXPECT_EQ(writer.recovered().trials.size(), 2u);
  writer.write_trial(run_.trials[2]);
  EXPECT_EQ(content_of(part), whole);
}

TEST_F(Part, FrameZeroBeginsThePassAnew) {
  append("frame", frame_to_json(run_.accuracy, 0));
  const RunRecord r = read_part(file_);
  EXPECT_EQ(r.accuracy.time_s.size(), 1u);
  EXPECT_TRUE(r.accuracy.metrics.empty());
  append("frame", frame_to_json(run_.accuracy, 2));
  EXPECT_THROW(read_part(file_), Error);
}

TEST_F(Part, ZerosAfterACrashOfTheSystemAreIgnored) {
  const std::string whole = content_of(file_);
  write(whole + std::string(100, '\0'));
  std::uintmax_t complete = 0;
  EXPECT_EQ(read_part(file_, &complete).trials.size(), 3u);
  EXPECT_EQ(complete, whole.size());
}

TEST_F(Part, DamageIsRefusedOrRead) {
  const std::string whole = content_of(file_);
  std::mt19937 random(5);
  for (int k = 0; k < 3000; ++k) {
    std::string bad = whole;
    for (int n = 0; n < 1 + k % 3; ++n) bad[random() % bad.size()] = static_cast<char>(random());
    write(bad);
    const std::string why = refusal([&] { read_part(file_); });
    EXPECT_TRUE(why.empty() || mentions(why, "x.part")) << why;
  }
  for (const char deep : {'\x81', '\xa1', '\x7f', '\x5f', '\xc0'}) {
    write(std::string(1 << 20, deep));
    EXPECT_THROW(read_part(file_), Error) << static_cast<int>(deep);
  }
}

TEST_F(Part, SeriesOfOtherLengthsAreRefused) {
  TimedTrial t = run_.trials[0];
  t.stage_read_B.pop_back();
  append("trial", to_json(t));
  EXPECT_THROW(read_part(file_), Error);
}

TEST_F(Part, InfinityIsNotMissing) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  RunRecord r = sample_run();
  r.summary = {{"a", kInfinity}, {"b", -kInfinity}, {"c", kMissing}, {"d", 0.1}};
  for (const Finish how : {Finish::Cbor, best_finish()}) {
    RunWriter writer(dir_, r.header, how);
    const std::map<std::string, double> read = read_run(writer.finish(r.outcome, r.summary)).summary;
    EXPECT_EQ(read.at("a"), kInfinity);
    EXPECT_EQ(read.at("b"), -kInfinity);
    EXPECT_TRUE(std::isnan(read.at("c")));
    EXPECT_EQ(read.at("d"), 0.1);
  }
}

TEST_F(Part, NumbersInJsonReadBack) {
  for (const double v :
       {1.0 / 3, -0.0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
    EXPECT_EQ(number_from_json(nlohmann::json::parse(number_to_json(v).dump()), "v"), v);
  EXPECT_TRUE(number_to_json(kMissing).is_null());
  EXPECT_TRUE(std::isnan(number_from_json(nlohmann::json(), "v")));
  EXPECT_PRED2(mentions, refusal([] { number_from_json("infinite", "stability_depth_max"); }), "stability_depth_max");
}

TEST_F(Part, AnotherRunsTrialsAreNotMixedIn) {
  RunRecord r = sample_run();
  RunWriter first(dir_, r.header);
  first.write_trial(r.trials[0]);
  r.header.scenario_sha256 = "11ff";
  EXPECT_THROW(RunWriter(dir_, r.header), Error);
}

TEST_F(Part, AFileThatCannotBeAppendedToStays) {
  const fs::path dir = dir_ / "runs";
  RunWriter writer(dir, run_.header);
  writer.write_trial(run_.trials[0]);
  const fs::path part = dir / (run_name(run_.header) + ".part");
  const std::string before = content_of(part);
  fs::rename(part, dir / "aside");
  fs::create_directories(part);  // even root cannot write into a folder
  EXPECT_PRED2(mentions, refusal([&] { writer.write_trial(run_.trials[1]); }), part.string());
  fs::remove(part);
  fs::rename(dir / "aside", part);
  EXPECT_EQ(content_of(part), before);
  EXPECT_EQ(writer.recovered().trials.size(), 1u);
}

}  // namespace
}  // namespace clothbench
