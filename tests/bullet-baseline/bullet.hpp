#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "sheets.hpp"

namespace clothbench {

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

inline ClothState from_start(ClothSolver& solver, const Scene& s, int frames) {
  solver.load(s);
  return after(solver, s, frames);
}

/// A test for each of the two solvers; physics_test.cpp names them.
class Bullet : public ::testing::TestWithParam<std::string> {};

}  // namespace clothbench
