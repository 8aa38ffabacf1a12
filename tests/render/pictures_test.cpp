#include "render/pictures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "results/replay.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"

namespace clothbench::render {
namespace {

namespace fs = std::filesystem;

/// A run of `scene` whose cloth only falls, stored and read again.
struct Stored {
  Scene scene;
  Motion read;
  AccuracyPass pass;
  Stored(const std::string& name, const std::vector<std::string>& set, const fs::path& folder)
      : scene(load_scene(name, set)) {
    const SolverEntry& entry = find_solver("ballistic");
    SolverRun run({&scene, &entry, complete_settings(entry.info, nlohmann::json::object())}, {}, "test");
    TrialRules rules;
    rules.accuracy_duration_s = scene.time.duration_s;
    pass = run.run_accuracy(rules);
    RunWriter writer(folder, run.header());
    writer.write_replay(replay_of(scene));
    writer.write_accuracy(pass);
    read = stored_motion(writer.finish(run.outcome(), {}));
  }
};

void expect_same(const Surfaces& a, const Surfaces& b) {
  ASSERT_EQ(a.position_m.size(), b.position_m.size());
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.look, b.look);
  for (std::size_t v = 0; v < a.position_m.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(a.position_m[v][k], b.position_m[v][k], 1e-6);
}

class Files : public ::testing::TestWithParam<const char*> {};

TEST_P(Files, HoldAllThatIsDrawn) {
  const Folder folder("album");
  const Stored s(GetParam(), {"time.duration_s=0.25"}, folder.path);
  EXPECT_EQ(s.read.frames(), static_cast<std::size_t>(s.scene.time.frames()) + 1);
  EXPECT_EQ(s.read.position, s.pass.position);
  const Bounds all{{-50, -50, -50}, {50, 50, 50}};
  for (const int frame : {0, 7, s.scene.time.frames()}) {
    const Surfaces drawn = surfaces(s.read.scene, frame, all);
    expect_same(surfaces(s.scene, frame, all), drawn);
    EXPECT_EQ(drawn.triangles.empty(), s.scene.colliders.empty() && s.scene.grips.vertices.empty());
  }
  EXPECT_EQ(s.read.scene.cloth.vertex_count(), s.scene.cloth.vertex_count());
}

INSTANTIATE_TEST_SUITE_P(Pictures, Files,
                         ::testing::Values("contact/sphere", "contact/box", "contact/plane", "paper/capsule-sweep",
                                           "paper/hand-push", "paper/desk-flat-low", "paper/two-hand-stretch-2mps",
                                           "paper/gravity", "validation/hang-mesh"));

TEST(Pictures, MakesAMovieWhereFfmpegIs) {
  const Folder folder("movie");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Shots shots;
  shots.width = 161;  // odd: a movie's are even
  shots.height = 121;
  shots.out = folder.path;
  shots.frames = {0, 2, 4};
  const Taken t = take(s.read, shots, {});
  EXPECT_EQ(t.pictures.size(), 3u);
  if (std::system("command -v ffmpeg >/dev/null") != 0) GTEST_SKIP() << "no ffmpeg";
  EXPECT_EQ(content_of(t.movie).substr(4, 4), "ftyp");
  EXPECT_EQ(t.no_movie, "");
}

TEST(Pictures, ShowsWhatIsNotFinite) {
  const Folder folder("nan");
  Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Motion m = s.read;
  const std::size_t count = 3 * m.scene.cloth.vertex_count();
  std::fill(m.position.begin() + static_cast<std::ptrdiff_t>(2 * count), m.position.end(), NAN);
  Shots shots;
  shots.width = shots.height = 96;
  shots.out = folder.path;
  shots.movie = false;
  shots.frames = {1, 2, 3};
  EXPECT_EQ(take(m, shots, {}).pictures.size(), 3u);
  std::fill(m.position.begin(), m.position.end(), NAN);  // nothing of the cloth is left to look at
  EXPECT_EQ(take(m, shots, {}).pictures.size(), 3u);
}

TEST(Pictures, FramesTheClothNotWhatFlewAway) {
  const Folder folder("frame");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Motion m = s.read;
  const Camera before = frame(framing_of(m).points, 1);
  m.position[3 * m.scene.cloth.vertex_count() + 1] = -1e4f;  // one vertex of frame 1
  const Camera after = frame(framing_of(m).points, 1);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(before.eye_m[k], after.eye_m[k], 0.2);
}

TEST(Pictures, FallsWithAClothThatNothingHolds) {
  const Folder folder("fall");
  const Stored s("paper/gravity", {"cloth.grid=[8,8]", "time.duration_s=2"}, folder.path);
  const Framing f = framing_of(s.read);
  ASSERT_TRUE(f.follows);
  EXPECT_LT(f.near.diagonal(), 4 * s.scene.cloth.width_m);
}

TEST(Pictures, ReadsRangesOfFrames) {
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

TEST(Pictures, SaysWhatItCannotDo) {
  const Folder folder("bad");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Shots shots;
  shots.out = folder.path;
  shots.frames = {999};
  EXPECT_THROW(take(s.read, shots, {}), Error);
  EXPECT_THROW(write_png(folder.path / "no" / "folder.png", Picture(2, 2)), Error);
}

TEST(Pictures, PicturesSurviveTheirFile) {
  const Folder folder("png");
  Picture p(7, 3);
  for (std::size_t k = 0; k < p.rgb.size(); ++k) p.rgb[k] = static_cast<std::uint8_t>(37 * k);
  write_png(folder.path / "a.png", p);
  EXPECT_EQ(read_png(folder.path / "a.png").rgb, p.rgb);
}

}  // namespace
}  // namespace clothbench::render
