// Self-contact by planes: nothing crosses in any step; bit-identical repeats; friction.
#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_check.hpp"
#include "contact_scenes.hpp"
#include "mesh_scene.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

nlohmann::json with(int substeps) { return {{"substeps", substeps}}; }

/// A fold that falls on the floor and on itself, without parallel parts.
Scene fold_on_floor(int columns = 13, int rows = 7) {
  Scene s = with_collider(folded(sheet(columns, rows), 0.12, kContactFriction),
                          half_space({0, -0.25, 0}, {0, 1, 0}, kContactFriction));
  s = two_sided(s);
  s.cloth.start.noise_m = 0.004;
  s.cloth.initial_velocity_m_per_s = {0.3, -3, 0.2};
  return s;
}

class SelfContacts : public Gpu {};

Scene heaped_mesh() {
  Scene s = with_collider(mesh_sheet(8), sphere({0.02, -0.72, 0.05}, 0.1, kContactFriction));
  s.pins.vertices.clear();
  s.needs = s.needs - FeatureSet{Feature::Pins};
  s = two_sided(s);
  s.cloth.self_collision = {0.01, kContactFriction};
  s.needs.add(Feature::SelfCollision);
  s.cloth.initial_velocity_m_per_s = {0.1, -4, 0.2};
  s.time = {400, 0.25};
  return s;
}

long crossings(const Scene& s, const ClothState& state) {
  const auto all = triangles(s.cloth);
  return contact::self_contour({state.position, all}).pairs;
}

/// One step per frame, so that every step can be checked; without contact this cloth passes through itself.
TEST_F(SelfContacts, NothingCrossesAtAnyStep) {
  Scene fold = fold_on_floor();
  fold.time = {500, 0.2};
  for (Scene s : {fold, heaped_mesh()}) {
    SCOPED_TRACE(s.name);
    EXPECT_EQ(contact_run(s, with(1)).fault, "");
    s.cloth.self_collision = {};
    s.needs = s.needs - FeatureSet{Feature::SelfCollision};
    const auto solver = make("xpbd", with(1));
    solver->load(s);
    long crossed = 0;
    for (int f = 0; f < s.time.frames(); ++f) crossed = std::max(crossed, crossings(s, after_frame(*solver, s, f)));
    EXPECT_GT(crossed, 0);
  }
}

/// A sheet falls on its edge at 6 m/s, and the floor stops it within a frame. Its centre of mass may accelerate down
/// only by gravity.
TEST_F(SelfContacts, AnImpactPullsNothingDown) {
  const Scene s = load_scene(
      "contact/self-crumple",
      {"cloth.grid=[17,17]", "cloth.pose.center_m=[0,0.629943,0]", "cloth.pose.axis_u=[0.424615575132,0,0.90537374236]",
       "cloth.start.noise_m=0.000536", "cloth.start.seed=483601464", "cloth.self_collision.thickness_m=0.002175",
       "cloth.initial_velocity_m_per_s=[0,-3.83477,0]", "time.frame_rate_hz=90"});
  const auto solver = make("xpbd", {{"quality", "accurate"}});
  solver->load(s);
  const std::vector<double> masses = vertex_masses(s);
  const auto height_m = [&](const std::vector<double>& x) {
    double moment = 0, mass = 0;
    for (std::size_t v = 0; v < masses.size(); ++v) moment += masses[v] * x[3 * v + 1], mass += masses[v];
    return moment / mass;
  };
  const double fall_m = 9.81 * s.time.dt() * s.time.dt();
  double last_m = height_m(initial_positions(s)), step_m = s.cloth.initial_velocity_m_per_s[1] * s.time.dt();
  for (int f = 0; f < 12; ++f) {
    const double now_m = height_m(after_frame(*solver, s, f).position);
    EXPECT_GT(now_m - last_m - step_m, -1.05 * fall_m) << "frame " << f;
    step_m = now_m - last_m;
    last_m = now_m;
  }
}

