// Contact of `xpbd`: kernels against double precision, nothing through however fast, friction, what is left out.
#include "xpbd_contact.hpp"

#include <algorithm>
#include <numbers>
#include <set>

#include "contact_scenes.hpp"
#include "runner/stage_check.hpp"
#include "xpbd_contact_reference.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// A sheet so soft that nothing but contact moves its vertices: 1e-12 N/m against grams of mass.
Scene loose(Scene s) {
  s.material.membrane_stiffness_N_per_m = 1e-12;
  return s;
}

Collider plane(Vec3 point, Vec3 normal, double friction = 0) {
  Collider c = touching(Collider::Shape::Plane, friction);
  c.center_m = point;
  c.normal = normal;
  return c;
}

Scene two_sided(Scene s) {
  s.cloth.sides = Sides::Double;
  s.needs = s.needs - FeatureSet{Feature::DuplicatedLayer};
  s.needs.add(Feature::DoubleSided);
  return s;
}

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

Scene falling(int columns, int rows) {
  Scene s = loose(sheet(columns, rows));
  s.cloth.center_m = {0, 0.16, 0};
  s.cloth.initial_velocity_m_per_s = {0.4, -3, 0.3};
  return s;
}

void expect_close(const Scene& s, int substeps, int samples, int frames, const std::string& what) {
  ContactReference reference(s, substeps, static_cast<int>(samples_needed(s, static_cast<std::uint32_t>(samples))));
  std::vector<std::unique_ptr<GpuSolver>> solvers;
  for (const int lanes : {1, 8})
    solvers
        .emplace_back(make_xpbd(complete_settings(xpbd_info(), {{"substeps", substeps},
                                                                {"contact_samples", samples},
                                                                {"tuning", {{"contact_lanes", lanes}}}}),
                                {-1, true}))
        ->load(s);
  std::vector<ClothState> states(solvers.size());
  for (int f = 0; f < frames; ++f) {
    reference.frame(f);
    for (std::size_t k = 0; k < solvers.size(); ++k) states[k] = after_frame(*solvers[k], s, f);
  }
  EXPECT_GT(reference.active_contacts, 0) << what;
  for (const ClothState& state : states)
    for (std::size_t i = 0; i < reference.x.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(state.position[3 * i + k], reference.x[i][static_cast<long>(k)], 1e-5) << what << " vertex " << i;
        EXPECT_NEAR(state.velocity[3 * i + k], reference.v[i][static_cast<long>(k)], 1e-3) << what << " vertex " << i;
      }
}

TEST_F(Gpu, ContactAgreesWithDoublePrecisionKindByKind) {
  for (double friction : {0.0, kContactFriction}) {
    const std::vector<std::pair<std::string, Collider>> kinds = {
        {"plane", plane({0, 0.05, 0}, {0.6, 0.8, 0}, friction)},
        {"small sphere", sphere({0.02, 0.04, 0.03}, 0.09, friction)},
        {"sphere", sphere({0.02, 0.01, 0.03}, 0.13, friction)},
        {"box", box({0.03, 0.01, 0.01}, {0.3, 0.07, 0.2}, friction)},
        {"capsules", capsules({0, 0.04, 0}, friction)},
        {"mesh", octahedron({0.013, 0.017, 0.021}, 0.12, false, friction)},
        {"hand", octahedron({0.013, 0.017, 0.021}, 0.12, true, friction)},
        {"open sheet", open_sheet({0.03, 0.1, 0.01}, 0.32, friction)}};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind)
      for (std::size_t samples : {0, 1, 2})
        if (const auto& [name, collider] = kinds[kind]; in_turn(kind + samples))
          expect_close(moving(with_collider(falling(9, 7), collider)), 4, static_cast<int>(samples), 3,
                       name + " friction " + std::to_string(friction) + " samples " + std::to_string(samples));
  }
}

