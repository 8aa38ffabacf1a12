// Contact of `xpbd` by planes: nothing passes through in any step, by the harness's metrics; friction; short lists.

#include <set>

#include "contact_check.hpp"
#include "contact_scenes.hpp"
#include "mesh_scene.hpp"
#include "runner/solver_run.hpp"
#include "xpbd/contact/contact.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Instant k of a hand around (-1, 0, 0) that moves 10 mm per instant along x; its two joints rotate oppositely.
void pose_hand(ColliderPose& pose, std::size_t k) {
  for (std::size_t joint = 0; joint < pose.joints.size(); ++joint) {
    const double way = 0.01 * static_cast<double>(k), turn = 0.002 * static_cast<double>(k) * (joint == 0 ? 1 : -1),
                 cosine = std::cos(turn), sine = std::sin(turn);
    pose.joints[joint] = {{{cosine, -sine, 0, way + cosine - 1}, {sine, cosine, 0, sine}, {0, 0, 1, 0}}};
  }
}

/// A sheet that falls onto a collider, with one step per frame, so that every step can be checked.
Scene falling_in_steps(const Collider& collider, double steps_per_s) {
  Scene s = with_collider(sheet(12, 10), collider);
  s = two_sided(s);
  s.cloth.center_m = {0, 0.26, 0};
  s.cloth.initial_velocity_m_per_s = {0.4, -3, 0.3};
  s.time = {steps_per_s, 0.2};
  if (collider.moves()) s = moving(s);
  for (std::size_t k = 0; collider.mesh && k < s.motion.size(); ++k) pose_hand(s.motion[k].colliders.at(0), k);
  return s;
}

class XpbdContacts : public Gpu {};

TEST_F(XpbdContacts, NothingCrossesAtAnyStep) {
  const std::vector<std::pair<std::string, Collider>> kinds = {
      {"sphere", sphere({0.02, 0.04, 0.03}, 0.09, kContactFriction)},
      {"box", box({0.03, 0.01, 0.01}, {0.3, 0.07, 0.2}, kContactFriction)},
      {"capsules", capsules({-1, 0.04, 0}, kContactFriction)},
      {"mesh", octahedron({0.013, 0.017, 0.021}, 0.12, false, kContactFriction)},
      {"hand", octahedron({-1, 0.017, 0.021}, 0.12, true, kContactFriction)},
      {"open sheet", open_sheet({0.03, 0.1, 0.01}, 0.32, kContactFriction)}};
  // A moving collider moves 10 mm per step: 8 and 12 m/s.
  for (const double steps_per_s : {800.0, 1200.0})
    for (const auto& [name, collider] : kinds) {
      if (!collider.moves() && steps_per_s > 800) continue;
      SCOPED_TRACE(name + " at " + std::to_string(steps_per_s));
      const ContactRun run = contact_run(falling_in_steps(collider, steps_per_s), {{"substeps", 1}});
      EXPECT_EQ(run.fault, "");
      EXPECT_GT(run.touching, 0) << "otherwise this tests nothing";
    }
}

Collider slope(bool half, double angle) {
  const double sine = std::sin(angle), cosine = std::cos(angle);
  if (half) return half_space({0, 0, 0}, {sine, cosine, 0}, 0.5);
  // The difference of nearest points on a large face has lost the digits that give its normal.
  Collider large = box({-sine, -cosine, 0}, {2, 1, 1}, 0.5);
  large.axes = {{{cosine, -sine, 0}, {sine, cosine, 0}, {0, 0, 1}}};
  return large;
}

