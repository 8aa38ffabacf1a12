#pragma once
#include <Eigen/SparseCholesky>
#include <cstdint>
#include <memory>
#include <vector>

#include "clothbench/solver.hpp"

namespace clothbench::reference {

using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// C(x) = |x_b - x_a| - rest, with a multiplier: C = compliance * lambda, so that compliance 0 is a constraint and not
/// a large stiffness. lambda [N] is the tension. The springs of an elastic mesh are three a triangle, along its edges,
/// and their compliance is the triangle's matrix (mesh_energy.hpp).
struct Spring {
  std::uint32_t a, b;
  double rest_m, compliance;
};

/// E = 1/2 stiffness |x_a - 2 x_b + x_c|^2, for a line of equal cells.
struct BendLine {
  std::uint32_t a, b, c;
  double stiffness;  // N/m
};

/// The discrete cloth: springs and bending from the continuum (README), vertex masses, and degrees of freedom.
class Model {
 public:
  explicit Model(const Scene&);

  std::size_t vertices() const { return mass_.size(); }
  std::size_t springs() const { return springs_.size(); }
  const std::vector<Spring>& spring_list() const { return springs_; }
  const std::vector<double>& mass() const { return mass_; }
  bool inextensible() const { return inextensible_; }
  double damping_per_s() const { return damping_per_s_; }

  /// Sets which vertices are held; all keep their state. `held` is 1 for vertices whose position is given.
  void hold(const std::vector<std::uint8_t>& held);
  bool held(std::size_t vertex) const { return dof_[vertex] < 0; }
  /// First degree of freedom of a free vertex; negative if held.
  int dof(std::size_t vertex) const { return dof_[vertex]; }
  int free_dofs() const { return free_dofs_; }

  /// C of every spring at x (3 * vertices).
  Vector constraints(const Vector& x) const;
  /// Elongation of every spring [m] under the tensions lambda.
  Vector elongations(const Vector& lambda) const;
  /// Appends the compliance times -scale at rows and columns `first`..., lower triangle.
  void add_compliance(double scale, int first, Triplets& out) const;
  /// Gravity and bending force [N] at x, 3 * vertices.
  Vector force(const Vector& x) const;
  /// Adds -G(x)^T lambda [N] to `out`, 3 * vertices.
  void add_tension(const Vector& x, const Vector& lambda, Vector& out) const;
  /// Appends d(-force)/dx + sum lambda d^2 C/dx^2 of the free degrees of freedom, lower triangle.
  void add_stiffness(const Vector& x, const Vector& lambda, Triplets& out) const;
  /// Appends G(x) at rows `first_row`...; columns of held vertices left out.
  void add_gradient(const Vector& x, int first_row, Triplets& out) const;

  /// Highest frequency [1/s] of the bending forces, for the explicit integrator's limit.
  double highest_bending_frequency() const;

 private:
  void add_triangles(const Scene&);

  std::vector<double> mass_;
  std::vector<Spring> springs_;
  std::vector<Eigen::Matrix3d> triangles_;  // compliance of three springs each, of an elastic mesh, else empty
  std::vector<BendLine> lines_;
  Eigen::SparseMatrix<double> bending_;  // of a mesh, else empty
  std::vector<int> dof_;
  int free_dofs_ = 0;
  bool inextensible_ = false;
  double damping_per_s_ = 0;
  Eigen::Vector3d gravity_;
};

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
///
/// `conservative`: where the cloth has compliance, the implicit midpoint with tensions at the midpoint: order 2,
/// conserves momentum, no damping of its own. Otherwise RATTLE (Andersen 1983): order 2, symplectic; explicit forces.
std::unique_ptr<Integrator> make_integrator(bool conservative, Model&, Tolerance);

}  // namespace clothbench::reference