TEST_F(Gpu, ContactWithEverythingAtOnceRepeatsBitForBit) {
  Scene s = two_sided(everything(with_pins(sheet(17, 13))));
  s = with_collider(s, plane({0, -0.2, 0}, {0, 1, 0}, kContactFriction));
  s.motion.clear();
  s = moving(s);
  const auto one = make("xpbd"), two = make("xpbd");
  one->load(s);
  two->load(s);
  EXPECT_EQ(check_stages(s, one->info(), one->plan()), "");
  const ClothState a = after(*one, s, 20), b = after(*two, s, 20);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  one->reset();
  const ClothState again = after(*one, s, 20);
  EXPECT_EQ(a.position, again.position) << "reset restores the colliders, the sides and the candidates too";
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

TEST_F(Gpu, AFastSheetStopsAtAThinMeshFromEitherSide) {
  for (double direction : {-1.0, 1.0}) {
    Scene s = two_sided(with_collider(sheet(9, 7), open_sheet({0, 0, 0}, 1.5)));
    s.cloth.center_m = {0, -0.1 * direction, 0};
    s.cloth.initial_velocity_m_per_s = {0, 60 * direction, 0};
    const auto solver = make("xpbd");
    solver->load(s);
    for (int f = 0; f < 10; ++f) {
      const ClothState state = after_frame(*solver, s, f);
      // The mesh rises by 1 cm from one corner to the other.
      for (std::size_t i = 0; i < state.position.size(); i += 3) ASSERT_LT(direction * state.position[i + 1], 0.011);
    }
  }
}

TEST_F(Gpu, ClothHoldsOnAnInclineUpToTheAngleOfFrictionAndSlidesBeyond) {
  const double friction = 0.5, g = 9.81, T = 0.5;
  for (const auto& [share, samples] : {std::pair{0.98, false}, {1.1, false}, {0.98, true}, {1.1, true}}) {
    const double angle = std::atan(share * friction), sine = std::sin(angle), cosine = std::cos(angle);
    Scene s = with_collider(sheet(5, 5, 0.4, 0.4), plane({0, 0, 0}, {sine, cosine, 0}, friction));
    // A box far away: edges might pass into it, so there are samples.
    if (samples) s = with_collider(s, box({9, 9, 9}, {1, 1, 1}, friction));
    s.cloth.axis_u = {cosine, -sine, 0};
    s.cloth.center_m = {0.02 * sine, 0.02 * cosine, 0};
    const auto solver = make("xpbd");
    solver->load(s);
    const ClothState state = after(*solver, s, 36);
    const std::vector<double> start = initial_positions(s);
    for (std::size_t i = 0; i < start.size(); i += 3) {
      const double slid = cosine * (state.position[i] - start[i]) - sine * (state.position[i + 1] - start[i + 1]);
      const double expected = std::max(0.0, 0.5 * g * (sine - friction * cosine) * T * T);
      EXPECT_NEAR(slid, expected, std::max(1e-5, 0.02 * expected))
          << "tangent " << share << " of the friction, samples " << samples;
    }
  }
}

TEST_F(Gpu, HeldVerticesPassAndFreeOnesDoNot) {
  Scene s = moving(two_sided(with_collider(sheet(9, 7), sphere({0.2, -0.15, 0}, 0.1))), {0, 8}, 4);
  const auto solver = make("xpbd");
  solver->load(s);
  EXPECT_EQ(check_stages(s, solver->info(), solver->plan()), "");
  for (int f = 0; f < 20; ++f) {
    const ClothState state = after_frame(*solver, s, f);
    for (std::size_t k = 0; k < 2 && f < 4; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(state.position[3 * s.grips.vertices[k] + axis],
                    s.motion[static_cast<std::size_t>(f) + 1].grip_position_m[k][axis], 1e-6);
    for (std::size_t i = 0; i < state.position.size(); i += 3)
      EXPECT_GT(std::hypot(state.position[i] - 0.2, state.position[i + 1] + 0.15, state.position[i + 2]), 0.1);
  }
}

TEST_F(Gpu, ContactIsLeftOutPieceByPiece) {
  struct Case {
    Scene scene;
    std::set<std::string> kernels;
    bool meshes;
  };
  const Scene plain = sheet(5, 4);
  const std::vector<Case> cases = {
      {plain, {}, false},
      {with_collider(plain, plane({0, -0.2, 0}, {0, 1, 0})), {"contact_vertices"}, false},
      {with_collider(plain, sphere({0, -9, 0}, 8)), {"contact_vertices"}, false},
      {with_collider(plain, sphere({0, -0.2, 0}, 0.1)), {"contact_samples", "contact_vertices"}, false},
      {moving(with_collider(plain, capsules({0, -0.2, 0}))), {"contact_samples", "contact_vertices"}, false},
      {with_collider(plain, open_sheet({0, -0.2, 0}, 0.1)),
       {"contact_candidates", "contact_samples_mesh", "contact_vertices_mesh"},
       true},
      {moving(with_collider(plain, octahedron({0, -0.2, 0}, 0.1, true))),
       {"skin_mesh_keep_start", "contact_boxes", "contact_candidates", "contact_samples_mesh", "contact_vertices_mesh"},
       true}};
  for (const Case& c : cases) {
    const auto solver = make("xpbd", {{kTuning, {{"contact", "samples"}}}});
    solver->load(c.scene);
    std::set<std::string> kernels;
    for (const auto& r : solver->frame_program().recorded())
      if (r.kernel != nullptr && (r.kernel->name().starts_with("contact") || r.kernel->name().starts_with("skin")))
        kernels.insert(r.kernel->name());
    EXPECT_EQ(kernels, c.kernels);
    EXPECT_EQ(check_stages(c.scene, solver->info(), solver->plan()), "");
    for (const BufferPlan& b : solver->plan().buffers) {
      if (c.kernels.empty()) {
        EXPECT_FALSE(b.name.starts_with("contact") || b.name.starts_with("collider")) << b.name;
      }
      if (!c.meshes) {
        EXPECT_EQ(b.name.find("cluster"), std::string::npos) << b.name;
        EXPECT_EQ(b.name.find("candidates"), std::string::npos) << b.name;
      }
    }
  }
  const auto without = make("xpbd", {{"contact_samples", 0}});
  without->load(cases[3].scene);
  for (const BufferPlan& b : without->plan().buffers) EXPECT_EQ(b.name.find("sample"), std::string::npos) << b.name;
}

TEST(Clusters, HoldEveryTriangleOnceAndFewAtATime) {
  std::vector<double> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t k = 0; k < 517; ++k) {
    for (int c = 0; c < 3; ++c)
      for (int axis = 0; axis < 3; ++axis) positions.push_back(std::sin(1.7 * k + 0.9 * axis) + 0.01 * c);
    triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const Clusters c = cluster(positions, triangles);
  std::size_t all = 0;
  for (std::uint32_t size : c.sizes) {
    EXPECT_GT(size, 0u);
    EXPECT_LE(size, Clusters::kClusterSize);
    all += size;
  }
  EXPECT_EQ(all, 517u);
  EXPECT_EQ(std::set<std::uint32_t>(c.triangles.begin(), c.triangles.end()).size(), 517u);
  EXPECT_TRUE(cluster({}, {}).sizes.empty());
}

TEST(EdgeMarks, TellBordersAlsoAcrossRepeatedVerticesAndSharpEdges) {
  // Two triangles of a square; the second repeats the shared corners as vertices of its own.
  const std::vector<double> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0};
  EXPECT_EQ(edge_marks(positions, {{0, 1, 2}, {3, 4, 5}}), (std::vector<std::uint32_t>{0b101, 0b011}));
  const Collider closed = octahedron({0, 0, 0}, 1, false);
  EXPECT_EQ(edge_marks(closed.mesh->positions, closed.mesh->triangles), std::vector<std::uint32_t>(8, 0b111000))
      << "71 degrees";
  const std::vector<double> roof = {0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0, -1, 0.1};
  EXPECT_EQ(edge_marks(roof, {{0, 1, 2}, {1, 0, 3}}), (std::vector<std::uint32_t>{0b011, 0b011})) << "11 degrees: flat";
}

}  // namespace
}  // namespace clothbench::pbd_gpu
