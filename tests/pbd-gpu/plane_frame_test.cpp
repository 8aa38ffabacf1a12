// Contact by planes in one dispatch: bit for bit the motion of a dispatch a phase, for every kind of collider, for held
// vertices, by one workgroup and by many; and what it costs where no collider is near.
#include <functional>
#include <set>

#include "contact_scenes.hpp"
#include "plane_contact.hpp"
#include "recorded_access.hpp"
#include "runner/solver_run.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr int kSubsteps = 6;

struct FrameRun {
  ClothState end;
  ContactFaults faults{};
  long dispatches = 0;
  std::set<std::string> kernels;
  bool timed_out = false;
};

class PlaneFrames : public Gpu {
 protected:
  static FrameRun run(const Scene& s, const char* in_one, int frames, nlohmann::json tuning = nlohmann::json::object(),
                      const DeviceOptions& device = options()) {
    nlohmann::json settings = {{"substeps", kSubsteps}};
    tuning["contact_frame"] = in_one;
    settings[kTuning] = tuning;
    const auto solver = make_xpbd(complete_settings(xpbd_info(), settings), device);
    solver->load(s);
    EXPECT_EQ(check_stages(s, solver->info(), solver->plan()), "");
    FrameRun r;
    for (const StagePlan& stage : solver->plan().stages) r.dispatches += stage.dispatches;
    for (const auto& recorded : solver->frame_program().recorded())
      if (recorded.kernel != nullptr) r.kernels.insert(recorded.kernel->name());
    for (int f = 0; f < frames && !r.timed_out; ++f)
      r.timed_out = solver->step({f, (f + 1) * s.time.dt(), s.time.dt(), s.motion_after(f)}) == StepStatus::TimedOut;
    solver->read_state(r.end);
    r.faults = solver->contact_faults();
    return r;
  }

  static void expect_same(const FrameRun& one, const FrameRun& many) {
    EXPECT_EQ(one.end.position, many.end.position);
    EXPECT_EQ(one.end.velocity, many.end.velocity);
    EXPECT_EQ(one.faults.returned, many.faults.returned);
    EXPECT_EQ(one.faults.without_place, many.faults.without_place);
    EXPECT_EQ(one.faults.inside, many.faults.inside);
    EXPECT_EQ(one.faults.dropped, many.faults.dropped);
  }
};

/// A sheet that falls onto something in frames of the usual length.
Scene falling(int columns, int rows, const Collider& collider) {
  Scene s = with_damping(with_bending(with_collider(sheet(columns, rows), collider)));
  s.cloth.sides = Sides::Double;
  s.needs.add(Feature::DoubleSided);
  s.cloth.center_m = {0, 0.2, 0};
  s.cloth.initial_velocity_m_per_s = {0.4, -3, 0.3};
  return s;
}

Collider ground() {
  Collider c = touching(Collider::Shape::Plane, kContactFriction);
  c.center_m = {0, -0.05, 0};
  c.normal = {0, 1, 0};
  return c;
}

TEST_F(PlaneFrames, MoveTheClothBitForBitAsADispatchAPhaseDoes) {
  const std::vector<std::pair<std::string, Collider>> kinds = {
      {"half-space", ground()},
      {"sphere", sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction)},
      {"box", box({0.03, 0.01, 0.01}, {0.3, 0.07, 0.2}, kContactFriction)},
      {"capsules", capsules({-0.1, 0.04, 0}, kContactFriction)},
      {"mesh", octahedron({0.013, 0.017, 0.021}, 0.12, false, kContactFriction)},
      {"hand", octahedron({-0.1, 0.017, 0.021}, 0.12, true, kContactFriction)},
      {"open sheet", open_sheet({0.03, 0.1, 0.01}, 0.32, kContactFriction)}};
  // Compiling the kernel takes a CPU longer than running it: held vertices come with two of the kinds.
  for (const auto& [name, collider] : kinds) {
    const bool held = name == "sphere" || name == "hand";
    SCOPED_TRACE(name);
    Scene s = falling(17, 13, collider);
    if (held)
      s = moving(s, {0, 8}, 4);
    else if (collider.moves())
      s = moving(s);
    const FrameRun one = run(s, "always", 10), many = run(s, "never", 10);
    expect_same(one, many);
    // A half-space is never far: no kernel is there for frames without contact.
    const int far = name == "half-space" ? 0 : 1;
    EXPECT_LE(one.dispatches, far + (collider.mesh && collider.moves() ? 3 : collider.moves() ? 2 : 1));
    EXPECT_GT(many.dispatches, kSubsteps * 8);
  }
}

