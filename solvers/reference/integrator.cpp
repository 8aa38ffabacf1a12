#include "integrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clothbench::reference {
namespace {

constexpr int kMostIterations = 60;

Vector masses3(const Model& m) {
  Vector out(static_cast<Eigen::Index>(3 * m.vertices()));
  for (std::size_t v = 0; v < m.vertices(); ++v)
    out.segment<3>(static_cast<Eigen::Index>(3 * v)).setConstant(m.mass()[v]);
  return out;
}

/// The entries of free vertices of a vector with 3 entries per vertex.
Vector gather(const Model& m, const Vector& full) {
  Vector out(m.free_dofs());
  for (std::size_t v = 0; v < m.vertices(); ++v)
    if (!m.held(v)) out.segment<3>(m.dof(v)) = full.segment<3>(static_cast<Eigen::Index>(3 * v));
  return out;
}

void put_held(const Model& m, const Vector& from, Vector& to) {
  for (std::size_t v = 0; v < m.vertices(); ++v)
    if (m.held(v)) to.segment<3>(static_cast<Eigen::Index>(3 * v)) = from.segment<3>(static_cast<Eigen::Index>(3 * v));
}

void add_mass(const Model& m, double scale, Triplets& out) {
  for (std::size_t v = 0; v < m.vertices(); ++v)
    if (!m.held(v))
      for (int k = 0; k < 3; ++k) out.emplace_back(m.dof(v) + k, m.dof(v) + k, scale * m.mass()[v]);
}

double largest(const Vector& v) {
  double most = 0;
  for (double x : v) most = std::abs(x) <= most ? most : std::abs(x);  // the comparison lets NaN through
  return most;
}

/// One implicit step in the unknowns y (where forces are evaluated) and lambda:
///   M (mass_scale * (y - base)) = force(y) - G(y)^T lambda,   C(y) = compliance * lambda.
/// Both implicit integrators have this form.
StepStatus solve_implicit(Model& m, SaddlePoint& system, const Tolerance& tolerance, double mass_scale,
                          const Vector& base, Vector& y, Vector& lambda) {
  const int n = m.free_dofs(), all = n + static_cast<int>(m.springs());
  const Vector mass = masses3(m);
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostIterations; ++i) {
    Vector f = m.force(y);
    m.add_tension(y, lambda, f);
    const Vector r = f - mass_scale * mass.cwiseProduct(y - base);
    const Vector c = m.elongations(lambda) - m.constraints(y);
    Vector rhs(all);
    rhs << gather(m, r), c;
    const double residual = std::max(largest(gather(m, r.cwiseQuotient(mass))), mass_scale * largest(c));
    Triplets lower;
    add_mass(m, mass_scale, lower);
    m.add_stiffness(y, lambda, lower);
    m.add_gradient(y, n, lower);
    m.add_compliance(1, n, lower);
    system.solve(all, lower, rhs);
    if (!system.ok() || !rhs.allFinite()) return StepStatus::NotFinite;
    for (std::size_t v = 0; v < m.vertices(); ++v)
      if (!m.held(v)) y.segment<3>(static_cast<Eigen::Index>(3 * v)) += rhs.segment<3>(m.dof(v));
    lambda += rhs.tail(all - n);
    // With very stiff bending of tiny cells, rounding may exceed the tolerance. The residual then stops falling.
    const bool at_rounding = i > 0 && residual > 0.5 * before;
    if ((residual <= tolerance.acceleration || at_rounding) && largest(rhs.head(n)) <= tolerance.length_m)
      return StepStatus::Ok;
    before = residual;
  }
  return StepStatus::Diverged;
}

/// BDF2; the first step is backward Euler.
class Bdf2 final : public Integrator {
 public:
  using Integrator::Integrator;

  void restart() override {
    Integrator::restart();
    before_.x.resize(0);
  }

