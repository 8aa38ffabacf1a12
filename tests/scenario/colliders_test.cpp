// Scenes with colliders, on the procedural room and hand, so that the test needs no download.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "assets/assets.hpp"
#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"
#include "scenario/collider_kinds.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

class Colliders : public ::testing::Test {
 protected:
  const Variable assets_{"CLOTHBENCH_ASSETS", "procedural"};
};

double lowest(const Scene& s) {
  const auto x = initial_positions(s);
  double y = INFINITY;
  for (std::size_t i = 1; i < x.size(); i += 3) y = std::min(y, x[i]);
  return y;
}

TEST_F(Colliders, FlatDropStartsThirtyCentimetresOverTheTable) {
  const Scene s = load_scene("paper/desk-flat-low");
  EXPECT_EQ(s.assets, "procedural");
  ASSERT_EQ(s.colliders.size(), 1u);
  const ColliderMesh& m = *s.colliders[0].mesh;
  EXPECT_FALSE(m.closed);
  EXPECT_FALSE(m.skinned());
  // Highest mesh vertex below the cloth: at most 30 cm below it, to within a triangle's roughness.
  const auto x = initial_positions(s);
  double highest = -INFINITY;
  for (std::size_t v = 0; v < m.vertex_count(); ++v) {
    const double *p = m.positions.data() + 3 * v, *c = s.cloth.center_m.data();
    if (std::abs(p[0] - c[0]) < 0.2 && std::abs(p[2] - c[2]) < 0.2) highest = std::max(highest, p[1]);
  }
  EXPECT_LE(highest + 0.3, lowest(s) + 1e-12);
  EXPECT_GE(highest + 0.32, lowest(s));
  EXPECT_EQ(s.needs, (FeatureSet{Feature::Stretch, Feature::Shear, Feature::Bend, Feature::Damping, Feature::StaticMesh,
                                 Feature::Friction, Feature::DoubleSided}));
  EXPECT_TRUE(s.motion.empty());
  EXPECT_EQ(s.motion_after(0), nullptr);
  // Computed values are part of the record, and the record loads as the same scene.
  const Scene again = scene_from_json(nlohmann::json::parse(s.json), s.source);
  EXPECT_EQ(again.json, s.json);
  EXPECT_EQ(again.cloth.center_m, s.cloth.center_m);
  const Scene whole = load_scene("paper/desk-flat-low", {"colliders.0.cut=none"});
  EXPECT_EQ(whole.cloth.center_m, s.cloth.center_m);
  EXPECT_GT(whole.colliders[0].mesh->triangles.size(), m.triangles.size());
}

assets::Vector middle_of_the_table() {
  const auto room = assets::open_room(assets::locate_assets(false), "living_room");
  const auto c = assets::find_table(room, "1088a241").top_corners();
  return (c[0] + c[1] + c[2] + c[3]) / 4;
}

TEST_F(Colliders, CornerDropHangsHalfOutside) {
  const Scene s = load_scene("contact/desk-slide");
  const assets::Vector center = middle_of_the_table();
  const auto x = initial_positions(s);
  std::size_t low = 0;
  for (std::size_t v = 0; v < x.size() / 3; ++v)
    if (x[3 * v + 1] < x[3 * low + 1]) low = v;
  EXPECT_EQ(low, 0u);
  EXPECT_NEAR(x[1], center.y() + 0.3, 1e-9);
  // The lowest corner is above the middle of a long edge; the sheet is symmetric about the plane through that edge.
  const assets::Vector corner(x[0], center.y(), x[2]), out = (corner - center).normalized();
  std::size_t outside = 0, inside = 0;
  for (std::size_t v = 0; v < x.size() / 3; ++v) {
    const double f = (assets::Vector::Map(&x[3 * v]) - corner).dot(out);
    outside += f > 1e-9;
    inside += f < -1e-9;
  }
  EXPECT_EQ(outside, inside);
  EXPECT_NEAR((x[3 * (x.size() / 3 - 1) + 1] - x[1]) / (std::sqrt(2.0) * 0.5), std::sin(M_PI / 3), 1e-9);
}

