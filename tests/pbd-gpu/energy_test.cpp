// What xpbd loses and gains of energy, against backward Euler solved to the end at the same substeps.
#include <cmath>

#include "gpu_fixture.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Kinetic and gravity's energy less that at the start, over M g L, after each frame. Of an inextensible cloth that is
/// all.
std::vector<double> energy_rise(ClothSolver& solver, const Scene& s) {
  const std::vector<double> mass = vertex_masses(s), start = initial_positions(s);
  std::vector<double> out;
  for (int f = 0; f < s.time.frames(); ++f) {
    const ClothState state = after_frame(solver, s, f);
    double energy = 0, total = 0;
    for (std::size_t v = 0; v < mass.size(); ++v) {
      total += mass[v];
      for (std::size_t k = 0; k < 3; ++k)
        energy += mass[v] * (0.5 * std::pow(state.velocity[3 * v + k], 2) -
                             s.gravity_m_per_s2[k] * (state.position[3 * v + k] - start[3 * v + k]));
    }
    out.push_back(energy / (total * 9.81 * s.cloth.width_m));
  }
  return out;
}

TEST_F(Gpu, LosesNoMoreEnergyThanBackwardEulerAndGainsNone) {
  const Scene s = load_scene("validation/swing-strip", {"cloth.grid=[33,5]"});
  for (const int substeps : {3, 5, 10, 20}) {
    const auto ours = make("xpbd", {{"substeps", substeps}});
    ours->load(s);
    const SolverEntry& e = find_solver("reference");
    const auto euler = e.make(complete_settings(e.info, {{"substeps", substeps}, {"integrator", "euler"}}), {});
    euler->load(s);
    const std::vector<double> rise = energy_rise(*ours, s), right = energy_rise(*euler, s);
    ASSERT_LT(right.back(), -1e-3) << "backward Euler loses energy, or this compares nothing";
    for (std::size_t f = 0; f < rise.size(); ++f) {
      EXPECT_LE(rise[f], 1e-3) << substeps << " substeps, frame " << f;
      EXPECT_GE(rise[f], 1.02 * right[f] - 2e-4) << substeps << " substeps, frame " << f;
    }
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
