#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "refusal.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Hdf5 : public WithFolder {};

/// Header, trials, positions and metrics; a file of HDF5 sorts its metrics by name.
void expect_same(const RunRecord& read, const RunRecord& written) {
  EXPECT_EQ(header_to_json(read.header), header_to_json(written.header));
  ASSERT_EQ(read.trials.size(), written.trials.size());
  for (std::size_t t = 0; t < read.trials.size(); ++t) EXPECT_TRUE(same(read.trials[t], written.trials[t])) << t;
  EXPECT_EQ(read.accuracy.position, written.accuracy.position);
  EXPECT_EQ(read.accuracy.time_s, written.accuracy.time_s);
  ASSERT_EQ(read.accuracy.metrics.size(), 2u);
  for (const MetricSeries& m : read.accuracy.metrics) {
    const MetricSeries& original = written.accuracy.metrics[m.name == "stretch_max" ? 0 : 1];
    EXPECT_TRUE(same(m.values, original.values));
    EXPECT_EQ(m.long_name, original.long_name);
  }
}

TEST_F(Hdf5, CpuTimesAreStoredOnlyIfThereAreAny) {
  RunRecord r = sample_run();
  for (TimedTrial& t : r.trials) t.frame_cpu_s.clear();  // GPU solvers
  write_hdf5(dir_ / "gpu.h5", r);
  write_hdf5(dir_ / "host.h5", sample_run());
  EXPECT_EQ(content_of(dir_ / "gpu.h5").find("frame_cpu_s"), std::string::npos) << "stored only where there are any";
  EXPECT_NE(content_of(dir_ / "host.h5").find("frame_cpu_s"), std::string::npos);
  for (const TimedTrial& t : read_hdf5(dir_ / "gpu.h5", 0).trials) EXPECT_TRUE(t.frame_cpu_s.empty());
}

TEST_F(Hdf5, RoundTrip) {
  RunRecord r = sample_run();
  r.trials[2].frame_wall_s.resize(3);  // a trial may stop early
  r.trials[2].frame_cpu_s.resize(3);
  r.trials[2].frame_device_s.resize(3);
  for (auto* s : {&r.trials[2].stage_device_s, &r.trials[2].stage_read_B, &r.trials[2].stage_write_B}) s->resize(6);
  write_hdf5(dir_ / "x.h5", r);
  const RunRecord b = read_hdf5(dir_ / "x.h5", 1);
  expect_same(b, r);
  EXPECT_EQ(b.outcome.status, "diverged");
  EXPECT_EQ(b.outcome.message, r.outcome.message);
  EXPECT_EQ(b.outcome.expect, r.outcome.expect);
  EXPECT_EQ(b.summary.at("fps_median"), 123.4567890123);
  EXPECT_TRUE(std::isnan(b.summary.at("read_B_per_frame")));
  EXPECT_TRUE(read_hdf5(dir_ / "x.h5", 0).accuracy.position.empty());
}

TEST_F(Hdf5, RunsWithoutStagesOrWithoutFramesAreFilesToo) {
  RunRecord r = sample_run();
  r.header.stages.clear();
  for (TimedTrial& t : r.trials) t.stage_device_s = t.stage_read_B = t.stage_write_B = {};
  write_hdf5(dir_ / "x.h5", r);
  expect_same(read_hdf5(dir_ / "x.h5", 1), r);
  r.trials.clear();
  r.accuracy = {};
  r.outcome = {"unsupported", "ok", -1, "has no duplicated_layer"};
  write_hdf5(dir_ / "y.h5", r);
  EXPECT_EQ(read_hdf5(dir_ / "y.h5", 1).outcome.status, "unsupported");
}

