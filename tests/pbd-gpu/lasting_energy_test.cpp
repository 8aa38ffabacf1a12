// Scenes without input of work end with at most their initial energy, at every quality.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gpu_fixture.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Stretch energy of an isotropic sheet's lattice of square cells: springs of 3/4 Y along the grid, half as much on
/// borders, and 3/8 Y on diagonals; without shear Y along the grid. 0 if the sheet is inextensible.
double spring_energy(const Scene& s, const std::vector<double>& x) {
  if (!s.material.membrane_stiffness_N_per_m) return 0;
  const Cloth& c = s.cloth;
  const double Y = *s.material.membrane_stiffness_N_per_m;
  const bool shear = s.needs.has(Feature::Shear);
  double energy = 0;
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i)
      for (const auto& [di, dj] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}}) {
        const int a = i + di, b = j + dj;
        if (a < 0 || a >= c.columns || b >= c.rows || (di * dj != 0 && !shear)) continue;
        const bool border = dj == 0 ? j == 0 || j == c.rows - 1 : i == 0 || i == c.columns - 1;
        const double along = di * dj != 0 ? 0.375 : (shear ? 0.75 : 1) * (border ? 0.5 : 1);
        const Vec3 link = minus(vertex_at(x, static_cast<std::size_t>(b * c.columns + a)),
                                vertex_at(x, static_cast<std::size_t>(j * c.columns + i)));
        energy += 0.5 * along * Y * std::pow(length(link) - std::hypot(di * c.du(), dj * c.dv()), 2);
      }
  return energy;
}

/// Gain of energy (kinetic, spring and potential) since the start, divided by M g L: mean over the last second.
double lasting_gain(ClothSolver& solver, const Scene& s) {
  const std::vector<double> mass = vertex_masses(s), start = initial_positions(s), speed = initial_velocities(s);
  const auto energy = [&](const std::vector<double>& x, const std::vector<double>& v) {
    double sum = spring_energy(s, x);
    for (std::size_t i = 0; i < mass.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        sum += mass[i] * (0.5 * std::pow(v[3 * i + k], 2) - s.gravity_m_per_s2[k] * (x[3 * i + k] - start[3 * i + k]));
    return sum;
  };
  double total = 0;
  for (const double m : mass) total += m;
  const double scale = total * 9.81 * std::max(s.cloth.width_m, s.cloth.height_m), first = energy(start, speed);
  const int frames = s.time.frames(), last = std::min(frames, static_cast<int>(std::lround(1 / s.time.dt())));
  double lasting = 0;
  for (int f = 0; f < frames; ++f) {
    const ClothState state = after_frame(solver, s, f);
    if (f >= frames - last) lasting += (energy(state.position, state.velocity) - first) / scale / last;
  }
  return lasting;
}

/// The links of a sheet held by one corner have a tension far above the explicit stability limit.
TEST_F(Gpu, ASheetHeldByOneCornerComesToRest) {
  Scene s =
      load_scene("validation/hang-elastic", {"cloth.grid=[33,33]", "material.damping_per_s=1", "time.duration_s=12"});
  s.pins.vertices.resize(1);
  const auto solver = make("xpbd");
  solver->load(s);
  const int frames = s.time.frames(), second = static_cast<int>(std::lround(1 / s.time.dt()));
  double early = 0, late = 0;
  for (int f = 0; f < frames; ++f) {
    const ClothState state = after_frame(*solver, s, f);
    const double energy = spring_energy(s, state.position);
    if (f >= 7 * second && f < 8 * second) early += energy / second;  // it hardly swings any more
    if (f >= frames - second) late += energy / second;
  }
  EXPECT_LE(late, 1.02 * early);
}

struct Case {
  const char* scene;
  std::vector<std::string> set = {};
};
class Energy : public Gpu, public ::testing::WithParamInterface<Case> {};

TEST_P(Energy, DoesNotRiseAtAnyQuality) {
  const Scene s = load_scene(GetParam().scene, GetParam().set);
  for (const char* quality : {"fast", "default", "accurate"}) {
    const auto solver = make("xpbd", {{"quality", quality}});
    solver->load(s);
    EXPECT_LE(lasting_gain(*solver, s), 1e-3) << GetParam().scene << " " << quality;
  }
}

INSTANTIATE_TEST_SUITE_P(
    WithoutWork, Energy,
    ::testing::Values(Case{"validation/swing-strip"}, Case{"validation/hang"}, Case{"validation/hang-elastic"},
                      Case{"validation/hang-elastic", {"material.damping_per_s=0", "time.duration_s=8"}},
                      Case{"validation/hang-elastic",
                           {"material.damping_per_s=0", "material.membrane_stiffness_N_per_m=2000"}},
                      Case{"validation/heavy-strip"}, Case{"validation/pendulum"}, Case{"validation/free-fall"},
                      Case{"stability/s03-step-and-stiffness"}, Case{"stability/s04-heavy-edge"},
                      Case{"stability/s04-heavy-edge-elastic"}, Case{"stability/s16-no-gravity"},
                      Case{"stability/s25-resolution"}, Case{"stability/s26-repeat"}));

}  // namespace
}  // namespace clothbench::pbd_gpu
