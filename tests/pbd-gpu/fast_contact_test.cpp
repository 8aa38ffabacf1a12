// Contact of `xpbd` at any speed: nothing passes a thin sheet.
#include "contact_scenes.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Two triangles in the plane z = `at`, 4 m wide, that a single joint carries along z.
Collider carried_wall(double at) {
  Collider c = touching(Collider::Shape::Mesh, 0);
  auto mesh = std::make_shared<ColliderMesh>();
  mesh->positions = {-2, -2, at, 2, -2, at, 2, 2, at, -2, 2, at};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh->joint_count = 1;
  for (int k = 0; k < 4; ++k) {
    mesh->joints.push_back({0, 0, 0, 0});
    mesh->weights.push_back({1, 0, 0, 0});
  }
  c.mesh = mesh;
  return c;
}

TEST_F(Gpu, NothingPassesAThinSheetHoweverFastItComes) {
  for (double metres_per_frame : {0.02, 0.3, 1.0}) {
    Scene s = two_sided(with_collider(sheet(9, 7), carried_wall(-0.11)));
    s.cloth.axis_v = {0, -1, 0};
    s.gravity_m_per_s2 = {};
    for (int k = 0; k <= 6; ++k) {
      FrameMotion& m = s.motion.emplace_back();
      m.colliders = {{{}, {{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, k * metres_per_frame}}}}}};
    }
    const auto solver = make("xpbd");
    solver->load(s);
    bool pushed = false;
    for (int f = 0; f < 6; ++f) {
      const ClothState state = after_frame(*solver, s, f);
      const double wall = -0.11 + (f + 1) * metres_per_frame;
      for (std::size_t i = 2; i < state.position.size(); i += 3) {
        ASSERT_GT(state.position[i], wall) << metres_per_frame << " m a frame, frame " << f;
        pushed = pushed || state.position[i] > 0.01;
      }
    }
    EXPECT_TRUE(pushed);
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