TEST_F(Hdf5, SomeFramesAreThoseOfTheWholeMotion) {
  const RunRecord r = sample_run();
  write_hdf5(dir_ / "x.h5", r);
  const Replay some = read_replay(dir_ / "x.h5", 3);
  EXPECT_EQ(some.frames, (std::vector<std::size_t>{0, 3, 4}));
  const std::size_t row = 3 * r.header.vertices;
  for (std::size_t k = 0; k < some.frames.size(); ++k) {
    EXPECT_EQ(some.time_s[k], r.accuracy.time_s[some.frames[k]]);
    for (std::size_t i = 0; i < row; ++i)
      EXPECT_EQ(some.position[k * row + i], r.accuracy.position[some.frames[k] * row + i]);
  }
  EXPECT_EQ(some.groups.size(), r.replay.size());
  RunWriter writer(dir_, r.header, Finish::Cbor);
  writer.write_replay(r.replay);
  writer.write_accuracy(r.accuracy);
  EXPECT_EQ(read_replay(writer.finish({}, {}), 3).position, some.position);
}

TEST_F(Hdf5, WhatAKilledRunLeftIsRemovedAndNothingElse) {
  const RunRecord r = sample_run();
  const std::string run = run_name(r.header);
  RunWriter writer(dir_, r.header);
  writer.write_trial(r.trials[0]);
  for (const fs::path& litter : {dir_ / (run + ".part.tmp.77"), dir_ / (run + ".h5.tmp.77"),
                                 dir_ / (run + ".xdmf.tmp.77"), dir_ / "another__run.h5.tmp.77"})
    std::ofstream(litter) << "half";
  remove_leftovers(dir_, run);
  for (const char* kind : {".part.tmp.77", ".h5.tmp.77", ".xdmf.tmp.77"}) EXPECT_FALSE(fs::exists(dir_ / (run + kind)));
  EXPECT_TRUE(fs::exists(dir_ / "another__run.h5.tmp.77")) << "it belongs to another run, whose process may be alive";
  EXPECT_EQ(writer.recovered().trials.size(), 1u) << "a finished trial stays";
  // Killed between the rename of the file and the removal of its part file.
  write_hdf5(dir_ / (run + ".h5"), r);
  remove_leftovers(dir_, run);
  EXPECT_FALSE(fs::exists(dir_ / (run + ".part")));
  EXPECT_TRUE(fs::exists(dir_ / (run + ".h5")));
}

TEST_F(Hdf5, SameRunSameBytesAlsoThroughCbor) {
  const RunRecord r = sample_run();
  write_hdf5(dir_ / "direct.h5", r);
  write_hdf5(dir_ / "again.h5", r);
  EXPECT_EQ(content_of(dir_ / "direct.h5"), content_of(dir_ / "again.h5"));
  for (const Finish how : {Finish::Hdf5, Finish::Cbor}) {
    const fs::path dir = dir_ / (how == Finish::Hdf5 ? "host" : "phone");
    RunWriter writer(dir, r.header, how);
    for (const TimedTrial& t : r.trials) writer.write_trial(t);
    writer.write_accuracy(r.accuracy);
    writer.write_replay(r.replay);
    fs::path file = writer.finish(r.outcome, r.summary);
    if (how == Finish::Cbor) file = import_runs(dir).at(0);
    EXPECT_EQ(content_of(file), content_of(dir_ / "direct.h5"));
  }
}

TEST_F(Hdf5, AnUnfinishedRunIsNotImported) {
  const RunHeader h = sample_run().header;
  RunWriter writer(dir_, h, Finish::Cbor);
  EXPECT_TRUE(import_runs(dir_).empty());
  const fs::path part = dir_ / (run_name(h) + ".part"), file = dir_ / (run_name(h) + ".h5");
  EXPECT_PRED2(mentions, refusal([&] { import_runs(part); }), part.string()) << "a part file is not ignored silently";
  EXPECT_EQ(import_runs(writer.finish({}, {})), std::vector<fs::path>{file});
  EXPECT_TRUE(fs::exists(file));
}

TEST_F(Hdf5, FaultsNameTheFile) {
  std::ofstream(dir_ / "not.h5") << "text";
  for (const fs::path& p : {dir_ / "not.h5", dir_ / "missing.h5"})
    EXPECT_PRED2(mentions, refusal([&] { read_run(p); }), p.filename().string());
  EXPECT_THROW(read_manifest(dir_), Error);
  EXPECT_THROW(write_hdf5(dir_ / "no" / "such" / "x.h5", sample_run()), Error);
}

class Part : public WithFolder {
 protected:
  void SetUp() override {
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
  expect_same(r, run_);
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
  for (const double v : {1.0 / 3, -0.0})
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
