#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"
#include "integrator.hpp"
#include "mesh_energy.hpp"

namespace clothbench::reference {
namespace {

bool pinned(std::uint32_t v, const Scene& s) {
  return std::binary_search(s.pins.vertices.begin(), s.pins.vertices.end(), v);
}

using Map3 = Eigen::Map<const Eigen::Vector3d>;
Map3 at(const Vector& x, std::uint32_t v) { return Map3(x.data() + 3 * v); }

/// Appends the lower triangle's part of a symmetric 3x3 block; skips held vertices (negative row or column).
void add_block(const Eigen::Matrix3d& block, int row, int column, Triplets& out) {
  if (row < 0 || column < 0) return;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      if (row + r >= column + c) out.emplace_back(row + r, column + c, block(r, c));
}

template <class Fn>
void for_each_entry(const Eigen::SparseMatrix<double>& m, Fn&& fn) {
  for (int column = 0; column < m.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(m, column); it; ++it)
      fn(static_cast<std::uint32_t>(it.row()), static_cast<std::uint32_t>(column), it.value());
}

}  // namespace

Model::Model(const Scene& scene) : mass_(vertex_masses(scene)) {
  const Cloth& c = scene.cloth;
  inextensible_ = !scene.material.membrane_stiffness_N_per_m.has_value();
  damping_per_s_ = scene.material.damping_per_s;
  gravity_ = Eigen::Vector3d::Map(scene.gravity_m_per_s2.data());
  for (const StiffnessRegion& r : scene.material.regions)
    if (inextensible_ != !r.membrane_stiffness_N_per_m)
      throw Error("solver reference: /material/regions: expected all regions inextensible, or none");
  if (c.mesh && !inextensible_) add_triangles(scene);
  const auto add = [&](EdgeKind kind) {
    for (const Edge& e : edges(c, kind))
      springs_.push_back(
          {e.a, e.b, e.rest_m, inextensible_ ? 0 : 1 / spring_N_per_m(scene, e, membrane_stiffness(scene, e).value())});
  };
  if (triangles_.empty()) add(EdgeKind::Structural);
  if (scene.needs.has(Feature::Shear)) add(EdgeKind::Shear);
  const double B = scene.material.bending_rigidity_N_m;
  if (scene.needs.has(Feature::Bend) && c.mesh) {
    bending_ = bending_matrix(*c.mesh, B, scene.pins.vertices);
  } else if (scene.needs.has(Feature::Bend)) {
    for (const Edge& e : edges(c, EdgeKind::SkipOne)) {
      const double a = e.rest_m / 2, w = edge_cell(c, e).across_m;
      // Two successive pinned vertices are a clamp. The hinge there covers half a cell, so it is twice as stiff.
      const std::uint32_t b = (e.a + e.b) / 2;
      const bool clamp = pinned(e.a, scene) + pinned(b, scene) + pinned(e.b, scene) == 2 && pinned(b, scene);
      const double share = (on_border(c, e) ? 0.5 : 1) * (clamp ? 2 : 1);
      lines_.push_back({e.a, (e.a + e.b) / 2, e.b, share * B * w / (a * a * a)});
    }
  }
  std::vector<std::uint8_t> held(mass_.size(), 0);
  for (std::uint32_t v : scene.pins.vertices) held[v] = 1;
  for (std::uint32_t v : scene.grips.vertices) held[v] = 1;
  hold(held);
}

void Model::add_triangles(const Scene& scene) {
  const ClothMesh& mesh = *scene.cloth.mesh;
  const std::vector<std::optional<double>> stiffness = triangle_stiffnesses(scene);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<Vec3, 3> rest = rest_corners(mesh, t);
    triangles_.push_back(triangle_compliance(rest, stiffness[t].value()));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const double length = (Eigen::Vector3d::Map(rest[next].data()) - Eigen::Vector3d::Map(rest[k].data())).norm();
      const auto at = static_cast<Eigen::Index>(k);
      springs_.push_back({mesh.triangles[t][k], mesh.triangles[t][next], length, triangles_[t](at, at)});
    }
  }
}

void Model::hold(const std::vector<std::uint8_t>& held) {
  dof_.assign(mass_.size(), -1);
  free_dofs_ = 0;
  for (std::size_t v = 0; v < mass_.size(); ++v)
    if (held[v] == 0) {
      dof_[v] = free_dofs_;
      free_dofs_ += 3;
    }
}

Vector Model::constraints(const Vector& x) const {
  Vector C(static_cast<Eigen::Index>(springs_.size()));
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    // The tension of a spring between held vertices has no effect, except in a triangle, where it is coupled to others.
    const bool rigid = triangles_.empty() && held(springs_[s].a) && held(springs_[s].b);
    C[static_cast<Eigen::Index>(s)] =
        rigid ? 0 : (at(x, springs_[s].b) - at(x, springs_[s].a)).norm() - springs_[s].rest_m;
  }
  return C;
}

