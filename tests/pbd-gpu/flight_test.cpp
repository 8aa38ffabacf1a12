// Pipelined frames end in the same state as frames with a wait.
#include "contact_scenes.hpp"
#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

std::vector<FrameInput> frames_of(const Scene& s, int count) {
  std::vector<FrameInput> out;
  for (int f = 0; f < count; ++f) out.push_back({f, (f + 1) * s.time.dt(), s.time.dt(), s.motion_after(f)});
  return out;
}

ClothState state_of(const ClothSolver& solver) {
  ClothState out;
  solver.read_state(out);
  return out;
}

TEST_F(Gpu, PipelinedFramesAreTheSameBits) {
  const Scene plain = with_damping(with_pins(with_bending(sheet(9, 7)))), many = with_pins(sheet(40, 37));
  for (const Scene& s : {plain, many, with_collider(sheet(13, 11), sphere({0, -0.3, 0}, 0.25))})
    for (const int count : {1, 2, 7}) {
      const auto stepped = make("xpbd", {{"substeps", 5}}), flown = make("xpbd", {{"substeps", 5}});
      stepped->load(s);
      flown->load(s);
      EXPECT_EQ(flown->frames_in_flight(), 2);
      const ClothState expected = after(*stepped, s, count);
      for (int again = 0; again < 2; ++again) {
        flown->reset();
        ASSERT_EQ(flown->run_frames(frames_of(s, count)), StepStatus::Ok);
        const ClothState found = state_of(*flown);
        EXPECT_EQ(found.position, expected.position) << count;
        EXPECT_EQ(found.velocity, expected.velocity) << count;
      }
      if (device_->has_timestamps()) {
        EXPECT_GT(flown->last_cost().device_s, 0);
      }
      // Frames that are stepped afterwards do not depend on whether the frames before them were pipelined.
      EXPECT_EQ(after_frame(*flown, s, count).position, after_frame(*stepped, s, count).position);
    }
}

TEST_F(Gpu, AClothThatHandsHoldDoesNotGoOnFromWhatWasReadOfIt) {
  const Scene held = moving(sheet(9, 7), {0, 8});
  const auto solver = make("xpbd");
  solver->load(held);
  EXPECT_FALSE(solver->restart(state_of(*solver))) << "positions and velocities do not contain the hands' positions";
}

}  // namespace
}  // namespace clothbench::pbd_gpu
