#include <gtest/gtest.h>

#include "common/gpu_solver.hpp"
#include "render/offscreen.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"

namespace clothbench::render {
namespace {

constexpr DeviceOptions kValidated = {-1, true};

TrialRules some_frames(bool rendered) {
  TrialRules r;
  r.frames = 6;
  r.warmup_s = 0;
  r.profiled_frames = 0;
  if (rendered) r.rendering = stereo_rendering(48, 40);
  return r;
}

class WithRendering : public ::testing::TestWithParam<const char*> {};

TEST_P(WithRendering, FramesAreTimedWithTheirPictures) {
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[8,8]"});
  const SolverEntry& entry = find_solver(GetParam());
  SolverRun run({&scene, &entry, complete_settings(entry.info, nlohmann::json::object())}, kValidated, "test");
  const TrialRules with = some_frames(true);
  run.describe(with.rendering);
  EXPECT_NE(run.header().environment.value("rendering", "").find("48 x 40"), std::string::npos);
  const TimedTrial t = run.run_trial(0, with, 0);
  ASSERT_EQ(run.outcome().status, "ok");
  ASSERT_EQ(t.frames(), 6);
  ASSERT_EQ(t.frame_rendered_s.size(), 6u);
  for (const double s : t.frame_rendered_s) EXPECT_GT(s, 0);
  EXPECT_TRUE(run.run_trial(1, some_frames(false), 0).frame_rendered_s.empty()) << "off unless asked";
  EXPECT_EQ(vulkan::Device::get(kValidated)->validation_messages(), 0);
}

INSTANTIATE_TEST_SUITE_P(Stereo, WithRendering, ::testing::Values("xpbd", "paper", "ballistic"));

TEST(Stereo, StopsAtTheTrialsLimit) {
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[8,8]"});
  const SolverEntry& entry = find_solver("ballistic");
  SolverRun run({&scene, &entry, complete_settings(entry.info, nlohmann::json::object())}, {}, "test");
  TrialRules rules = some_frames(true);
  rules.max_wall_s = 1e-9;
  rules.min_frames = 2;
  const TimedTrial t = run.run_trial(0, rules, 6);
  EXPECT_EQ(t.frames(), 6);
  EXPECT_EQ(t.frame_rendered_s.size(), 2u);
}

TEST(Stereo, FilesHaveTheColumnOnlyWhereAsked) {
  const Folder folder("stereo");
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[8,8]"});
  const SolverEntry& entry = find_solver("ballistic");
  for (const bool rendered : {true, false}) {
    RunSpec spec{&scene, &entry, complete_settings(entry.info, nlohmann::json::object()),
                 rendered ? "with" : "without"};
    SolverRun run(spec, {}, "test");
    RunRecord record;
    record.header = run.header();
    record.trials = {run.run_trial(0, some_frames(rendered), 0), run.run_trial(1, some_frames(rendered), 0)};
    if (rendered) record.trials[1].frame_rendered_s.resize(4);  // fewer than frames
    RunWriter writer(folder.path, run.header());
    for (const TimedTrial& t : record.trials) writer.write_trial(t);
    const auto summary = summarise(spec, run.plan(), record);
    EXPECT_EQ(summary.contains("frame_rendered_median_s"), rendered);
    const RunRecord read = read_run(writer.finish(run.outcome(), summary));
    ASSERT_EQ(read.trials.size(), 2u);
    for (std::size_t t = 0; t < 2; ++t) EXPECT_EQ(read.trials[t].frame_rendered_s, record.trials[t].frame_rendered_s);
  }
}

/// The vertex shader reads the positions that read_state gives.
TEST(Stereo, TheSolversBufferLooksAsItsState) {
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[16,16]"});
  const auto device = vulkan::Device::get(kValidated);
  int seen = 0;
  for (const SolverEntry& entry : solvers()) {
    if (!entry.info.on_gpu) continue;
    ++seen;
    const std::string& name = entry.info.name;
    const auto solver = entry.make(complete_settings(entry.info, nlohmann::json::object()), kValidated);
    solver->load(scene);
    const auto* gpu = dynamic_cast<const pbd_gpu::GpuSolver*>(solver.get());
    ASSERT_NE(gpu, nullptr);
    for (int frame = 0; frame < 10; ++frame) {
      const FrameInput input{frame, scene.time.at(frame + 1), scene.time.dt(), scene.motion_after(frame)};
      ASSERT_EQ(solver->step(input), StepStatus::Ok);
    }
    ClothState state;
    solver->read_state(state);
    SceneRenderer renderer(device, Offscreen::kFormat);
    Offscreen images(device, {96, 96}, 1);
    const Camera camera = frame(state.position, 1);
    renderer.set_cloth(scene.cloth, scene.cloth.center_m);
    renderer.write_positions(state.position);
    images.draw(renderer, std::span(&camera, 1));
    const Picture uploaded = images.read(0);
    renderer.use_positions(gpu->position_buffer(), gpu->origin_m());
    images.draw(renderer, std::span(&camera, 1));
    const Picture in_place = images.read(0);
    int different = 0, drawn = 0;
    for (std::size_t k = 0; k < uploaded.rgb.size(); ++k) {
      different += std::abs(uploaded.rgb[k] - in_place.rgb[k]) > 8 ? 1 : 0;
      drawn += uploaded.rgb[k] < 200 ? 1 : 0;
    }
    EXPECT_GT(drawn, 2000) << name;
    EXPECT_LT(different, drawn / 200) << name << ": only rounding";
  }
  EXPECT_GE(seen, 2);
  EXPECT_EQ(device->validation_messages(), 0);
}

}  // namespace
}  // namespace clothbench::render
