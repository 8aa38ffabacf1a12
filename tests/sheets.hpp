#pragma once
// Sheets made without a scene file, for tests of solvers, and checks of their motion.
#include <gtest/gtest.h>

#include <cmath>

#include "clothbench/solver.hpp"
#include "clothbench/vector.hpp"

namespace clothbench {

/// A horizontal sheet about the origin; features are added by the caller.
inline Scene sheet(int columns, int rows, double width_m = 1, double height_m = 1) {
  Scene s;
  s.name = "sheet";
  s.cloth.columns = columns;
  s.cloth.rows = rows;
  s.cloth.width_m = width_m;
  s.cloth.height_m = height_m;
  s.cloth.areal_density_kg_per_m2 = 0.2;
  s.cloth.axis_u = {1, 0, 0};
  s.cloth.axis_v = {0, 0, 1};
  s.material.membrane_stiffness_N_per_m = 1000;
  s.gravity_m_per_s2 = {0, -9.81, 0};
  s.time = {72, 1};
  s.needs = {Feature::Stretch, Feature::Shear};
  return s;
}

inline Scene with_bending(Scene s) {
  s.material.bending_rigidity_N_m = 1e-5;
  s.needs.add(Feature::Bend);
  return s;
}

inline Scene with_damping(Scene s, double per_s = 0.5) {
  s.material.damping_per_s = per_s;
  s.needs.add(Feature::Damping);
  return s;
}

/// Pins the first and the last vertex of the first row.
inline Scene with_pins(Scene s) {
  s.pins.vertices = {0, static_cast<std::uint32_t>(s.cloth.columns - 1)};
  s.needs.add(Feature::Pins);
  return s;
}

/// Steps a loaded solver through frames [from, to) of the scene.
inline ClothState run_frames(ClothSolver& solver, const Scene& s, int from, int to) {
  for (int f = from; f < to; ++f)
    EXPECT_EQ(solver.step({f, (f + 1) * s.time.dt(), s.time.dt(), s.motion_after(f)}), StepStatus::Ok) << "frame " << f;
  ClothState state;
  solver.read_state(state);
  return state;
}
inline ClothState after_frame(ClothSolver& solver, const Scene& s, int frame) {
  return run_frames(solver, s, frame, frame + 1);
}
inline ClothState after(ClothSolver& solver, const Scene& s, int frames) { return run_frames(solver, s, 0, frames); }

/// Maximum error of a coordinate against the closed form of free fall, over g T^2 / 2; NaN if any coordinate is NaN.
inline double free_fall_error(const Scene& s, const ClothState& state, int frames, double fall_m) {
  const std::vector<double> start = initial_positions(s);
  const double t = frames * s.time.dt(), scale = 0.5 * 9.81 * t * t;
  double worst = 0;
  for (std::size_t k = 0; k < start.size(); ++k) {
    const double d = std::abs(state.position[k] - start[k] - (k % 3 == 1 ? fall_m : 0)) / scale;
    worst = d <= worst ? worst : d;
  }
  return worst;
}

/// The centre of mass must keep the scene's velocity. Tolerances: of its speed, and of its displacement.
inline void expect_momentum_kept(const Scene& s, const ClothState& state, double time_s, double speed_m_per_s,
                                 double way_m) {
  const std::vector<double> mass = vertex_masses(s), start = initial_positions(s);
  double total = 0;
  Vec3 p{}, moved{};
  for (std::size_t i = 0; i < mass.size(); ++i) {
    total += mass[i];
    p = plus(p, scaled(mass[i], vertex_at(state.velocity, i)));
    moved = plus(moved, scaled(mass[i], minus(vertex_at(state.position, i), vertex_at(start, i))));
  }
  const Vec3& v = s.cloth.initial_velocity_m_per_s;
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(p[k] / total, v[k], speed_m_per_s) << s.cloth.columns;
    EXPECT_NEAR(moved[k] / total, time_s * v[k], way_m) << s.cloth.columns;
  }
}

/// A strip that hangs by one edge comes to rest: its lower end sinks by rho g L^2 / 2 Y, on square and on oblong cells.
/// The clamped edge cannot contract sideways, which stiffens the first few cells; hence 5 %.
template <class Make>
void expect_uniaxial_stiffness(Make make) {
  for (const double cell_ratio : {1.0, 1.4}) {
    Scene s = with_damping(sheet(9, 33, 8 * cell_ratio / 32, 1), 5);
    s.cloth.axis_v = {0, -1, 0};
    s.material.membrane_stiffness_N_per_m = 100;
    for (std::uint32_t i = 0; i < 9; ++i) s.pins.vertices.push_back(i);
    s.needs.add(Feature::Pins);
    const auto solver = make();
    solver->load(s);
    const double expected = 0.2 * 9.81 / (2 * 100.0), y = vertex_at(after(*solver, s, 216).position, 32 * 9 + 4)[1];
    EXPECT_NEAR(-(y + 0.5), expected, 0.05 * expected) << cell_ratio;
  }
}

}  // namespace clothbench
