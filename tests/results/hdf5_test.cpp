#include <gtest/gtest.h>

#include <fstream>

#include "base/files.hpp"
#include "refusal.hpp"
#include "results/hdf5_file.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Hdf5 : public WithFolder {};

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
  EXPECT_EQ(header_to_json(b.header), header_to_json(r.header));
  ASSERT_EQ(b.trials.size(), 3u);
  for (int t = 0; t < 3; ++t) EXPECT_TRUE(same(b.trials[t], r.trials[t])) << t;
  EXPECT_EQ(b.accuracy.position, r.accuracy.position);
  ASSERT_EQ(b.accuracy.metrics.size(), 2u);
  for (const MetricSeries& m : b.accuracy.metrics) {
    const MetricSeries& original = m.name == "stretch_max" ? r.accuracy.metrics[0] : r.accuracy.metrics[1];
    EXPECT_TRUE(same(m.values, original.values));
    EXPECT_EQ(m.long_name, original.long_name);
  }
  EXPECT_EQ(b.outcome.status, "diverged");
  EXPECT_EQ(b.outcome.message, r.outcome.message);
  EXPECT_EQ(b.outcome.expect, r.outcome.expect);
  EXPECT_EQ(b.summary.at("fps_median"), 123.4567890123);
  EXPECT_TRUE(std::isnan(b.summary.at("read_B_per_frame")));
  EXPECT_TRUE(read_hdf5(dir_ / "x.h5", 0).accuracy.position.empty());
}

TEST_F(Hdf5, ARunWithoutFramesIsAFileToo) {
  RunRecord r = sample_run(0);
  r.accuracy = {};
  r.header.stages.clear();
  r.outcome = {"unsupported", "ok", -1, "has no duplicated_layer"};
  write_hdf5(dir_ / "x.h5", r);
  EXPECT_EQ(read_hdf5(dir_ / "x.h5", 1).outcome.status, "unsupported");
}

TEST_F(Hdf5, TrialsOfASolverWithoutStagesAreAFileToo) {
  RunRecord r = sample_run();
  r.header.stages.clear();
  for (TimedTrial& t : r.trials) t.stage_device_s = t.stage_read_B = t.stage_write_B = {};
  write_hdf5(dir_ / "x.h5", r);
  const RunRecord b = read_hdf5(dir_ / "x.h5", 1);
  ASSERT_EQ(b.trials.size(), 3u);
  EXPECT_TRUE(same(b.trials[0], r.trials[0]));
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
  EXPECT_TRUE(fs::exists(dir_ / "another__run.h5.tmp.77")) << "another run's, maybe of a running process";
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
  RunHeader h;
  h.scene = "s";
  h.solver = "none";
  h.setting = "default";
  h.settings = h.plan = h.environment = nlohmann::json::object();
  RunWriter writer(dir_, h, Finish::Cbor);
  EXPECT_TRUE(import_runs(dir_).empty());
  const std::string part = (dir_ / "s__none__default.part").string();
  EXPECT_PRED2(mentions, refusal([&] { import_runs(part); }), part) << "a part file is not passed over in silence";
  EXPECT_EQ(import_runs(writer.finish({}, {})), std::vector<fs::path>{dir_ / "s__none__default.h5"});
  EXPECT_TRUE(fs::exists(dir_ / "s__none__default.h5"));
}

TEST_F(Hdf5, FaultsNameTheFile) {
  std::ofstream(dir_ / "not.h5") << "text";
  for (const fs::path& p : {dir_ / "not.h5", dir_ / "missing.h5"})
    EXPECT_PRED2(mentions, refusal([&] { read_run(p); }), p.filename().string());
  EXPECT_THROW(read_manifest(dir_), Error);
  EXPECT_THROW(write_hdf5(dir_ / "no" / "such" / "x.h5", sample_run()), Error);
}

}  // namespace
}  // namespace clothbench
