#include <algorithm>
#include <cmath>

#include "clothbench/vector.hpp"
#include "gpu_fixture.hpp"
#include "metrics/truth_errors.hpp"
#include "scenario/load.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr int kHalfSecond = 36;

TEST_F(Gpu, FreeFallIsExactToTwoMillionthsOfXpbdAndToATenThousandthOfPaper) {
  struct Row {
    const char* solver;
    int n, substeps;
  };
  for (const Row& row : {Row{"xpbd", 8, 10}, {"xpbd", 33, 0}, {"xpbd", 128, 10}, {"paper", 33, 1}, {"paper", 17, 3}}) {
    const Scene s = with_damping(with_bending(sheet(row.n, row.n)));
    const nlohmann::json settings = {{"substeps", row.substeps}};
    const auto solver = make(row.solver, settings);
    solver->load(s);
    const bool xpbd = std::string(row.solver) == "xpbd";
    EXPECT_EQ(solver->plan().substeps, xpbd ? xpbd_substeps(s, settings) : 0);
    const double fall_m =
        xpbd ? xpbd_free_fall_m(s, settings, kHalfSecond) : paper_free_fall_m(s, settings, kHalfSecond);
    EXPECT_LE(free_fall_error(s, after(*solver, s, kHalfSecond), kHalfSecond, fall_m), xpbd ? 2e-6 : 1e-4)
        << row.solver << " " << row.n;
  }
}

TEST_F(Gpu, XpbdDoesNotFreezeWithManySubstepsFarFromTheOrigin) {
  Scene s = sheet(5, 4);
  s.cloth.center_m = {1000, 1000, 1000};
  s.time = {16, 1};
  const nlohmann::json settings = {{"substeps", 256}};  // 4096 per second
  const auto solver = make("xpbd", settings);
  solver->load(s);
  EXPECT_LE(free_fall_error(s, after(*solver, s, 8), 8, xpbd_free_fall_m(s, settings, 8)), 1e-4);
}

/// A stretched, released sheet without gravity keeps its momentum: the motion of its centre of mass.
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
    double fastest = 0;
    for (std::size_t k = 0; k < state.velocity.size(); ++k)
      fastest = std::max(fastest, std::abs(state.velocity[k] - s.cloth.initial_velocity_m_per_s[k % 3]));
    EXPECT_GT(fastest, 0.1) << "the sheet does swing";
    expect_momentum_kept(s, state, 0.5, 1e-5 * fastest, 1e-5 * s.cloth.width_m);
  }
}

TEST_F(Gpu, UniaxialStiffnessIsYOnSquareAndOblongCells) {
  expect_uniaxial_stiffness([] { return make("xpbd", {{"substeps", 40}}); });
}

/// Tethers must not carry the load of elastic cloth, however little its stiff links stretch.
TEST_F(Gpu, StiffStripsHangByTheirLinks) {
  for (const char* Y : {"1000", "30000", "300000"}) {
    const Scene s = load_scene("validation/heavy-strip", {std::string("material.membrane_stiffness_N_per_m=") + Y});
    const auto solver = make("xpbd");
    solver->load(s);
    EXPECT_LE(TruthJudge(s).judge(s.time.frames(), after(*solver, s, s.time.frames())).quantity_error, 0.01) << Y;
  }
}

/// It hangs in folds, where the splitting correction is stable only at smaller steps.
TEST_F(Gpu, ASheetHeldByOneVertexGainsNoEnergy) {
  Scene s = load_scene("validation/hang-elastic",
                       {"cloth.grid=[15,15]", "cloth.size_m=[4.95,4.95]", "cloth.areal_density_kg_per_m2=0.235",
                        "cloth.pose.axis_v=[0,-0.8,0.6]", "material.membrane_stiffness_N_per_m=784000",
                        "material.bending_rigidity_N_m=0.001", "material.damping_per_s=0.63", "time.frame_rate_hz=34"});
  s.pins.vertices = {40};
  const auto solver = make("xpbd", {{"quality", "accurate"}});
  solver->load(s);
  const std::vector<double> x = after(*solver, s, 280).position;
  for (const Edge& e : edges(s.cloth, EdgeKind::Structural))
    EXPECT_LT(length(minus(vertex_at(x, e.b), vertex_at(x, e.a))), 1.005 * e.rest_m) << e.a << " " << e.b;
}

}  // namespace
}  // namespace clothbench::pbd_gpu
