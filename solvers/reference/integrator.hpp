#pragma once
#include <Eigen/SparseCholesky>
#include <memory>

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

/// Factorises the saddle-point systems [A G^T; G -D] of successive steps; the sparsity pattern is analysed once.
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
  /// At the end of the step, held vertices are at `held_x` (3 * vertices; entries of other vertices are ignored).
  virtual StepStatus step(State& state, const Vector& held_x, double h) = 0;
  /// Forgets earlier steps; call it too after a change of the held vertices.
  virtual void restart() { system_.forget(); }

 protected:
  Model& model_;
  const Tolerance tolerance_;
  SaddlePoint system_;
};

/// BDF2 (first step: backward Euler), positions, velocities and tensions all at the step's end: stiffly accurate,
/// order 2, damps unresolved frequencies. Hairer & Wanner, Solving Ordinary Differential Equations II, V and VII.
std::unique_ptr<Integrator> make_bdf2(Model&, Tolerance);
/// Implicit midpoint with tensions at the midpoint: order 2, conserves momentum, no damping of its own. Compliance > 0.
std::unique_ptr<Integrator> make_midpoint(Model&, Tolerance);
/// RATTLE (Andersen 1983): order 2, symplectic, for compliance 0; bending and gravity explicit.
std::unique_ptr<Integrator> make_rattle(Model&, Tolerance);

}  // namespace clothbench::reference