/// The sphere stops the middle of a sheet while its rim falls on. The pair list has capacity for a substep only, which
/// must not drag resting vertices along.
TEST_F(SelfContacts, WithAShortListWhatTheBallStopsStaysThere) {
  const Scene s = load_scene("contact/sphere", {"cloth.grid=[16,16]", "time.duration_s=0.45",
                                                R"(cloth.self_collision={"thickness_m":0.006,"friction":0.3})"});
  const auto solver = make("xpbd", {{kTuning, {{"contact_pairs", 30000}}}});
  solver->load(s);
  const std::vector<Edge> sides = edges(s.cloth, EdgeKind::Structural);
  for (int f = 0; f < s.time.frames(); ++f) {
    const std::vector<double> x = after_frame(*solver, s, f).position;
    for (const Edge& e : sides) {
      const double *a = &x[3 * e.a], *b = &x[3 * e.b];
      EXPECT_LT(std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]), 1.1 * e.rest_m) << "frame " << f;
    }
  }
}

/// A frame whose pairs do not fit is repeated with longer lists, in every run alike.
TEST_F(SelfContacts, ListsThatAreTooShortGrow) {
  Scene s = folded(sheet(17, 9, 0.5, 0.25), 0.03, 0.3);
  s.time.duration_s = 0.15;
  const auto size_of_lists = [](const ClothSolver& solver) {
    for (const BufferPlan& b : solver.plan().buffers)
      if (b.name == "self-contact pairs") return b.bytes;
    return std::uint64_t{0};
  };
  const auto ample = make("xpbd"), tight = make("xpbd", {{kTuning, {{"contact_pairs", 1000}}}});
  std::vector<double> ends[3];
  for (int run = 0; run < 3; ++run) {
    ClothSolver& solver = run == 0 ? *ample : *tight;
    if (run < 2)
      solver.load(s);
    else
      solver.reset();
    const std::uint64_t before = size_of_lists(solver);
    ClothState state;
    for (int f = 0; f < s.time.frames(); ++f) state = after_frame(solver, s, f);
    EXPECT_EQ(crossings(s, state), 0);
    for (const SolverCount& c : solver.counts())
      if (c.name == "contact_overflow") {
        EXPECT_EQ(c.count, 0);
      }
    EXPECT_EQ(size_of_lists(solver) > before, run > 0);
    ends[run] = state.position;
  }
  EXPECT_EQ(ends[1], ends[2]);
  for (std::size_t k = 0; k < ends[0].size(); ++k) ASSERT_NEAR(ends[0][k], ends[1][k], 0.02) << k;
}

/// At 100 m/s nearly all triangles are pairs, for which no device grows the lists enough.
TEST_F(SelfContacts, PairsThatFitNoListAreCounted) {
  const Scene s = load_scene("contact/sphere", {"cloth.grid=[32,32]", "cloth.initial_velocity_m_per_s=[0,0,100]",
                                                R"(cloth.self_collision={"thickness_m":0.0015,"friction":0.3})"});
  const auto solver = make("xpbd", {{"substeps", 4}, {kTuning, {{"contact_pairs", 700000}}}});
  solver->load(s);
  after_frame(*solver, s, 0);
  const std::vector<SolverCount> counts = solver->counts();
  EXPECT_TRUE(std::any_of(counts.begin(), counts.end(),
                          [](const SolverCount& c) { return c.name == "contact_overflow" && c.count > 0; }));
}

/// A folded sheet: the leg with its last column and half of the bend are attached; the other leg approaches at `speed`.
Scene closing(double speed, double friction = 0) {
  Scene s = folded(sheet(17, 9, 0.5, 0.25), 0.06, friction);
  const int columns = s.cloth.columns;
  for (std::uint32_t v = 0; v < s.cloth.vertex_count(); ++v)
    if (static_cast<int>(v) % columns >= columns / 2) s.pins.vertices.push_back(v);
  s.needs.add(Feature::Pins);
  s.gravity_m_per_s2 = {};
  const std::vector<double> x = initial_positions(s);
  const double held = x[3 * static_cast<std::size_t>(columns - 1) + 1], free = x[1];
  s.cloth.initial_velocity_m_per_s = {0, held > free ? speed : -speed, 0};
  return s;
}

