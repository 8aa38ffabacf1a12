#include "render/pictures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "common/gpu_solver.hpp"
#include "render/offscreen.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"
#include "solvers.hpp"
#include "with_folder.hpp"

namespace clothbench::render {
namespace {

namespace fs = std::filesystem;

/// A run of `scene` whose cloth only falls, stored and read back.
struct Stored {
  Scene scene;
  Motion read;
  AccuracyPass pass;
  Stored(const std::string& name, const std::vector<std::string>& set, const fs::path& folder)
      : scene(load_scene(name, set)) {
    const SolverEntry& entry = find_solver("ballistic");
    SolverRun run({&scene, &entry, complete_settings(entry.info, nlohmann::json::object())}, {}, "test");
    pass = whole_pass(run, scene);
    RunWriter writer(folder, run.header());
    writer.write_replay(replay_of(scene));
    writer.write_accuracy(pass);
    read = stored_motion(writer.finish(run.outcome(), {}));
  }
};

class Pictures : public WithFolder {};

TEST_F(Pictures, HaveSurfacesOfCollidersAndOfWhatHandsHold) {
  for (const char* name : {"paper/desk-flat-low", "paper/two-hand-stretch-2mps", "paper/gravity"}) {
    const Scene s = load_scene(name);
    EXPECT_EQ(surfaces(s, 0, {{-50, -50, -50}, {50, 50, 50}}).triangles.empty(), s.name == "gravity") << name;
  }
}

TEST_F(Pictures, MakesAMovieWhereFfmpegIs) {
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, dir_);
  Shots shots;
  shots.width = 161;  // odd, although movies need even sizes
  shots.height = 121;
  shots.out = dir_;
  shots.frames = {0, 2, 4};
  const Taken t = take(s.read, shots, {});
  EXPECT_EQ(t.pictures.size(), 3u);
  if (std::system("command -v ffmpeg >/dev/null") != 0) GTEST_SKIP() << "no ffmpeg";
  EXPECT_EQ(content_of(t.movie).substr(4, 4), "ftyp");
  EXPECT_EQ(t.no_movie, "");
}

TEST_F(Pictures, ShowsWhatIsNotFinite) {
  Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, dir_);
  Motion m = s.read;
  const std::size_t count = 3 * m.scene.cloth.vertex_count();
  std::fill(m.position.begin() + static_cast<std::ptrdiff_t>(2 * count), m.position.end(), NAN);
  Shots shots;
  shots.width = shots.height = 96;
  shots.out = dir_;
  shots.movie = false;
  shots.frames = {1, 2, 3};
  EXPECT_EQ(take(m, shots, {}).pictures.size(), 3u);
  std::fill(m.position.begin(), m.position.end(), NAN);  // no vertex is left to look at
  EXPECT_EQ(take(m, shots, {}).pictures.size(), 3u);
}

TEST_F(Pictures, FramesTheClothNotWhatFlewAway) {
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, dir_);
  Motion m = s.read;
  const Camera before = frame(framing_of(m).points, 1);
  m.position[3 * m.scene.cloth.vertex_count() + 1] = -1e4f;  // one vertex of frame 1
  const Camera after = frame(framing_of(m).points, 1);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(before.eye_m[k], after.eye_m[k], 0.2);
}

TEST_F(Pictures, FallsWithAClothThatNothingHolds) {
  const Stored s("paper/gravity", {"cloth.grid=[8,8]", "time.duration_s=2"}, dir_);
  const Framing f = framing_of(s.read);
  ASSERT_TRUE(f.follows);
  EXPECT_LT(f.near.diagonal(), 4 * s.scene.cloth.width_m);
}

TEST_F(Pictures, ReadsRangesOfFrames) {
  const auto list = [](const std::string& text) { return frames_from(text, 10); };
  EXPECT_EQ(list(":").size(), 10u);
  EXPECT_EQ(list("3"), (std::vector<std::size_t>{3}));
  EXPECT_EQ(list("-1"), (std::vector<std::size_t>{9}));
  EXPECT_EQ(list("2:4"), (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_EQ(list("-3:"), (std::vector<std::size_t>{7, 8, 9}));
  EXPECT_EQ(list("0:-1:4"), (std::vector<std::size_t>{0, 4, 8}));
  for (const char* bad : {"", "10", "-11", "4:2", "a", "1:b", "0:5:0", "0:5:-1", "1:2:3:4", "1.5", "3:10"})
    EXPECT_THROW(list(bad), Error) << bad;
}

TEST_F(Pictures, PicturesSurviveTheirFile) {
  Picture p(7, 3);
  for (std::size_t k = 0; k < p.rgb.size(); ++k) p.rgb[k] = static_cast<std::uint8_t>(37 * k);
  write_png(dir_ / "a.png", p);
  EXPECT_EQ(read_png(dir_ / "a.png").rgb, p.rgb);
  EXPECT_THROW(write_png(dir_ / "no" / "folder.png", p), Error);
}

const DeviceOptions kValidated = {-1, true};

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
  run.describe(with);
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

/// The vertex shader reads the positions that read_state returns.
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