Vector Model::elongations(const Vector& lambda) const {
  Vector out(lambda.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto first = static_cast<Eigen::Index>(3 * t);
    out.segment<3>(first) = triangles_[t] * lambda.segment<3>(first);
  }
  if (triangles_.empty())
    for (std::size_t s = 0; s < springs_.size(); ++s)
      out[static_cast<Eigen::Index>(s)] = springs_[s].compliance * lambda[static_cast<Eigen::Index>(s)];
  return out;
}

void Model::add_compliance(double scale, int first, Triplets& out) const {
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    add_block(-scale * triangles_[t], first + static_cast<int>(3 * t), first + static_cast<int>(3 * t), out);
  for (std::size_t s = 0; triangles_.empty() && s < springs_.size(); ++s) {
    const int row = first + static_cast<int>(s);
    const Spring& k = springs_[s];
    // A spring between two attached vertices has no effect: its row sets lambda = 0.
    out.emplace_back(row, row, held(k.a) && held(k.b) ? -1 : -scale * k.compliance);
  }
}

Vector Model::force(const Vector& x) const {
  Vector f(x.size());
  for (std::size_t v = 0; v < mass_.size(); ++v) f.segment<3>(static_cast<Eigen::Index>(3 * v)) = mass_[v] * gravity_;
  for (const BendLine& l : lines_) {
    const Eigen::Vector3d pull = l.stiffness * (at(x, l.a) - 2 * at(x, l.b) + at(x, l.c));
    f.segment<3>(3 * l.a) -= pull;
    f.segment<3>(3 * l.b) += 2 * pull;
    f.segment<3>(3 * l.c) -= pull;
  }
  for_each_entry(bending_, [&](std::uint32_t i, std::uint32_t j, double k) { f.segment<3>(3 * i) -= k * at(x, j); });
  return f;
}

void Model::add_tension(const Vector& x, const Vector& lambda, Vector& out) const {
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const Eigen::Vector3d n =
        (at(x, springs_[s].b) - at(x, springs_[s].a)).normalized() * lambda[static_cast<Eigen::Index>(s)];
    out.segment<3>(3 * springs_[s].a) += n;
    out.segment<3>(3 * springs_[s].b) -= n;
  }
}

void Model::add_stiffness(const Vector& x, const Vector& lambda, Triplets& out) const {
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const Eigen::Vector3d d = at(x, springs_[s].b) - at(x, springs_[s].a);
    const double length = d.norm();
    const Eigen::Vector3d n = d / length;
    const Eigen::Matrix3d H =
        lambda[static_cast<Eigen::Index>(s)] / length * (Eigen::Matrix3d::Identity() - n * n.transpose());
    const int a = dof_[springs_[s].a], b = dof_[springs_[s].b];
    add_block(H, a, a, out);
    add_block(H, b, b, out);
    add_block(-H, std::max(a, b), std::min(a, b), out);
  }
  constexpr double kStencil[3] = {1, -2, 1};
  for (const BendLine& l : lines_) {
    const int dof[3] = {dof_[l.a], dof_[l.b], dof_[l.c]};
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 3; ++q)
        if (dof[p] >= dof[q])
          add_block(l.stiffness * kStencil[p] * kStencil[q] * Eigen::Matrix3d::Identity(), dof[p], dof[q], out);
  }
  for_each_entry(bending_, [&](std::uint32_t i, std::uint32_t j, double k) {
    if (dof_[i] >= dof_[j]) add_block(k * Eigen::Matrix3d::Identity(), dof_[i], dof_[j], out);
  });
}

void Model::add_gradient(const Vector& x, int first_row, Triplets& out) const {
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const Eigen::Vector3d n = (at(x, springs_[s].b) - at(x, springs_[s].a)).normalized();
    const int row = first_row + static_cast<int>(s), a = dof_[springs_[s].a], b = dof_[springs_[s].b];
    for (int k = 0; k < 3; ++k) {
      if (a >= 0) out.emplace_back(row, a + k, -n[k]);
      if (b >= 0) out.emplace_back(row, b + k, n[k]);
    }
  }
}

double Model::highest_bending_frequency() const {
  // Gershgorin's bound. The absolute values in the rows of a BendLine's matrix sum to 4, 8 and 4 times its stiffness.
  std::vector<double> row(mass_.size(), 0);
  for (const BendLine& l : lines_) {
    row[l.a] += 4 * l.stiffness;
    row[l.b] += 8 * l.stiffness;
    row[l.c] += 4 * l.stiffness;
  }
  for_each_entry(bending_, [&](std::uint32_t i, std::uint32_t, double k) { row[i] += std::abs(k); });
  double square = 0;
  for (std::size_t v = 0; v < mass_.size(); ++v) square = std::max(square, row[v] / mass_[v]);
  return std::sqrt(square);
}

}  // namespace clothbench::reference