TEST_F(PlaneFrames, OfTheLargestClothOfOneWorkgroup) {
  const Scene s = falling(32, 32, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
  const FrameRun one = run(s, "always", 6);
  EXPECT_EQ(one.dispatches, 2);
  expect_same(one, run(s, "never", 6));
}

TEST_F(PlaneFrames, WithinTheLimitsOfAMobileGpu) {
  const Scene s = moving(falling(32, 32, octahedron({-0.1, 0.017, 0.021}, 0.12, true, kContactFriction)));
  DeviceOptions mobile = options();
  mobile.profile = "adreno-like";
  const FrameRun one = run(s, "auto", 5, {}, mobile);
  EXPECT_TRUE(one.kernels.contains("plane_frame") || one.kernels.contains("plane_frame_shuffle"));
  EXPECT_LE(one.dispatches, 6);
  expect_same(one, run(s, "never", 5, {}, mobile));
}

struct ManyGroups {
  int columns, rows, threads, vertices, groups;
};
/// Runs the scene that `scene` makes for each shape of workgroups, in one dispatch and by phases, and compares. Shapes
/// whose workgroups the device does not run at once are left out; at least one remains. `dispatches`: of a frame.
template <class Make>
void expect_same_of_many(const char* kernel, long dispatches, const std::vector<ManyGroups>& shapes, const Make& scene,
                         const std::function<FrameRun(const Scene&, const char*, nlohmann::json)>& run,
                         const std::function<void(const FrameRun&, const FrameRun&)>& compare) {
  int agreed = 0;
  for (const ManyGroups& w : shapes) {
    SCOPED_TRACE(std::to_string(w.columns) + " columns, " + std::to_string(w.vertices) + " vertices a thread, " +
                 std::to_string(w.groups) + " groups");
    const Scene s = scene(w.columns, w.rows);
    nlohmann::json tuning = {{"device_barrier", "always"},
                             {"threads_a_group", w.threads},
                             {"vertices_a_thread", w.vertices},
                             {"contact_groups", w.groups}};
    FrameRun one;
    try {
      one = run(s, "always", tuning);
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("device_barrier=always"), std::string::npos) << e.what();
      continue;
    }
    if (one.timed_out) continue;
    EXPECT_TRUE(one.kernels.contains(kernel));
    EXPECT_EQ(one.dispatches, dispatches);
    tuning["device_barrier"] = "never";
    compare(one, run(s, "never", tuning));
    ++agreed;
  }
  EXPECT_GE(agreed, 1);
}