/// A sheet on a slope slides by g (sin - friction cos) T^2 / 2 or sticks, on a half-space and on a large box.
TEST_F(XpbdContacts, HoldOnAnInclineUpToTheAngleOfFrictionAndSlideBeyond) {
  const double friction = 0.5, g = 9.81, T = 0.5;
  for (const bool half : {true, false})
    for (const double share : {0.98, 1.1}) {
      const double angle = std::atan(share * friction), sine = std::sin(angle), cosine = std::cos(angle);
      Scene s = with_collider(sheet(5, 5, 0.4, 0.4), slope(half, angle));
      s.cloth.axis_u = {cosine, -sine, 0};
      s.cloth.center_m = {0.02 * sine, 0.02 * cosine, 0};
      const auto solver = make("xpbd");
      solver->load(s);
      const ClothState state = after(*solver, s, 36);
      const std::vector<double> start = initial_positions(s);
      for (std::size_t i = 0; i < start.size(); i += 3) {
        const double slid = cosine * (state.position[i] - start[i]) - sine * (state.position[i + 1] - start[i + 1]);
        const double expected = std::max(0.0, 0.5 * g * (sine - friction * cosine) * T * T);
        EXPECT_NEAR(slid, expected, std::max(1e-5, 0.02 * expected)) << "tangent " << share << " of the friction";
      }
    }
}

/// A strip over a cylinder: the contact normal at a substep's start would brake it, and depenetration of chords would
/// make the strip of few rows creep.
TEST_F(XpbdContacts, NeitherBrakeNorPushAStripOverACylinder) {
  const double radius = 0.1;
  for (const auto& [rows, light, heavy, friction, bound] :
       {std::tuple{22, 11, 32, 0.001, 0.02}, {10, 4, 13, 0.3, 0.001}}) {
    const double cell = 2 * radius * std::sin(std::numbers::pi / (2 * rows));
    const int links = rows - 1 + light + heavy;
    const Scene s = load_scene(
        "validation/capstan-slip",
        {fmt::format("cloth.grid=[{},3]", links + 1), fmt::format("cloth.size_m=[{},{}]", links * cell, 2 * cell),
         fmt::format("cloth.pose.drape.offset_m={}", (heavy - light) * cell / 2),
         fmt::format("colliders.0.friction={}", friction), "time.duration_s=0.25"});
    SolverRun run({&s, &find_solver("xpbd"), complete_settings(xpbd_info(), {{"substeps", 14}})}, {}, "test");
    const AccuracyPass pass = whole_pass(run, s);
    EXPECT_LT(scalars_of({s, pass}).at("truth_quantity_error"), bound) << rows << " rows";
  }
}

/// If a pair list is too short, the motion bound is reduced; pairs that still do not fit make the run an error.
TEST_F(XpbdContacts, DropNoPairInSilence) {
  Scene s = falling_in_steps(sphere({0.02, 0.2, 0.03}, 0.09, kContactFriction), 100);
  const SolverEntry& entry = find_solver("xpbd");
  for (const auto& [places, overflow] : {std::pair{0, false}, {3, true}}) {
    nlohmann::json settings = {{"substeps", 2}};
    settings[kTuning]["contact_pairs"] = places;
    RunSpec spec{&s, &entry, complete_settings(xpbd_info(), settings)};
    SolverRun run(spec, {}, "test");
    const AccuracyPass pass = whole_pass(run, s);
    const Outcome& outcome = run.outcome();
    EXPECT_EQ(outcome.status, overflow ? "error" : "ok") << outcome.message;
    const auto series = std::find_if(pass.metrics.begin(), pass.metrics.end(),
                                     [](const MetricSeries& m) { return m.name == "contact_overflow"; });
    ASSERT_NE(series, pass.metrics.end());
    ASSERT_EQ(series->values.size(), pass.time_s.size());
    EXPECT_EQ(series->values.back() > 0, overflow);
    if (!overflow) continue;
    EXPECT_NE(outcome.message.find("contact_pairs"), std::string::npos) << outcome.message;
    EXPECT_EQ(series->values[static_cast<std::size_t>(outcome.failed_frame)], series->values.back());
    EXPECT_EQ(series->values[static_cast<std::size_t>(outcome.failed_frame) - 1], 0);
  }
}