TEST_F(Colliders, ACornerDropMayStartInsideTheEdge) {
  const std::string inset = "cloth.pose.over_table.inset_m=";
  const Vec3 at = load_scene("contact/desk-slide").cloth.center_m,
             in = load_scene("contact/desk-slide", {inset + "0.25"}).cloth.center_m;
  const assets::Vector was(at[0], at[1], at[2]), is(in[0], in[1], in[2]);
  EXPECT_NEAR((is - was).norm(), 0.25, 1e-9);
  EXPECT_EQ(is.y(), was.y());
  EXPECT_LT((is - middle_of_the_table()).norm(), (was - middle_of_the_table()).norm()) << "towards the table's middle";
  const auto flat = [&](const char* by) { return load_scene("paper/desk-flat-high", {inset + by}).cloth.center_m; };
  EXPECT_NEAR(std::hypot(flat("0.1")[0] - flat("0")[0], flat("0.1")[2] - flat("0")[2]), 0.1, 1e-9);
}

TEST_F(Colliders, HandsMoveFrameByFrame) {
  const Scene s = load_scene("paper/capsule-sweep");
  ASSERT_EQ(s.colliders.size(), 1u);
  EXPECT_EQ(s.colliders[0].capsules.size(), 19u);
  ASSERT_EQ(s.motion.size(), static_cast<std::size_t>(s.time.frames()) + 1);
  EXPECT_EQ(s.motion_after(-1), &s.motion.front());
  EXPECT_EQ(s.motion_after(100000), &s.motion.back());
  const auto x = [&](double t) {
    return s.motion[static_cast<std::size_t>(std::lround(t * 72))].colliders[0].capsules[0].a_m;
  };
  EXPECT_NEAR((x(1.5)[0] - x(1.75)[0]) / 0.25, 0.8, 1e-9);
  EXPECT_NEAR(x(0)[2] - x(1.25)[2], 0.15, 1e-9);
  const Scene push = load_scene("paper/hand-push");
  const ColliderMesh& m = *push.colliders[0].mesh;
  EXPECT_TRUE(m.closed);
  EXPECT_TRUE(m.skinned());
  const auto p = posed_positions(m, push.motion[0].colliders[0]), q = posed_positions(m, push.motion[144].colliders[0]);
  for (std::size_t k = 0; k < p.size(); k += 3) {
    EXPECT_NEAR(q[k] - p[k], -0.3, 1e-6);
    EXPECT_NEAR(q[k + 2] - p[k + 2], -0.4, 1e-6);
  }
}

TEST_F(Colliders, GripsFollowTheHandAndLetGo) {
  for (const auto& [name, way_m] : {std::pair{"0p5", 0.15}, {"10", 0.5}}) {
    const Scene other = load_scene(std::string("paper/two-hand-stretch-") + name + "mps");
    double farthest_m = 0;
    for (const FrameMotion& m : other.motion)
      if (m.grip_held[0] == 1) farthest_m = std::max(farthest_m, std::abs(m.grip_position_m[0][0]));
    EXPECT_NEAR(farthest_m, 0.5 + way_m, 1e-9) << name;
    EXPECT_EQ(other.motion.back().grip_held[0], 0) << name;
  }
  const Scene s = load_scene("paper/two-hand-stretch-2mps");
  EXPECT_EQ(s.grips.vertices.size(), 4u);
  EXPECT_TRUE(s.needs.has(Feature::MovingPins));
  EXPECT_FALSE(s.needs.has(Feature::Pins));
  const FrameMotion &start = s.motion.front(), &end = s.motion.back();
  const auto x = initial_positions(s);
  for (std::size_t k = 0; k < 4; ++k) {
    const double side = x[3 * s.grips.vertices[k]] < 0 ? -1 : 1;
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(start.grip_position_m[k][c], x[3 * s.grips.vertices[k] + c], 1e-12);
    EXPECT_EQ(start.grip_held[k], 1);
    EXPECT_EQ(end.grip_held[k], 0);
    EXPECT_NEAR(s.motion[60].grip_position_m[k][0], side * 0.65, 1e-9);
    EXPECT_EQ(s.motion[60].grip_held[k], 1);
  }
}

TEST_F(Colliders, ItemsOfListsCanBeOverridden) {
  EXPECT_EQ(load_scene("contact/sphere", {"colliders.0.radius_m=0.2"}).colliders[0].radius_m, 0.2);
  EXPECT_FALSE(load_scene("contact/sphere", {"colliders.0.friction=0"}).needs.has(Feature::Friction));
  for (const char* bad : {"colliders.1.radius_m=0.2", "colliders.x=1", "colliders.0.radius_m=-1", "colliders.-1={}"})
    EXPECT_THROW(load_scene("contact/sphere", {bad}), Error) << bad;
}

