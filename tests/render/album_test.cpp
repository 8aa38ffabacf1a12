#include "render/album.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "clothbench/error.hpp"
#include "render/legend.hpp"
#include "render/movie.hpp"
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
  Motion direct, read;
  fs::path file;
  Stored(const std::string& name, const std::vector<std::string>& set, const fs::path& folder)
      : scene(load_scene(name, set)) {
    const SolverEntry& entry = find_solver("ballistic");
    SolverRun run({&scene, &entry, complete_settings(entry.info, nlohmann::json::object())}, {}, "test");
    TrialRules rules;
    rules.accuracy_duration_s = scene.time.duration_s;
    AccuracyPass pass = run.run_accuracy(rules);
    RunWriter writer(folder, run.header());
    writer.write_replay(replay_of(scene));
    writer.write_accuracy(pass);
    file = writer.finish(run.outcome(), {});
    direct = motion_of(scene, run.header(), run.outcome(), std::move(pass));
    read = stored_motion(file);
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
  EXPECT_EQ(s.read.position, s.direct.position);
  EXPECT_EQ(s.read.title, s.direct.title);
  EXPECT_EQ(s.read.held, s.direct.held);
  const Bounds all{{-50, -50, -50}, {50, 50, 50}};
  for (const int frame : {0, 7, s.scene.time.frames()}) {
    const Surfaces drawn = surfaces(s.read.scene, frame, all);
    expect_same(surfaces(s.scene, frame, all), drawn);
    EXPECT_EQ(drawn.triangles.empty(), s.scene.colliders.empty() && s.scene.grips.vertices.empty());
  }
  EXPECT_EQ(s.read.scene.cloth.vertex_count(), s.scene.cloth.vertex_count());
  EXPECT_EQ(framing_of(s.read, std::vector<std::size_t>{0, 9}).points,
            framing_of(s.direct, std::vector<std::size_t>{0, 9}).points);
}

INSTANTIATE_TEST_SUITE_P(Album, Files,
                         ::testing::Values("contact/sphere", "contact/box", "contact/plane", "paper/capsule-sweep",
                                           "paper/hand-push", "paper/desk-flat-low", "paper/two-hand-stretch-2mps",
                                           "paper/gravity", "validation/hang-mesh"));

TEST(Album, TakesPicturesOfTheSizeAskedForWithBarAndCaption) {
  const Folder folder("shots");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Shots shots;
  shots.width = 320;
  shots.height = 240;
  shots.out = folder.path / "out";
  shots.frames = {0, 3};
  shots.movie = false;
  shots.colour = Colour::Strain;
  shots.views = {View::Front, View::Top};
  const Taken t = take(s.read, shots, {});
  ASSERT_EQ(t.pictures.size(), 4u);
  EXPECT_TRUE(t.movies.empty());
  for (const fs::path& p : t.pictures) {
    const Picture picture = read_png(p);
    EXPECT_EQ(picture.width, 320);
    EXPECT_EQ(picture.height, 240);
    const Layout l = layout_of(320, 240, false, true);
    int red = 0, blue = 0, ink = 0;
    for (int y = 0; y < l.height; ++y)
      for (int x = l.width; x < 320; ++x) {
        const std::uint8_t* c = picture.at(x, y);
        red += c[0] > c[2] + 80 ? 1 : 0;
        blue += c[2] > c[0] + 80 ? 1 : 0;
      }
    for (int y = l.height; y < 240; ++y)
      for (int x = 0; x < 320; ++x) ink += picture.at(x, y)[1] < 100 ? 1 : 0;
    EXPECT_GT(red, 50);
    EXPECT_GT(blue, 50);
    EXPECT_GT(ink, 50);
  }
  shots.plain = true;
  shots.frames = {1};
  EXPECT_EQ(read_png(take(s.read, shots, {}).pictures.at(0)).width, 320);
}

TEST(Album, MakesAMovieWhereFfmpegIs) {
  const Folder folder("movie");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Shots shots;
  shots.width = 161;  // odd: a movie's are even
  shots.height = 121;
  shots.out = folder.path;
  shots.frames = {0, 2, 4};
  const Taken t = take(s.read, shots, {});
  EXPECT_EQ(t.pictures.size(), 3u);
  if (Movie::possible()) {
    ASSERT_EQ(t.movies.size(), 1u);
    std::ifstream in(t.movies[0], std::ios::binary);
    std::string head(12, '\0');
    in.read(head.data(), 12);
    EXPECT_EQ(head.substr(4, 4), "ftyp");
    EXPECT_EQ(t.no_movie, "");
  } else {
    EXPECT_TRUE(t.movies.empty());
    EXPECT_NE(t.no_movie.find("ffmpeg"), std::string::npos);
  }
}

TEST(Album, ShowsWhatIsNotFinite) {
  const Folder folder("nan");
  Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Motion m = s.read;
  const std::size_t count = 3 * m.scene.cloth.vertex_count();
  std::fill(m.position.begin() + static_cast<std::ptrdiff_t>(2 * count), m.position.end(), NAN);
  Shots shots;
  shots.width = shots.height = 96;
  shots.out = folder.path;
  shots.movie = false;
  for (const Colour c : {Colour::Checker, Colour::Strain, Colour::Depth}) {
    shots.colour = c;
    shots.frames = {1, 2, 3};
    shots.plain = true;
    EXPECT_EQ(take(m, shots, {}).pictures.size(), 3u);
    shots.frames = {3};  // nothing of the cloth is left to look at
    EXPECT_EQ(take(m, shots, {}).pictures.size(), 1u);
  }
}

