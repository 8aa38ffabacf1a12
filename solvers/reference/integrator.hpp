#pragma once
#include <Eigen/SparseCholesky>
#include <memory>
#include <string>

#include "clothbench/solver.hpp"
#include "model.hpp"

namespace clothbench::reference {

/// Positions, velocities (3 * vertices) and spring tensions.
struct State {
  Vector x, v, lambda;
};

/// When Newton's method stops: both must hold.
struct Tolerance {
  double acceleration = 0;  ///< of the residual, M^-1 r [m/s^2], and of the constraints' velocity
  double length_m = 0;      ///< of the last correction
};

/// Factorised saddle-point systems [A G^T; G -D] of one step after another; the pattern is analysed once.
class SaddlePoint {
 public:
  void solve(int size, const Triplets& lower, Vector& rhs);
  void forget() { analysed_ = false; }
  bool ok() const { return ok_; }

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> ldlt_;
  bool analysed_ = false, ok_ = true;
};

/// Advances a state by one step.
class Integrator {
 public:
  Integrator(Model& model, Tolerance tolerance) : model_(model), tolerance_(tolerance) {}
  virtual ~Integrator() = default;
  /// Held vertices are at `held_x` (3 * vertices; only their entries count) at the end of the step.
  virtual StepStatus step(State& state, const Vector& held_x, double h) = 0;
  /// Forgets earlier steps; also after a change of what is held.
  virtual void restart() { system_.forget(); }

 protected:
  Model& model_;
  const Tolerance tolerance_;
  SaddlePoint system_;
};

/// BDF2 (the first step backward Euler), positions, velocities and tensions all at the step's end: stiffly accurate,
/// order 2, damps what it can't resolve. Hairer & Wanner, Solving Ordinary Differential Equations II, V and VII.
std::unique_ptr<Integrator> make_bdf2(Model&, Tolerance);
/// Backward Euler, solved to the end: order 1; what small-step methods lose of energy is measured against it.
std::unique_ptr<Integrator> make_euler(Model&, Tolerance);
/// Implicit midpoint with tensions at the midpoint: order 2, conserves momentum, no damping of its own. Compliance > 0.
std::unique_ptr<Integrator> make_midpoint(Model&, Tolerance);
/// RATTLE (Andersen 1983): order 2, symplectic, for compliance 0; bending and gravity explicit.
std::unique_ptr<Integrator> make_rattle(Model&, Tolerance);

}  // namespace clothbench::reference
