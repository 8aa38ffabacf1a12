#include <algorithm>
#include <cmath>

#include "gpu_fixture.hpp"
#include "metrics/truth_errors.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Greatest distance from the closed form over g T^2 / 2, vertices of any tilt.
double free_fall_error(ClothSolver& solver, const Scene& s, int frames, double fall_m) {
  const std::vector<double> start = initial_positions(s);
  const ClothState state = after(solver, s, frames);
  const double t = frames * s.time.dt(), scale = 0.5 * 9.81 * t * t;
  double worst = 0;
  for (std::size_t k = 0; k < start.size(); ++k) {
    const double d = std::abs(state.position[k] - start[k] - (k % 3 == 1 ? fall_m : 0)) / scale;
    worst = d <= worst ? worst : d;
  }
  return worst;
}

constexpr int kHalfSecond = 36;

TEST_F(Gpu, FreeFallIsExactToTwoMillionthsOfXpbdAndToATenThousandthOfPaper) {
  struct Row {
    const char* solver;
    int n, substeps;
  };
  for (const Row& row : {Row{"xpbd", 8, 10},
                         {"xpbd", 33, 10},
                         {"xpbd", 64, 10},
                         {"xpbd", 128, 10},
                         {"paper", 8, 1},
                         {"paper", 33, 1},
                         {"paper", 64, 1},
                         {"paper", 17, 3}}) {
    const Scene s = with_damping(with_bending(sheet(row.n, row.n)));
    const nlohmann::json settings = {{"substeps", row.substeps}};
    const auto solver = make(row.solver, settings);
    solver->load(s);
    const bool xpbd = std::string(row.solver) == "xpbd";
    const double fall_m =
        xpbd ? xpbd_free_fall_m(s, settings, kHalfSecond) : paper_free_fall_m(s, settings, kHalfSecond);
    EXPECT_LE(free_fall_error(*solver, s, kHalfSecond, fall_m), xpbd ? 2e-6 : 1e-4) << row.solver << " " << row.n;
  }
}

TEST_F(Gpu, XpbdDoesNotFreezeWithManySubstepsFarFromTheOrigin) {
  Scene s = sheet(5, 4);
  s.cloth.center_m = {1000, 1000, 1000};
  s.time = {16, 1};
  const nlohmann::json settings = {{"substeps", 256}};  // 4096 a second
  const auto solver = make("xpbd", settings);
  solver->load(s);
  EXPECT_LE(free_fall_error(*solver, s, 8, xpbd_free_fall_m(s, settings, 8)), 1e-4);
}

/// A sheet that was stretched and let go, without gravity: what its centre of mass does.
TEST_F(Gpu, XpbdKeepsMomentum) {
  for (const int columns : {17, 33}) {
    Scene s = with_bending(sheet(columns, 17));
    s.cloth.axis_u = {1.05, 0, 0};
    s.cloth.axis_v = {0, 0.2, 1};
    s.cloth.initial_velocity_m_per_s = {0.3, -0.2, 0.1};
    s.gravity_m_per_s2 = {};
    const auto solver = make("xpbd", {{"substeps", 20}});
    solver->load(s);
    const ClothState state = after(*solver, s, 36);
    const std::vector<double> mass = vertex_masses(s), start = initial_positions(s);
    double total = 0, fastest = 0;
    Vec3 p{}, moved{};
    for (std::size_t i = 0; i < mass.size(); ++i) {
      total += mass[i];
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] += mass[i] * state.velocity[3 * i + k];
        moved[k] += mass[i] * (state.position[3 * i + k] - start[3 * i + k]);
        fastest = std::max(fastest, std::abs(state.velocity[3 * i + k] - s.cloth.initial_velocity_m_per_s[k]));
      }
    }
    EXPECT_GT(fastest, 0.1) << "the sheet does swing";
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(p[k] / total, s.cloth.initial_velocity_m_per_s[k], 1e-5 * fastest) << columns;
      EXPECT_NEAR(moved[k] / total, 0.5 * s.cloth.initial_velocity_m_per_s[k], 1e-5 * s.cloth.width_m) << columns;
    }
  }
}

TEST_F(Gpu, UniaxialStiffnessIsYOnSquareAndOblongCells) {
  // Energy of a uniformly stretched sheet of the springs, minimised over the lateral strain by the solver itself: a
  // strip hangs by one edge and its lower end sinks by rho g L^2 / 2 Y.
  for (double cell_ratio : {1.0, 1.4}) {
    Scene s = with_damping(sheet(9, 33, 8 * cell_ratio / 32, 1));
    s.cloth.axis_v = {0, -1, 0};
    s.material.damping_per_s = 5;
    s.material.membrane_stiffness_N_per_m = 100;
    for (int i = 0; i < 9; ++i) s.pins.vertices.push_back(static_cast<std::uint32_t>(i));
    s.needs.add(Feature::Pins);
    const auto solver = make("xpbd", {{"substeps", 40}});
    solver->load(s);
    const ClothState state = after(*solver, s, 216);
    const double expected = 0.2 * 9.81 / (2 * 100.0);
    const std::size_t middle_of_last_row = 3 * (32 * 9 + 4) + 1;
    // The clamped edge cannot contract sideways, which stiffens the first few cells; hence 5 %.
    EXPECT_NEAR(-(state.position[middle_of_last_row] + 0.5), expected, 0.05 * expected) << cell_ratio;
  }
}

/// Tethers must not carry the load of elastic cloth, however short its stiff links stretch.
TEST_F(Gpu, StiffStripsHangByTheirLinks) {
  for (const char* Y : {"1000", "30000", "300000"}) {
    const Scene s = load_scene("validation/heavy-strip", {std::string("material.membrane_stiffness_N_per_m=") + Y});
    const auto solver = make("xpbd");
    solver->load(s);
    EXPECT_LE(TruthJudge(s).judge(s.time.frames(), after(*solver, s, s.time.frames())).quantity_error, 0.01) << Y;
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