TEST_F(PlaneFrames, OfManyWorkgroupsThatWaitForOneAnother) {
  const auto six_frames = [](const Scene& s, const char* in_one, const nlohmann::json& tuning) {
    return run(s, in_one, 6, tuning);
  };
  const auto onto_a_sphere = [](int columns, int rows) {
    return falling(columns, rows, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
  };
  // Hulls of more than three points, which subgroups have to themselves; a frame also skins them and lists the pieces.
  const auto onto_a_hand = [](int columns, int rows) {
    return moving(falling(columns, rows, octahedron({-0.1, 0.017, 0.021}, 0.12, true, kContactFriction)));
  };
  // 1 and 3 workgroups, and 2 of which one has a square cloth's lines. One of the dispatches is for frames without
  // contact.
  const std::vector<ManyGroups> shapes = {{33, 31, 512, 8, 1}, {33, 31, 512, 2, 1}, {16, 16, 512, 8, 2}};
  expect_same_of_many("plane_frame_many_shuffle", 2, shapes, onto_a_sphere, six_frames, expect_same);
  expect_same_of_many("plane_frame_many_shuffle", 4, {{16, 16, 512, 8, 1}, {16, 16, 512, 8, 2}}, onto_a_hand,
                      six_frames, expect_same);
}

/// Its list takes five dispatches: reaches, boxes, pairs counted, their places, pairs written.
TEST_F(PlaneFrames, OfManyWorkgroupsWhereTheClothTouchesItself) {
  const auto run_of = [](const Scene& s, const char* in_one, const nlohmann::json& tuning) {
    return run(s, in_one, 12, tuning);
  };
  const auto folded_alone = [](int columns, int rows) { return folded(sheet(columns, rows, 0.5, 0.5), 0.02, 0.3); };
  const auto folded_on_a_sphere = [&](int columns, int rows) {
    return with_collider(folded_alone(columns, rows), sphere({0.02, -0.14, 0.03}, 0.13, kContactFriction));
  };
  // Small, for lavapipe ends a thread's loops after 65535 rounds of all of them together.
  const std::vector<ManyGroups> shapes = {{16, 16, 512, 8, 1}, {16, 16, 512, 8, 3}};
  expect_same_of_many("plane_frame_many_shuffle_self", 6, shapes, folded_alone, run_of, expect_same);
  expect_same_of_many("plane_frame_many_shuffle_self", 6, shapes, folded_on_a_sphere, run_of, expect_same);
}

TEST_F(PlaneFrames, DoWithBuffersWhatTheirQualifiersSay) {
  const auto solver = make("xpbd", {{"tuning", {{"contact_frame", "always"}}}});
  solver->load(moving(falling(9, 7, capsules({-0.1, 0.04, 0}, kContactFriction)), {0}, 4));
  int kernels = 0;
  for (const auto& r : solver->frame_program().recorded()) {
    if (r.kernel == nullptr) continue;
    ++kernels;
    for (const BufferUse& u : uses_of(r.kernel->code())) {
      const vulkan::Access declared = binding_of(*r.kernel, u.binding).access;
      const std::string where = r.kernel->name() + " binding " + std::to_string(u.binding);
      EXPECT_EQ(u.read, declared != vulkan::Access::Write) << where;
      EXPECT_EQ(u.written, declared != vulkan::Access::Read) << where;
    }
  }
  EXPECT_EQ(kernels, 3) << "pieces, the frame far from them, the frame";
}

TEST_F(PlaneFrames, WhereNoColliderIsNear) {
  Scene s = falling(17, 13, sphere({0.02, -9, 0.03}, 0.13, kContactFriction));
  const FrameRun one = run(s, "always", 4), many = run(s, "never", 4);
  expect_same(one, many);
}

/// Frames in which pieces are near and a slow cloth meets none, then contact: by one workgroup and by many.
TEST_F(PlaneFrames, OfASlowClothThatMeetsAColliderLate) {
  Scene s = falling(17, 13, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
  s.cloth.center_m = {0, 0.24, 0};
  s.cloth.initial_velocity_m_per_s = {0, 0, 0};
  const FrameRun phases = run(s, "never", 14);
  expect_same(run(s, "always", 14), phases);
  // It is held up, so that a frame that missed the collider would show.
  Scene without = s;
  without.colliders[0].center_m = {0, -9, 0};
  EXPECT_NE(run(without, "never", 14).end.position, phases.end.position);
  s.cloth.columns = 33;
  nlohmann::json tuning = {
      {"device_barrier", "always"}, {"threads_a_group", 512}, {"vertices_a_thread", 8}, {"contact_groups", 1}};
  const FrameRun many = run(s, "always", 14, tuning);
  EXPECT_TRUE(many.kernels.contains("plane_frame_many_shuffle_far"));
  tuning["device_barrier"] = "never";
  expect_same(many, run(s, "never", 14, tuning));
}

TEST_F(PlaneFrames, AreRefusedWhereTheyCannotBe) {
  const Scene s = falling(33, 31, sphere({0.02, 0.01, 0.03}, 0.13, kContactFriction));
  EXPECT_THROW(run(s, "always", 1, {{"device_barrier", "never"}}), Error);
  EXPECT_NO_THROW(run(s, "auto", 1, {{"device_barrier", "never"}}));
}

}  // namespace
}  // namespace clothbench::pbd_gpu
