// Contact of the cloth with itself by planes: against double precision over all pairs, certified at every step, the
// same bits again, with a collider and without one.
#include "contact_scenes.hpp"
#include "mesh_scene.hpp"
#include "plane_contact_check.hpp"
#include "runner/stage_check.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

nlohmann::json with(int substeps) { return {{"substeps", substeps}}; }

Collider floor_below(double friction = kContactFriction) {
  Collider c = touching(Collider::Shape::Plane, friction);
  c.center_m = {0, -0.25, 0};
  c.normal = {0, 1, 0};
  return c;
}

/// A fold that falls on the floor and on itself, nothing quite parallel.
Scene fold_on_floor(int columns = 13, int rows = 7) {
  Scene s = with_collider(folded(sheet(columns, rows), 0.12, kContactFriction), floor_below());
  s.cloth.sides = Sides::Double;
  s.needs.add(Feature::DoubleSided);
  s.cloth.start.noise_m = 0.004;
  s.cloth.initial_velocity_m_per_s = {0.3, -3, 0.2};
  return s;
}

class PlaneSelfContacts : public Gpu {};

void expect_all_parted(GpuSolver& solver, const Scene& s) {
  solver.load(s);
  EXPECT_EQ(check_stages(s, solver.info(), solver.plan()), "");
  std::vector<double> before = initial_positions(s);
  long pairs = 0;
  for (int f = 0; f < s.time.frames(); ++f) {
    const ClothState state = after_frame(solver, s, f);
    const PairCheck own = check_self_pairs(s, before, state.position),
                    pieces = check_pairs(s, before, state.position, f);
    ASSERT_EQ(own.pairs, own.parted) << "step " << f;
    ASSERT_EQ(pieces.pairs, pieces.parted) << "step " << f;
    pairs += own.pairs;
    before = state.position;
  }
  EXPECT_GT(pairs, 1000) << "something must come near for this to say anything";
  const ContactFaults faults = solver.contact_faults();
  EXPECT_EQ(faults.without_place, 0u);
  EXPECT_EQ(faults.dropped, 0u);
  EXPECT_EQ(faults.inside, 0u);
}

/// Frames are steps, so that every one of them can be checked.
TEST_F(PlaneSelfContacts, PartEveryPairAtEveryStep) {
  Scene s = fold_on_floor();
  s.time = {500, 0.2};
  expect_all_parted(*make("xpbd", with(1)), s);
}

TEST_F(PlaneSelfContacts, PartEveryPairOfATriangleMesh) {
  Scene s = with_collider(mesh_sheet(8), sphere({0.02, -0.72, 0.05}, 0.1, kContactFriction));
  s.pins.vertices.clear();
  s.needs = s.needs - FeatureSet{Feature::Pins};
  s.cloth.sides = Sides::Double;
  s.needs.add(Feature::DoubleSided);
  s.cloth.self_collision = {0.01, kContactFriction};
  s.needs.add(Feature::SelfCollision);
  s.cloth.initial_velocity_m_per_s = {0.1, -4, 0.2};
  s.time = {400, 0.25};
  expect_all_parted(*make("xpbd", with(1)), s);
}

TEST_F(PlaneSelfContacts, WithoutThemTheFoldPassesItself) {
  Scene s = fold_on_floor();
  s.cloth.self_collision = {};
  s.needs = s.needs - FeatureSet{Feature::SelfCollision};
  s.time = {500, 0.2};
  const auto solver = make("xpbd", with(1));
  solver->load(s);
  std::vector<double> before = initial_positions(s);
  long crossed = 0;
  for (int f = 0; f < s.time.frames(); ++f) {
    const ClothState state = after_frame(*solver, s, f);
    const PairCheck own = check_self_pairs(s, before, state.position);
    crossed += own.pairs - own.parted;
    before = state.position;
  }
  EXPECT_GT(crossed, 0);
}

TEST_F(PlaneSelfContacts, RepeatBitForBit) {
  const Scene s = fold_on_floor();
  const auto one = make("xpbd"), two = make("xpbd");
  one->load(s);
  two->load(s);
  const ClothState a = after(*one, s, 8), b = after(*two, s, 8);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  one->reset();
  EXPECT_EQ(after(*one, s, 8).position, a.position);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