  StepStatus step(State& s, const Vector& held_x, double h) override {
    const bool first = before_.x.size() == 0 || h != h_;
    if (first) system_.forget();
    const double c = model_.damping_per_s();
    // dx/dt = (k0 x + px)/h and dv/dt = (k0 v + pv)/h at the step's end; px, pv: the history.
    const double k0 = first ? 1.0 : 1.5;
    const Vector px = first ? Vector(-s.x) : Vector(-2 * s.x + 0.5 * before_.x);
    const Vector pv = first ? Vector(-s.v) : Vector(-2 * s.v + 0.5 * before_.v);
    // M ((k0 (k0 x + px)/h + pv)/h + c (k0 x + px)/h) = F, in the form M mass_scale (x - base) = F.
    const double a = k0 / h * (k0 / h + c);
    const Vector base = -((k0 / h + c) / h * px + pv / h) / a;
    Vector x = s.x + h * s.v, lambda = s.lambda;
    put_held(model_, held_x, x);
    const StepStatus status = solve_implicit(model_, system_, tolerance_, a, base, x, lambda);
    if (status != StepStatus::Ok) return status;
    const Vector v = (k0 * x + px) / h;
    before_ = s;
    h_ = h;
    s = {x, v, lambda};
    return StepStatus::Ok;
  }

 private:
  State before_;
  double h_ = 0;
};

class Midpoint final : public Integrator {
 public:
  using Integrator::Integrator;

  StepStatus step(State& s, const Vector& held_x, double h) override {
    // M (v' - v)/h + c M (v + v')/2 = F(y) at the midpoint y = (x + x')/2, with x', v' at the step's end.
    // x' = x + h (v + v')/2, so (v + v')/2 = 2 (y - x)/h and v' - v = 4 (y - x)/h - 2 v.
    const double c = model_.damping_per_s(), a = 4 / (h * h) + 2 * c / h;
    const Vector base = s.x + 2 / h * s.v / a;
    Vector y = s.x + h / 2 * s.v, lambda = s.lambda;
    put_held(model_, Vector(0.5 * (s.x + held_x)), y);
    const StepStatus status = solve_implicit(model_, system_, tolerance_, a, base, y, lambda);
    if (status != StepStatus::Ok) return status;
    const Vector v = 4 / h * (y - s.x) - s.v;
    s = {2 * y - s.x, v, lambda};
    return StepStatus::Ok;
  }
};

class Rattle final : public Integrator {
 public:
  using Integrator::Integrator;

  StepStatus step(State& s, const Vector& held_x, double h) override {
    if (!(h * model_.highest_bending_frequency() < 2)) return StepStatus::Diverged;
    const Vector mass = masses3(model_);
    const double keep = std::exp(-model_.damping_per_s() * h / 2);  // damping, half a step before and half after
    const Vector v_half = keep * s.v + h / 2 * model_.force(s.x).cwiseQuotient(mass);
    Vector x = s.x + h * v_half, lambda = s.lambda;
    put_held(model_, held_x, x);
    if (const StepStatus status = to_manifold(s.x, h, mass, x, lambda); status != StepStatus::Ok) return status;
    Vector v = keep * ((x - s.x) / h + h / 2 * model_.force(x).cwiseQuotient(mass));
    for (std::size_t i = 0; i < model_.vertices(); ++i)
      if (model_.held(i))
        v.segment<3>(static_cast<Eigen::Index>(3 * i)) = ((x - s.x) / h).segment<3>(static_cast<Eigen::Index>(3 * i));
    if (const StepStatus status = to_tangent(x, mass, v); status != StepStatus::Ok) return status;
    s = {x, v, lambda};
    return StepStatus::Ok;
  }

 private:
  /// x <- x - h^2/2 M^-1 G(from)^T lambda with C(x) = 0, by Newton on lambda with the Jacobian G(x) M^-1 G(from)^T
  /// replaced by the symmetric one at `from`; the fixed point is the same.
  StepStatus to_manifold(const Vector& from, double h, const Vector& mass, Vector& x, Vector& lambda) {
    const double scale = h * h / 2;
    const Vector free = x;
    for (int i = 0; i < kMostIterations; ++i) {
      Vector pull = Vector::Zero(x.size());
      model_.add_tension(from, lambda, pull);
      for (std::size_t v = 0; v < model_.vertices(); ++v)
        if (!model_.held(v)) {
          const auto k = static_cast<Eigen::Index>(3 * v);
          x.segment<3>(k) = free.segment<3>(k) + scale * pull.segment<3>(k) / mass[k];
        }
      const Vector c = model_.constraints(x);
      if (!c.allFinite()) return StepStatus::NotFinite;
      if (largest(c) <= tolerance_.length_m) return StepStatus::Ok;
      const Vector correction = multipliers(from, c);
      if (!system_.ok()) return StepStatus::NotFinite;
      lambda += correction / scale;
    }
    return StepStatus::Diverged;
  }