/// Minimum distance between the outer vertices of the free leg and the attached leg, whose vertices lie along y.
double layers_apart(const Scene& s, const ClothState& state) {
  const std::size_t columns = static_cast<std::size_t>(s.cloth.columns);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < s.cloth.vertex_count(); v += columns)
    least = std::min(least, std::abs(state.position[3 * (v + columns - 1) + 1] - state.position[3 * v + 1]));
  return least;
}

class ClosingLayers : public Gpu, public ::testing::WithParamInterface<double> {};
INSTANTIATE_TEST_SUITE_P(Speeds, ClosingLayers, ::testing::Values(0.2, 1.0, 5.0, 20.0),
                         [](const auto& i) { return "mm_per_s_" + std::to_string(std::lround(1000 * i.param)); });

TEST_P(ClosingLayers, LayersMeetAndNothingCrosses) {
  const Scene s = closing(GetParam());
  const auto solver = make("xpbd");
  solver->load(s);
  EXPECT_EQ(check_stages(s, xpbd_info(), solver->plan()), "");
  double least = std::numeric_limits<double>::infinity(), fastest = 0;
  const int frames = std::max(24, static_cast<int>(std::lround(0.1 / GetParam() * 72)));
  for (int f = 0; f < frames; ++f) {
    const ClothState state = after_frame(*solver, s, f);
    ASSERT_EQ(crossings(s, state), 0) << "frame " << f;
    least = std::min(least, layers_apart(s, state));
    if (f > frames / 2)
      for (std::size_t v = 0; v < s.cloth.vertex_count(); ++v)
        fastest =
            std::max(fastest, std::hypot(state.velocity[3 * v], state.velocity[3 * v + 1], state.velocity[3 * v + 2]));
  }
  // A fast leg touches and returns within a frame, so only slower ones are seen close at a frame's end.
  if (GetParam() <= 5) {
    EXPECT_LT(least, 1.5 * s.cloth.self_collision.thickness_m) << "otherwise no layers touch";
  }
  EXPECT_LT(fastest, GetParam()) << "layers that touch do not bounce";
}

TEST_F(ClosingLayers, FrictionHoldsALayerThatSlidesOnAnother) {
  // Gravity presses the layer down; it slides on the one below at 0.5 m/s and stops after v^2 / (2 mu g) = 26 mm.
  double way[2];
  for (const int k : {0, 1}) {
    Scene s = closing(0, k == 0 ? 0 : 0.5);
    s.material.shear = false;  // strips, so that a layer may slide sideways
    s.needs = s.needs - FeatureSet{Feature::Shear};
    const std::vector<double> x = initial_positions(s);
    const std::size_t free_end = 0, held_end = static_cast<std::size_t>(s.cloth.columns - 1);
    s.gravity_m_per_s2 = {0, x[3 * held_end + 1] > x[3 * free_end + 1] ? 9.81 : -9.81, 0};
    const auto solver = make("xpbd");
    solver->load(s);
    // Down first; then a push along z.
    ClothState state;
    for (int f = 0; f < 36; ++f) state = after_frame(*solver, s, f);
    for (std::size_t v = 0; v < s.cloth.vertex_count(); ++v)
      if (static_cast<int>(v) % s.cloth.columns < s.cloth.columns / 4) state.velocity[3 * v + 2] += 0.5;
    const std::vector<double> before = state.position;
    ASSERT_TRUE(solver->restart(state));
    for (int f = 36; f < 54; ++f) state = after_frame(*solver, s, f);
    EXPECT_EQ(crossings(s, state), 0);
    way[k] = state.position[2] - before[2];
  }
  EXPECT_GT(way[0], 0.06);
  EXPECT_LT(way[1], 0.04);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