TEST(Kinds, TheirTypesAreThoseOfTheSchema) {
  const nlohmann::json schema = nlohmann::json::parse(kSceneSchema);
  std::set<std::string> reported, known;
  for (const auto& type : schema["properties"]["colliders"]["items"]["properties"]["type"]["enum"])
    reported.insert(type);
  for (const ColliderKind& kind : collider_kinds())
    for (const ColliderType& type : kind.types) {
      EXPECT_TRUE(known.insert(type.name).second) << type.name;
      EXPECT_TRUE(schema["definitions"].contains(std::string("collider_") + type.name)) << type.name;
    }
  EXPECT_EQ(reported, known);
}

TEST(Kinds, EveryShapeAndEveryFeatureHasOne) {
  FeatureSet required;
  for (std::size_t k = 0; k < collider_kinds().size(); ++k) {
    const ColliderKind& kind = collider_kinds()[k];
    EXPECT_EQ(static_cast<std::size_t>(kind.shape), k);
    EXPECT_NE(kind.capsules == nullptr, kind.surface == nullptr) << kind.name;
    required.add(kind.standing);
    required.add(kind.moving);
  }
  EXPECT_EQ(required, kColliderFeatures);
}

TEST(Kinds, TrianglesOfABoxAreWhereItsDistanceIsNothing) {
  Collider box;
  box.shape = Collider::Shape::Box;
  box.center_m = {0.1, 0.2, 0.3};
  box.half_extent_m = {1, 2, 3};
  box.axes = {{{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
  const ColliderKind& kind = kind_of(box);
  const ColliderSurface faces = kind.surface(box, {}, {});
  for (const auto& t : faces.triangles) {
    Vec3 middle{};
    for (const std::uint32_t v : t)
      for (std::size_t k = 0; k < 3; ++k) middle[k] += faces.positions[3 * v + k] / 3;
    EXPECT_NEAR(kind.nearest(box, middle).distance_m, 0, 1e-12);
  }
  EXPECT_EQ(faces.triangles.size(), 12u);
  EXPECT_NEAR(kind.nearest(box, box.center_m).distance_m, -1, 1e-12);
}

TEST(Geometry, MassesAddUpToDensityTimesArea) {
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {7, 5}, {33, 17}, {128, 128}}) {
    const Scene s = sheet(columns, rows, 1.5, 0.7);
    const std::vector<double> m = vertex_masses(s);
    ASSERT_EQ(m.size(), s.cloth.vertex_count());
    const double expected = 0.2 * 1.5 * 0.7;
    EXPECT_NEAR(std::accumulate(m.begin(), m.end(), 0.0), expected, 1e-12 * expected);
    EXPECT_DOUBLE_EQ(m.front(), m.back());
  }
}

TEST(Geometry, EdgesAreCompleteAndAtRest) {
  const Scene s = sheet(7, 5, 1.2, 0.8);
  const std::vector<double> x = initial_positions(s);
  const std::pair<EdgeKind, std::size_t> expected[] = {
      {EdgeKind::Structural, 6 * 5 + 7 * 4}, {EdgeKind::Shear, 2 * 6 * 4}, {EdgeKind::SkipOne, 5 * 5 + 7 * 3}};
  for (const auto& [kind, count] : expected) {
    const auto all = edges(s.cloth, kind);
    EXPECT_EQ(all.size(), count);
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    for (const Edge& e : all) {
      EXPECT_TRUE(seen.insert(std::minmax(e.a, e.b)).second) << "an edge stands twice";
      const double l =
          std::hypot(x[3 * e.a] - x[3 * e.b], x[3 * e.a + 1] - x[3 * e.b + 1], x[3 * e.a + 2] - x[3 * e.b + 2]);
      EXPECT_NEAR(l, e.rest_m, 1e-14);
    }
  }
}

TEST(Geometry, TrianglesAreWoundAlikeAndCoverTheSheet) {
  const Scene s = sheet(5, 4, 2, 1);
  const std::vector<double> x = initial_positions(s);
  double area = 0;
  for (const auto& t : triangles(s.cloth)) {
    // axis_u x axis_v = -y for this pose
    const auto d = [&](int k, int c) { return x[3 * t[k] + c] - x[3 * t[0] + c]; };
    const double ny = d(1, 2) * d(2, 0) - d(1, 0) * d(2, 2);
    EXPECT_LT(ny, 0);
    area -= ny / 2;
  }
  EXPECT_NEAR(area, 2.0, 1e-13);
}

TEST(Geometry, Sha256AgreesWithThePublishedVectors) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace clothbench