TEST(Album, FramesTheClothNotWhatFlewAway) {
  const Folder folder("frame");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Motion m = s.read;
  const std::vector<std::size_t> frames = {0, 1, 2};
  const Camera before = frame(View::Corner, framing_of(m, frames).points, 1);
  m.position[3 * m.scene.cloth.vertex_count() + 1] = -1e4f;  // one vertex of frame 1
  const Camera after = frame(View::Corner, framing_of(m, frames).points, 1);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(before.eye_m[k], after.eye_m[k], 0.2);
}

TEST(Album, FallsWithAClothThatNothingHolds) {
  const Folder folder("fall");
  const Stored s("paper/gravity", {"cloth.grid=[8,8]", "time.duration_s=2"}, folder.path);
  const std::vector<std::size_t> frames = {0, 144};
  const Framing f = framing_of(s.read, frames);
  ASSERT_TRUE(f.followed.has_value());
  EXPECT_LT(f.near.diagonal(), 4 * s.scene.cloth.width_m);
  EXPECT_FALSE(framing_of(s.read, std::vector<std::size_t>{0, 1}).followed.has_value());
}

/// A sheet that stands upright, one metre to each side of the origin of its lower edge, with the scene's box where it
/// is wanted.
Motion upright(const Vec3& box_m) {
  Motion m;
  m.scene = load_scene("contact/box", {"cloth.grid=[17,17]"});
  m.scene.colliders[0].center_m = box_m;
  m.held = true;
  m.time_s = {0, 1};
  for (int frame = 0; frame < 2; ++frame)
    for (int j = 0; j < 17; ++j)
      for (int i = 0; i < 17; ++i)
        for (const double x : {i / 8.0 - 1, j / 8.0, 0.0}) m.position.push_back(static_cast<float>(x));
  return m;
}

TEST(Album, GoesRoundWhatHidesTheCloth) {
  const std::vector<std::size_t> frames = {0, 1};
  const Bounds near{{-9, -9, -9}, {9, 9, 9}};
  EXPECT_EQ(best_turn(upright({0, -2, 0}), frames, near), 0) << "nothing is in the way";
  const Vec3 eye = towards_eye(View::Corner, 0);
  Motion hidden = upright({2 * eye[0], 1 + 2 * eye[1], 2 * eye[2]});
  for (double& half : hidden.scene.colliders[0].half_extent_m) half = 1.3;
  const double turn = best_turn(hidden, frames, near);
  EXPECT_NE(turn, 0) << "the box stands where the camera would";
  EXPECT_LT(towards_eye(View::Corner, turn)[0] * eye[0] + towards_eye(View::Corner, turn)[2] * eye[2], 0.5);
  hidden.scene.motion.resize(1);
  EXPECT_EQ(best_turn(hidden, frames, near), 0) << "dynamic colliders are viewed from the front";
}

TEST(Album, FramesOneFrameAsItsWholeMotion) {
  Motion m = upright({0, -2, 0});
  EXPECT_EQ(framed_by(m, std::vector<std::size_t>{0}), (std::vector<std::size_t>{0, 1}));
  m.held = false;
  EXPECT_EQ(framed_by(m, std::vector<std::size_t>{0}), (std::vector<std::size_t>{0}));
}

TEST(Album, ReadsRangesOfFrames) {
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

TEST(Album, SaysWhatItCannotDo) {
  const Folder folder("bad");
  const Stored s("contact/sphere", {"cloth.grid=[9,9]", "time.duration_s=0.1"}, folder.path);
  Shots shots;
  shots.out = folder.path;
  shots.frames = {999};
  EXPECT_THROW(take(s.read, shots, {}), Error);
  shots.frames = {0};
  shots.width = shots.height = 40;
  EXPECT_THROW(take(s.read, shots, {}), Error) << "no room beside the text";
  EXPECT_THROW(write_png(folder.path / "no" / "folder.png", Picture(2, 2, 0)), Error);
  EXPECT_THROW(read_png(folder.path / "none.png"), Error);
  std::ofstream(folder.path / "text.png") << "not a picture";
  EXPECT_THROW(read_png(folder.path / "text.png"), Error);
}

TEST(Album, PicturesSurviveTheirFile) {
  const Folder folder("png");
  Picture p(7, 3, 0);
  for (std::size_t k = 0; k < p.rgb.size(); ++k) p.rgb[k] = static_cast<std::uint8_t>(37 * k);
  write_png(folder.path / "a.png", p);
  EXPECT_EQ(read_png(folder.path / "a.png").rgb, p.rgb);
  Picture q(4, 4, 255);
  q.put(p, 2, -1);
  EXPECT_EQ(q.at(2, 0)[0], p.at(0, 1)[0]);
  EXPECT_EQ(q.at(3, 1)[2], p.at(1, 2)[2]);
  EXPECT_EQ(q.at(2, 2)[0], 255);
}

}  // namespace
}  // namespace clothbench::render
