// One collider of each shape against numbers computed here.
#include "metrics/collider_contact.hpp"

#include <gtest/gtest.h>

#include "metrics/contact/triangle_mesh.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

SceneContact at_height(const Scene& scene, double y) {
  std::vector<double> x = initial_positions(scene);
  for (std::size_t k = 1; k < x.size(); k += 3) x[k] = y;
  return collider_contact(scene)->probe(0, x);
}

TEST(ColliderContact, ABoxIsSolidWhicheverWayItIsTurned) {
  // A horizontal 0.6 m sheet 1 cm below the top of a 0.3 m box; then with the box rotated about the vertical.
  for (const char* turn :
       {"colliders.0.rotation_deg=[0,0,0]", "colliders.0.rotation_deg=[0,30,0]", "colliders.0.rotation_deg=[90,0,0]"}) {
    const Scene scene = load_scene("contact/box", {"cloth.grid=[61,61]", turn});
    const SceneContact s = at_height(scene, 0.14);
    EXPECT_NEAR(s.length_m, 1.2, 1e-9) << turn;
    EXPECT_NEAR(s.depth_m, 0.01, 1e-12) << turn;
    EXPECT_EQ(at_height(scene, 0.151).length_m, 0) << turn;
    EXPECT_EQ(at_height(scene, 0.151).depth_m, 0) << turn;
  }
}

TEST(ColliderContact, CapsulesAreWhereTheirFrameHasThem) {
  const Scene scene = load_scene("paper/capsule-sweep", {"cloth.grid=[17,17]"});
  const std::vector<double> x = initial_positions(scene);
  const auto contact = collider_contact(scene);
  int inside = 0;
  for (int frame = 0; frame <= scene.time.frames(); ++frame) {
    const SceneContact s = contact->probe(frame, x);
    double deepest = 0;
    for (std::size_t v = 0; v < x.size(); v += 3)
      for (const Capsule& c : scene.motion[static_cast<std::size_t>(frame)].colliders[0].capsules) {
        const contact::Capsule shape{contact::Point<3>::Map(c.a_m.data()), contact::Point<3>::Map(c.b_m.data()),
                                     c.radius_m};
        deepest = std::max(deepest, -contact::signed_distance(contact::Point<3>::Map(&x[v]), shape));
      }
    EXPECT_GE(s.depth_m, deepest * (1 - 1e-12)) << "frame " << frame << ": no vertex is deeper";
    EXPECT_LE(s.depth_m, deepest + 0.04) << "frame " << frame << ": half a diagonal of a cell of 1/16 m";
    inside += deepest > 0;
  }
  EXPECT_GT(inside, 10) << "the test needs a hand that touches the cloth";
}

TEST(ColliderContact, SeveralCollidersAddUp) {
  const Scene one = load_scene("contact/sphere", {"cloth.grid=[33,33]"});
  const Scene two = load_scene("contact/sphere", {"cloth.grid=[33,33]", R"(colliders=[
    {"type":"sphere","center_m":[-0.15,0,0],"radius_m":0.1},{"type":"sphere","center_m":[0.15,0.02,0],"radius_m":0.1}])"});
  const auto single = [](const char* centre, double y) {
    return at_height(load_scene("contact/sphere", {"cloth.grid=[33,33]", "colliders.0.radius_m=0.1", centre}), y);
  };
  const SceneContact left = single("colliders.0.center_m=[-0.15,0,0]", 0.09),
                     right = single("colliders.0.center_m=[0.15,0.02,0]", 0.09);
  const SceneContact both = at_height(two, 0.09);
  EXPECT_NEAR(both.length_m, left.length_m + right.length_m, 1e-12);
  EXPECT_EQ(both.depth_m, right.depth_m);
}

}  // namespace
}  // namespace clothbench
