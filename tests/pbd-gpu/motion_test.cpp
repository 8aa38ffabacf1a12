// Dynamic input: upload, skinning and attached vertices.

#include "contact_scenes.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Reads back colliders: the content that solvers find in their buffers during a frame.
class Mirror final : public GpuSolver {
 public:
  Mirror(bool as_convex_shapes, Vec3 origin)
      : GpuSolver(paper_info(), complete_settings(paper_info(), nlohmann::json::object()), {-1, true}),
        as_convex_shapes_(as_convex_shapes),
        origin_(origin) {}
  template <class T>
  const T* seen(std::size_t k) const {
    return static_cast<const T*>(hosts_.at(k)->mapped());
  }
  const MeshBuffers& hands() { return colliders()->kinematic_meshes; }

 private:
  void build() override {
    const int stage = add_stage("Mirror", {});
    add_colliders(origin_, as_convex_shapes_);
    add_state(initial_positions(scene()), inverse_masses(scene()), {}, 1);
    sources_ = {colliders()->capsules.buffer, colliders()->kinematic_meshes.positions};
    if (as_convex_shapes_) sources_.push_back(colliders()->kinematic_meshes.start_positions);
    for (const vulkan::Buffer* b : sources_) hosts_.push_back(&add_host_buffer(b->name(), b->bytes()));
    stage_ = stage;
  }
  void record_frame(double, double) override {
    colliders()->record();
    for (std::size_t k = 0; k < sources_.size(); ++k) copy(stage_, *sources_[k], *hosts_[k]);
  }

  const bool as_convex_shapes_;
  const Vec3 origin_;
  int stage_ = -1;
  std::vector<const vulkan::Buffer*> sources_;
  std::vector<const vulkan::Buffer*> hosts_;
};

Scene hands() {
  Scene s = with_collider(sheet(3, 3), octahedron({0.3, 0.2, -0.1}, 0.06, true));
  s = with_collider(s, sphere({0, 0, 0}, 0.1));
  s = with_collider(s, capsules({0.1, 0.2, 0.3}, 0.25));
  return moving(with_collider(s, octahedron({-0.4, 0, 0.7}, 0.1, true)));
}

void expect_mesh(const vec4* seen, const Scene& s, const MeshBuffers& buffers, std::size_t instant,
                 const Vec3& origin) {
  for (const MeshRange& r : buffers.ranges) {
    const std::vector<double> x =
        posed_positions(*s.colliders[r.collider].mesh, s.motion[instant].colliders[r.collider]);
    for (std::size_t v = 0; v < r.vertices; ++v) {
      const vec4& at = seen[r.first_vertex + v];
      EXPECT_NEAR(at.x, x[3 * v] - origin[0], 1e-6) << "instant " << instant << " vertex " << v;
      EXPECT_NEAR(at.y, x[3 * v + 1] - origin[1], 1e-6);
      EXPECT_NEAR(at.z, x[3 * v + 2] - origin[2], 1e-6);
    }
  }
}

TEST_F(Gpu, HandsAreSkinnedAndCapsulesArriveRelativeToTheOrigin) {
  const Scene s = hands();
  const Vec3 origin = {0.25, -0.5, 0.125};
  for (bool as_convex_shapes : {false, true}) {
    Mirror mirror(as_convex_shapes, origin);
    mirror.load(s);
    ASSERT_EQ(mirror.hands().ranges.size(), 2u);
    EXPECT_EQ(mirror.hands().ranges[1].collider, 3u);
    for (int lap = 0; lap < 2; ++lap, mirror.reset())
      for (std::size_t f = 0; f < 4; ++f) {
        after_frame(mirror, s, static_cast<int>(f));
        expect_mesh(mirror.seen<vec4>(1), s, mirror.hands(), f + 1, origin);
        if (as_convex_shapes) expect_mesh(mirror.seen<vec4>(2), s, mirror.hands(), f, origin);
        const auto* capsule = mirror.seen<CapsuleShape>(0);
        for (std::size_t k = 0; k < 2; ++k) {
          const Capsule &start = s.motion[f].colliders[2].capsules[k], &end = s.motion[f + 1].colliders[2].capsules[k];
          EXPECT_NEAR(capsule[k].a0.x, start.a_m[0] - origin[0], 1e-6) << f;
          EXPECT_NEAR(capsule[k].b0.y, start.b_m[1] - origin[1], 1e-6) << f;
          EXPECT_NEAR(capsule[k].a1.x, end.a_m[0] - origin[0], 1e-6) << f;
          EXPECT_NEAR(capsule[k].b1.z, end.b_m[2] - origin[2], 1e-6) << f;
          EXPECT_FLOAT_EQ(capsule[k].a0.w, static_cast<float>(end.radius_m));
          EXPECT_FLOAT_EQ(capsule[k].a1.w, static_cast<float>(end.radius_m + 0.02));
          EXPECT_FLOAT_EQ(capsule[k].b0.w, 0.02f);
          EXPECT_FLOAT_EQ(capsule[k].b1.w, 0.25f);
        }
      }
  }
}

TEST_F(Gpu, HeldVerticesFollowTheHandAndDragTheRest) {
  for (int substeps : {1, 3})
    for (bool two_layers : {false, true}) {
      Scene s = moving(with_damping(sheet(9, 7)), {0, 9, 62});
      if (two_layers) s = doubled(s);
      const auto solver = make("paper", {{"substeps", substeps}});
      solver->load(s);
      const std::vector<double> rest = initial_positions(s);
      for (int lap = 0; lap < 2; ++lap, solver->reset())
        for (int f = 0; f < 10; ++f) {
          const ClothState state = after_frame(*solver, s, f);
          for (std::size_t g = 0; g < s.grips.vertices.size(); ++g)
            for (std::size_t k = 0; k < 3; ++k) {
              const std::size_t at = 3 * s.grips.vertices[g] + k;
              const FrameMotion &now = s.motion[static_cast<std::size_t>(f) + 1],
                                &before = s.motion[static_cast<std::size_t>(f)];
              EXPECT_EQ(static_cast<float>(state.position[at]), static_cast<float>(now.grip_position_m[g][k])) << f;
              EXPECT_NEAR(state.velocity[at], (now.grip_position_m[g][k] - before.grip_position_m[g][k]) / s.time.dt(),
                          1e-4);
            }
          if (f == 9) {
            EXPECT_GT(state.position[3 * 10] - rest[3 * 10], 0.02) << "a neighbour is dragged along";
          }
        }
    }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
