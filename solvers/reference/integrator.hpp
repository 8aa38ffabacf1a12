#pragma once
#include <Eigen/SparseCholesky>
#include <cstdint>
#include <memory>
#include <vector>

#include "clothbench/solver.hpp"

namespace clothbench::reference {

using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// C(x) = |x_b - x_a| - rest = compliance * lambda. lambda [N], the tension, is an unknown, so that compliance 0 is a
/// constraint and not a large stiffness. An elastic mesh has three springs per triangle, along its edges; their
/// compliance is the triangle's matrix (mesh_energy.hpp).
struct Spring {
  std::uint32_t a, b;
  double rest_m, compliance;
};

/// Bending of three successive vertices of a grid line with equal cells: E = 1/2 stiffness |x_a - 2 x_b + x_c|^2.
struct BendLine {
  std::uint32_t a, b, c;
  double stiffness;  // N/m
};

/// The discretised cloth: springs and bending from the continuum (README), vertex masses, and degrees of freedom.
class Model {
 public:
  explicit Model(const Scene&);

  std::size_t vertices() const { return mass_.size(); }
  std::size_t springs() const { return springs_.size(); }
  const std::vector<Spring>& spring_list() const { return springs_; }
  const std::vector<double>& mass() const { return mass_; }
  bool inextensible() const { return inextensible_; }
  double damping_per_s() const { return damping_per_s_; }

  /// Sets which vertices are held. `held` is 1 for vertices whose position is prescribed.
  void hold(const std::vector<std::uint8_t>& held);
  bool held(std::size_t vertex) const { return dof_[vertex] < 0; }
  /// First degree of freedom of a free vertex; negative if held.
  int dof(std::size_t vertex) const { return dof_[vertex]; }
  int free_dofs() const { return free_dofs_; }

  /// C of every spring at x (3 * vertices).
  Vector constraints(const Vector& x) const;
  /// Elongation of every spring [m] under the tensions lambda.
  Vector elongations(const Vector& lambda) const;
  /// Appends -scale times the compliance matrix, lower triangle, with rows and columns from `first` on.
  void add_compliance(double scale, int first, Triplets& out) const;
  /// Gravity and bending force [N] at x, 3 * vertices.
  Vector force(const Vector& x) const;
  /// Adds -G(x)^T lambda [N] to `out`, 3 * vertices.
  void add_tension(const Vector& x, const Vector& lambda, Vector& out) const;
  /// Appends d(-force)/dx + sum lambda d^2 C/dx^2 in the free degrees of freedom, lower triangle.
  void add_stiffness(const Vector& x, const Vector& lambda, Triplets& out) const;
  /// Appends G(x) = dC/dx, with rows from `first_row` on, without columns of held vertices.
  void add_gradient(const Vector& x, int first_row, Triplets& out) const;

  /// Highest frequency [1/s] of the bending forces, for the explicit integrator's limit.
  double highest_bending_frequency() const;

 private:
  void add_triangles(const Scene&);

  std::vector<double> mass_;
  std::vector<Spring> springs_;
  std::vector<Eigen::Matrix3d> triangles_;  // of an elastic mesh: compliance of three springs each; otherwise empty
  std::vector<BendLine> lines_;
  Eigen::SparseMatrix<double> bending_;  // bending matrix of a mesh; otherwise empty
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

/// Newton's method in an implicit step stops if both limits are met; in RATTLE, if all |C| are below `length_m`.
struct Tolerance {
  double acceleration = 0;  ///< limit of residuals [m/s^2]: M^-1 r, and mass_scale times constraint residuals
  double length_m = 0;      ///< limit of the last correction
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
  /// `held_x`: positions of held vertices at the step's end (3 * vertices; entries of other vertices are ignored).
  virtual StepStatus step(State& state, const Vector& held_x, double h) = 0;
  /// Forgets earlier steps; call it also after a change of the held vertices.
  virtual void restart() { system_.forget(); }

 protected:
  Model& model_;
  const Tolerance tolerance_;
  SaddlePoint system_;
};

/// Default: BDF2 (first step: backward Euler) with x, v and tensions at the step's end: stiffly accurate, order 2,
/// damps unresolved frequencies. Hairer & Wanner, Solving Ordinary Differential Equations II, V and VII.
///
/// `conservative`: for elastic cloth the implicit midpoint rule with tensions at the midpoint: order 2, conserves
/// momentum, no numerical damping. For inextensible cloth RATTLE (Andersen 1983): order 2, symplectic; explicit forces.
std::unique_ptr<Integrator> make_integrator(bool conservative, Model&, Tolerance);

}  // namespace clothbench::reference