  StepStatus to_tangent(const Vector& x, const Vector& mass, Vector& v) {
    Vector rate = Vector::Zero(static_cast<Eigen::Index>(model_.springs()));
    for (std::size_t s = 0; s < model_.springs(); ++s) {
      const Spring& k = model_.spring_list()[s];
      const Eigen::Vector3d d = x.segment<3>(3 * k.b) - x.segment<3>(3 * k.a),
                            dv = v.segment<3>(3 * k.b) - v.segment<3>(3 * k.a);
      rate[static_cast<Eigen::Index>(s)] = d.normalized().dot(dv);
    }
    const Vector impulse = multipliers(x, rate);
    if (!system_.ok()) return StepStatus::NotFinite;
    Vector pull = Vector::Zero(x.size());
    model_.add_tension(x, impulse, pull);
    for (std::size_t i = 0; i < model_.vertices(); ++i)
      if (!model_.held(i))
        v.segment<3>(static_cast<Eigen::Index>(3 * i)) +=
            pull.segment<3>(static_cast<Eigen::Index>(3 * i)) / mass[static_cast<Eigen::Index>(3 * i)];
    return v.allFinite() ? StepStatus::Ok : StepStatus::NotFinite;
  }

  /// lambda with G M^-1 G^T lambda = c, from [M G^T; G 0] [y; -lambda] = [0; -c].
  Vector multipliers(const Vector& x, const Vector& c) {
    const int n = model_.free_dofs(), all = n + static_cast<int>(model_.springs());
    Triplets lower;
    add_mass(model_, 1, lower);
    model_.add_gradient(x, n, lower);
    model_.add_compliance(0, n, lower);
    Vector rhs(all);
    rhs << Vector::Zero(n), -c;
    system_.solve(all, lower, rhs);
    return rhs.tail(all - n);
  }
};

}  // namespace

/// Without compliance the lower block is 0, and a factorisation without pivoting meets zero pivots. So its diagonal is
/// shifted below 0 (quasi-definite: every ordering works, Vanderbei 1995); iterative refinement removes the error.
void SaddlePoint::solve(int size, const Triplets& lower, Vector& rhs) {
  constexpr double kShift =
      1e-9;  // relative to the largest diagonal entry of G A^-1 G^T, estimated as 2 / (smallest diagonal entry of A)
  constexpr int kRefinements = 6;
  Eigen::SparseMatrix<double> K(size, size);
  K.setFromTriplets(lower.begin(), lower.end());
  Eigen::SparseMatrix<double> shifted = K;
  double least = INFINITY;
  for (int k = 0; k < size; ++k)
    if (K.coeff(k, k) > 0) least = std::min(least, K.coeff(k, k));
  for (int k = 0; k < size; ++k)
    if (!(K.coeff(k, k) > 0)) shifted.coeffRef(k, k) -= kShift * 2 / least;
  if (!analysed_) {
    ldlt_.analyzePattern(shifted);
    analysed_ = true;
  }
  ldlt_.factorize(shifted);
  ok_ = ldlt_.info() == Eigen::Success;
  if (!ok_) return;
  const Vector b = rhs;
  rhs = ldlt_.solve(b);
  double before = INFINITY;
  for (int i = 0; i < kRefinements; ++i) {
    const Vector r = b - K.selfadjointView<Eigen::Lower>() * rhs;
    const double size_of_r = r.norm();
    if (!(size_of_r < 0.5 * before)) break;
    before = size_of_r;
    rhs += ldlt_.solve(r);
  }
}

std::unique_ptr<Integrator> make_integrator(bool conservative, Model& m, Tolerance t) {
  if (!conservative) return std::make_unique<Bdf2>(m, t);
  if (m.inextensible()) return std::make_unique<Rattle>(m, t);
  return std::make_unique<Midpoint>(m, t);
}

}  // namespace clothbench::reference
