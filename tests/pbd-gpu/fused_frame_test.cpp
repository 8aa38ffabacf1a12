// Contact by planes in one dispatch: bit-identical to one dispatch per pass for every kind of collider, for attached
// vertices, with one workgroup and with many; and its cost if no collider is active.
#include <set>

#include "contact_scenes.hpp"
#include "runner/solver_run.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr int kSubsteps = 6;

struct FrameRun {
  ClothState end;
  std::vector<double> counts, height_m;  // of a corner at the start and after each frame
  long dispatches = 0;
  std::size_t recorded = 0, most_recorded = 0;  // commands: before the first frame; maximum in any frame
  std::set<std::string> kernels;
  bool timed_out = false;
};

class FusedFrames : public Gpu {
 protected:
  /// One dispatch of one workgroup: lavapipe may not run several at once, and it ends loops after 65535 rounds.
  static FrameRun run(const Scene& s, const char* in_one, int frames, const char* barrier = "always",
                      int substeps = kSubsteps) {
    const auto solver = make("xpbd", {{"substeps", substeps},
                                      {kTuning,
                                       {{"contact_frame", in_one},
                                        {"device_barrier", barrier},
                                        {"contact_groups", 1},
                                        {"threads_a_group", 512},
                                        {"vertices_a_thread", 8}}}});
    solver->load(s);
    EXPECT_EQ(check_stages(s, solver->info(), solver->plan()), "");
    FrameRun r;
    for (const StagePlan& stage : solver->plan().stages) r.dispatches += stage.dispatches;
    for (const auto& recorded : solver->frame_program().recorded())
      if (recorded.kernel != nullptr) r.kernels.insert(recorded.kernel->name());
    r.recorded = solver->frame_program().recorded().size();
    solver->read_state(r.end);
    r.height_m = {r.end.position[1]};
    for (int f = 0; f < frames && !r.timed_out; ++f) {
      r.timed_out = solver->step({f, (f + 1) * s.time.dt(), s.time.dt(), s.motion_after(f)}) == StepStatus::TimedOut;
      solver->read_state(r.end);
      r.height_m.push_back(r.end.position[1]);
      r.most_recorded = std::max(r.most_recorded, solver->frame_program().recorded().size());
    }
    for (const SolverCount& c : solver->counts()) r.counts.push_back(c.count);
    return r;
  }

  static void expect_same(const FrameRun& one, const FrameRun& many) {
    EXPECT_EQ(one.end.position, many.end.position);
    EXPECT_EQ(one.end.velocity, many.end.velocity);
    EXPECT_EQ(one.counts, many.counts);
  }
};

/// A sheet that falls onto a collider, in frames of the usual length.
Scene falling(int columns, int rows, const Collider& collider) {
  Scene s = with_damping(with_bending(with_collider(sheet(columns, rows), collider)));
  s = two_sided(s);
  s.cloth.center_m = {0, 0.2, 0};
  s.cloth.initial_velocity_m_per_s = {0.4, -3, 0.3};
  return s;
}

TEST_F(FusedFrames, MoveTheClothBitForBitAsADispatchAPhaseDoes) {
  if (!in_turn(1)) GTEST_SKIP() << "part of pbd_gpu.matrix";
  const std::vector<std::pair<std::string, Collider>> kinds = {
      {"half-space", half_space({0, -0.05, 0}, {0, 1, 0}, kContactFriction)},
      {"sphere", sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction)},
      {"box", box({0.03, 0.01, 0.01}, {0.3, 0.07, 0.2}, kContactFriction)},
      {"capsules", capsules({-0.1, 0.04, 0}, kContactFriction)},
      {"mesh", octahedron({0.013, 0.017, 0.021}, 0.12, false, kContactFriction)},
      {"hand", octahedron({-0.1, 0.017, 0.021}, 0.12, true, kContactFriction)},
      {"open sheet", open_sheet({0.03, 0.1, 0.01}, 0.32, kContactFriction)}};
  // Compiling the kernel takes a CPU longer than running it, so only two kinds are combined with attached vertices.
  for (const auto& [name, collider] : kinds) {
    const bool held = name == "sphere" || name == "hand";
    SCOPED_TRACE(name);
    Scene s = falling(17, 13, collider);
    if (held)
      s = moving(s, {0, 8}, 4);
    else if (collider.moves())
      s = moving(s);
    const FrameRun one = run(s, "always", 10), many = run(s, "never", 10, "never");
    expect_same(one, many);
    // A half-space is always in reach, so there is no kernel for contact-free frames.
    const int contact_free = name == "half-space" ? 0 : 1;
    EXPECT_LE(one.dispatches, contact_free + (collider.mesh && collider.moves() ? 3 : collider.moves() ? 2 : 1));
    EXPECT_GT(many.dispatches, kSubsteps * 8);
  }
}

/// The slow cloth touches the collider only after some contact-free frames. These use one workgroup, or many for
/// larger cloth.
TEST_F(FusedFrames, OfASlowClothThatMeetsAColliderLate) {
  if (!in_turn(1)) GTEST_SKIP() << "part of pbd_gpu.matrix";
  for (const int columns : {17, 33}) {
    Scene s = falling(columns, 13, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
    s.cloth.center_m = {0, 0.24, 0};
    s.cloth.initial_velocity_m_per_s = {0, 0, 0};
    const FrameRun phases = run(s, "never", 14, "never"), one = run(s, "always", 14);
    expect_same(one, phases);
    EXPECT_TRUE(one.kernels.contains(columns > 32 ? "fused_frame_contact_free" : "line_frame_contact_free"));
    // The collider stops the cloth, so that a frame that missed it would show.
    s.colliders[0].center_m = {0, -9, 0};
    EXPECT_NE(run(s, "never", 14, "never").end.position, phases.end.position);
  }
}

/// Fast cloth builds several pair lists per frame, one per dispatch, and fewer once the collider has stopped it.
TEST_F(FusedFrames, OfFastClothTakeALongerFrameInParts) {
  Scene s = falling(17, 13, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
  s.cloth.initial_velocity_m_per_s = {0.4, -12, 0.3};
  const FrameRun phases = run(s, "never", 8, "never", 0), one = run(s, "always", 8, "always", 0);
  expect_same(one, phases);
  EXPECT_GT(one.most_recorded, one.recorded);
}

/// Frames before the contact have fewer substeps, and fused frames may be contact-free; the cloth falls alike in all.
TEST_F(FusedFrames, FallAlikeWithAnyNumberOfSubsteps) {
  Scene s = two_sided(with_collider(sheet(17, 13), sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction)));
  s.needs.add(Feature::Shear);
  s.colliders[0].margin_m = 0.004;
  s.cloth.center_m = {0, 1.5, 0};
  s.cloth.initial_velocity_m_per_s = {0.4, -6, 0.3};
  for (const char* in_one : {"always", "never"}) {
    const std::vector<double> y = run(s, in_one, 8, in_one, 0).height_m;
    for (std::size_t f = 2; f < y.size(); ++f)
      EXPECT_NEAR((y[f] - 2 * y[f - 1] + y[f - 2]) / (s.time.dt() * s.time.dt()), -9.81, 0.02) << in_one << f;
  }
}

TEST_F(FusedFrames, AreRefusedWhereTheyCannotBe) {
  const Scene s = falling(33, 31, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
  EXPECT_THROW(run(s, "always", 1, "never"), Error);
  EXPECT_NO_THROW(run(s, "auto", 1, "never"));
}

}  // namespace
}  // namespace clothbench::pbd_gpu