TEST_F(XpbdContacts, TakeTheSameSubstepsAfterAReset) {
  // At the end the sheet is at rest and uses few substeps; at the start it falls.
  Scene s = with_damping(with_collider(sheet(12, 10), half_space({0, -0.02, 0}, {0, 1, 0}, kContactFriction)));
  s = two_sided(s);
  const auto solver = make("xpbd");
  solver->load(s);
  ClothState ends[2];
  std::set<const void*> recorded[2];
  for (int run = 0; run < 2; ++run) {
    for (int f = 0; f < s.time.frames(); ++f) {
      ends[run] = after_frame(*solver, s, f);
      recorded[run].insert(&dynamic_cast<GpuSolver&>(*solver).frame_program());
    }
    solver->reset();
  }
  EXPECT_EQ(ends[0].position, ends[1].position) << "otherwise a frame recorded in the first run was submitted again";
  EXPECT_GT(recorded[0].size(), 2u) << "the numbers of substeps differ";
  EXPECT_EQ(recorded[0], recorded[1]) << "no frame is recorded twice";
}

TEST_F(XpbdContacts, TakeMoreSubstepsWhileALinkIsStrained) {
  std::size_t commands[2];
  for (const int strained : {0, 1}) {
    Scene s = with_collider(sheet(12, 10), half_space({0, -0.02, 0}, {0, 1, 0}, kContactFriction));
    s.cloth.axis_u = {strained != 0 ? 1.09 : 1, 0, 0};
    s.material.membrane_stiffness_N_per_m = 1e-3;
    const auto solver = make("xpbd");
    solver->load(s);
    for (int f = 0; f < 2; ++f) after_frame(*solver, s, f);
    commands[strained] = dynamic_cast<GpuSolver&>(*solver).frame_program().recorded().size();
  }
  EXPECT_GT(commands[1], commands[0]);
}

TEST_F(XpbdContacts, RepeatAFrameThatStrainsALinkTooFar) {
  struct Frame {
    ClothState end;
    double strain = 0, read_B = 0;
  };
  const auto first_frame = [](const Scene& s, int substeps) {
    const auto solver = make("xpbd", {{"count_bytes", true}, {"substeps", substeps}});
    solver->load(s);
    Frame f{after_frame(*solver, s, 0)};
    for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
      const auto at = [&](auto v) {
        return Eigen::Map<const Eigen::Vector3d>(&f.end.position[3 * static_cast<std::size_t>(v)]);
      };
      f.strain = std::max(f.strain, (at(e.a) - at(e.b)).norm() / e.rest_m - 1);
    }
    for (const double stage : solver->last_cost().stage_read_B) f.read_B += stage;
    return f;
  };
  for (const bool hand : {false, true}) {
    Scene s = two_sided(with_damping(sheet(17, 17)));
    s = hand ? moving(with_collider(s, octahedron({0.03, 0.01, 0.01}, 0.12, true, kContactFriction)))
             : with_collider(s, box({0.03, 0.01, 0.01}, {0.1, 0.07, 0.1}, kContactFriction));
    s.cloth.center_m = {0, 0.12, 0};
    s.cloth.initial_velocity_m_per_s = {0, -16, 0};
    s.colliders[0].margin_m = hand ? 0.03 : 0.004;
    const int n = hand ? xpbd_substeps(s, nlohmann::json::object()) : 12;
    const Frame repeated = first_frame(s, 0), once = first_frame(s, n), twice = first_frame(s, 2 * n);
    EXPECT_GT(once.strain, 0.25);
    EXPECT_EQ(repeated.end.position, twice.end.position) << "from the frame's start, also of the hand";
    EXPECT_GE(repeated.read_B, once.read_B + twice.read_B) << "cost of both attempts";
  }
}

/// Two triangles in the plane z = `at`, 4 m wide, moved along z by a single joint.
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

TEST_F(XpbdContacts, NothingPassesAThinSheetHoweverFastItComes) {
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
        ASSERT_GT(state.position[i], wall) << metres_per_frame << " m per frame, frame " << f;
        pushed = pushed || state.position[i] > 0.01;
      }
    }
    EXPECT_TRUE(pushed);
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
