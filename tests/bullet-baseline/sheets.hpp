#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// A horizontal sheet round the origin; features are added by the caller.
inline Scene sheet(int columns, int rows, double width = 1, double height = 1) {
  Scene s;
  s.name = "sheet";
  s.cloth.columns = columns;
  s.cloth.rows = rows;
  s.cloth.width_m = width;
  s.cloth.height_m = height;
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

inline Scene with_collider(Scene s, Collider c, double friction = 0.3) {
  c.friction = friction;
  c.margin_m = 0.004;
  if (friction > 0) s.needs.add(Feature::Friction);
  s.needs.add(c.feature());
  s.colliders.push_back(c);
  return s;
}

inline std::unique_ptr<ClothSolver> make_solver(const std::string& name,
                                                const nlohmann::json& given = nlohmann::json::object()) {
  const SolverEntry& e = find_solver(name);
  return e.make(complete_settings(e.info, given), {});
}

/// Steps through frames [from, to) of the scene.
inline ClothState run(ClothSolver& solver, const Scene& s, int from, int to) {
  for (int f = from; f < to; ++f)
    EXPECT_EQ(solver.step({f, (f + 1) * s.time.dt(), s.time.dt(), s.motion_after(f)}), StepStatus::Ok) << "frame " << f;
  ClothState state;
  solver.read_state(state);
  return state;
}

inline ClothState after(ClothSolver& solver, const Scene& s, int frames) {
  solver.load(s);
  return run(solver, s, 0, frames);
}

inline Vec3 vertex(const std::vector<double>& x, std::size_t v) { return {x[3 * v], x[3 * v + 1], x[3 * v + 2]}; }
inline double norm(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// A test for each of the two solvers; physics_test.cpp names them.
class Bullet : public ::testing::TestWithParam<std::string> {};

}  // namespace clothbench
