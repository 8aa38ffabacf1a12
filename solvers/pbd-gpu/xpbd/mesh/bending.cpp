#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "clothbench/vector.hpp"
#include "xpbd/mesh/matrices.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Vec2 = std::array<double, 2>;
constexpr auto kNone = static_cast<std::uint32_t>(-1);

Vec2 minus2(const Vec2& a, const Vec2& b) { return {a[0] - b[0], a[1] - b[1]}; }
double dot2(const Vec2& a, const Vec2& b) { return a[0] * b[0] + a[1] * b[1]; }
double cross2(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }
double norm2(const Vec2& a) { return std::hypot(a[0], a[1]); }

/// A linear form of the positions.
using Form = std::vector<std::pair<std::uint32_t, double>>;

/// The triangles of a mesh at rest, each unfolded into its own plane, and the one or two triangles at each edge.
class FlatMesh {
 public:
  explicit FlatMesh(const ClothMesh& mesh) : mesh_(mesh), at_edge_(mesh.edges.size(), {kNone, kNone}) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::array<Vec3, 3> p = rest_corners(mesh, t);
      const Vec3 e = minus(p[1], p[0]), f = minus(p[2], p[0]);
      const double l = norm(e);
      flat_.push_back({Vec2{0, 0}, Vec2{l, 0}, Vec2{dot(e, f) / l, norm(cross(e, f)) / l}});
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t at = edge(t, k);
        edges_.push_back(at);
        at_edge_[at][at_edge_[at][0] == kNone ? 0 : 1] = t;
      }
    }
  }

  std::uint32_t corner(std::uint32_t t, int k) const { return mesh_.triangles[t][static_cast<std::size_t>(k % 3)]; }
  const std::array<Vec2, 3>& flat(std::uint32_t t) const { return flat_[t]; }
  std::uint32_t edge_of(std::uint32_t t, int k) const {
    return edges_[3 * std::size_t{t} + static_cast<std::size_t>(k)];
  }
  /// Vector from corner k to the next corner [m].
  Vec2 side(std::uint32_t t, int k) const {
    return minus2(flat_[t][static_cast<std::size_t>((k + 1) % 3)], flat_[t][static_cast<std::size_t>(k % 3)]);
  }
  double area(std::uint32_t t) const { return cross2(flat_[t][1], flat_[t][2]) / 2; }
  std::uint32_t other(std::uint32_t edge, std::uint32_t t) const {
    return at_edge_[edge][0] == t ? at_edge_[edge][1] : at_edge_[edge][0];
  }

 private:
  std::uint32_t edge(std::uint32_t t, int k) const {
    const auto [a, b] = std::minmax({corner(t, k), corner(t, k + 1)});  // by value
    const auto less = [](const Edge& e, const std::pair<std::uint32_t, std::uint32_t>& ends) {
      return std::pair(e.a, e.b) < ends;
    };
    const auto found = std::lower_bound(mesh_.edges.begin(), mesh_.edges.end(), std::pair(a, b), less);
    return static_cast<std::uint32_t>(found - mesh_.edges.begin());
  }

  const ClothMesh& mesh_;
  std::vector<std::array<Vec2, 3>> flat_;
  std::vector<std::uint32_t> edges_;
  std::vector<std::array<std::uint32_t, 2>> at_edge_;
};

/// The triangles near an edge, unfolded into one plane with the edge from (0, 0) to (1, 0), the unit of length.
class Patch {
 public:
  /// The edge starts at corner k of triangle t; t lies to its left.
  Patch(const FlatMesh& mesh, std::uint32_t t, int k) : mesh_(mesh) {
    scale_ = 1 / norm2(mesh.side(t, k));
    vertices_ = {mesh.corner(t, k), mesh.corner(t, k + 1)};
    at_ = {Vec2{0, 0}, Vec2{1, 0}};
    add(t, k, {0, 0}, {1, 0});
    if (const std::uint32_t u = mesh.other(mesh.edge_of(t, k), t); u != kNone)
      add(u, side(u, vertices_[1]), {1, 0}, {0, 0});
    middle_ = vertices_.size();
    from_ = 0;
  }

  /// Adds the neighbours of the triangles added last. False if there are none.
  bool grow() {
    const std::size_t to = added_.size();
    for (; from_ < to; ++from_) {
      const Placed here = added_[from_];
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t u = mesh_.other(mesh_.edge_of(here.triangle, k), here.triangle);
        if (u == kNone || std::any_of(added_.begin(), added_.end(), [u](const Placed& p) { return p.triangle == u; }))
          continue;
        const auto a = static_cast<std::size_t>(k), b = static_cast<std::size_t>((k + 1) % 3);
        add(u, side(u, mesh_.corner(here.triangle, k + 1)), here.corners[b], here.corners[a]);
      }
    }
    return added_.size() > to;
  }

  /// Derivative of the quadratic fitted to the vertices by least squares, at the edge's middle, across it to the left,
  /// per edge length. Vertices of the edge's own triangles weigh more. If several fit equally well, uses the smallest.
  Form derivative_across() const {
    constexpr double kFar = 0.1, kMin = 1e-9;
    constexpr std::size_t kTerms = 6;
    std::array<std::array<double, kTerms + 1>, kTerms> system{};
    const auto terms = [&](std::size_t v) {
      const double u = at_[v][0] - 0.5, w = at_[v][1];
      return std::array<double, kTerms>{1, u, w, u * u, u * w, w * w};
    };
    const auto weight = [&](std::size_t v) { return v < middle_ ? 1 : kFar * kFar; };
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      const std::array<double, kTerms> t = terms(v);
      for (std::size_t i = 0; i < kTerms; ++i)
        for (std::size_t k = 0; k < kTerms; ++k) system[i][k] += weight(v) * t[i] * t[k];
    }
    for (std::size_t i = 3; i < kTerms; ++i) system[i][i] += kMin;
    system[2][kTerms] = 1;
    // Gauss-Jordan: the matrix is positive definite.
    for (std::size_t i = 0; i < kTerms; ++i)
      for (std::size_t r = 0; r < kTerms; ++r) {
        if (r == i) continue;
        const double factor = system[r][i] / system[i][i];
        for (std::size_t k = i; k <= kTerms; ++k) system[r][k] -= factor * system[i][k];
      }
    Form out;
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      const std::array<double, kTerms> t = terms(v);
      double share = 0;
      for (std::size_t i = 0; i < kTerms; ++i) share += t[i] * system[i][kTerms] / system[i][i];
      out.emplace_back(vertices_[v], weight(v) * share);
    }
    return out;
  }

 private:
  struct Placed {
    std::uint32_t triangle;
    std::array<Vec2, 3> corners;
  };

  /// Number of the edge of triangle t that starts at vertex v.
  int side(std::uint32_t t, std::uint32_t v) const {
    int k = 0;
    while (mesh_.corner(t, k) != v) ++k;
    return k;
  }

  /// Places a triangle whose edge k goes from `a` to `b`, to the left of it.
  void add(std::uint32_t t, int k, const Vec2& a, const Vec2& b) {
    const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>((k + 1) % 3),
               o = static_cast<std::size_t>((k + 2) % 3);
    const std::array<Vec2, 3>& p = mesh_.flat(t);
    const Vec2 e = minus2(p[j], p[i]), f = minus2(p[o], p[i]);
    const double along = dot2(e, f) / dot2(e, e), left = cross2(e, f) / dot2(e, e) * norm2(e) * scale_;
    const Vec2 d = minus2(b, a);
    const double l = norm2(d);
    const Vec2 top = {a[0] + along * d[0] - left * d[1] / l, a[1] + along * d[1] + left * d[0] / l};
    Placed placed{t, {}};
    placed.corners[i] = a;
    placed.corners[j] = b;
    placed.corners[o] = top;
    added_.push_back(placed);
    const std::uint32_t v = mesh_.corner(t, k + 2);
    if (std::find(vertices_.begin(), vertices_.end(), v) != vertices_.end()) return;
    vertices_.push_back(v);
    at_.push_back(top);
  }

  const FlatMesh& mesh_;
  double scale_ = 1;
  std::vector<Placed> added_;
  std::vector<std::uint32_t> vertices_;
  std::vector<Vec2> at_;
  std::size_t middle_ = 0, from_ = 0;
};

/// Derivative [1/m] across edge k of triangle t, out of the triangle.
Form across_of(const FlatMesh& mesh, std::uint32_t t, int k) {
  // A fit is good enough if its coefficients' absolute values sum to at most this (regular triangles: 2 to 4).
  constexpr double kMaxShares = 5;
  constexpr int kMaxRings = 4;
  Patch patch(mesh, t, k);
  Form form;
  for (int ring = 0; ring < kMaxRings; ++ring) {
    const bool grew = patch.grow();
    form = patch.derivative_across();
    double shares = 0;
    for (const auto& [v, share] : form) shares += std::abs(share);
    if (!grew || (form.size() >= 6 && shares <= kMaxShares)) break;
  }
  for (auto& [v, share] : form) share /= -norm2(mesh.side(t, k));  // the left of the edge is inside the triangle
  return form;
}

/// Derivative [1/m] across edge k, out of triangle t, of the linear interpolation of the triangle's corners.
Form own_across(const FlatMesh& mesh, std::uint32_t t, int k) {
  const auto normal = [&](int side) {  // times length
    const Vec2 e = mesh.side(t, side);
    return Vec2{e[1], -e[0]};
  };
  const Vec2 n = normal(k);
  Form form;
  for (int i = 0; i < 3; ++i)
    form.emplace_back(mesh.corner(t, i), -dot2(normal(i + 1), n) / (2 * mesh.area(t) * norm2(n)));
  return form;
}

/// Second derivatives (xx, yy, sqrt(2) xy) of the position in a triangle, vertex by vertex.
using Curvature = std::vector<std::pair<std::uint32_t, Vec3>>;

class Curvatures {
 public:
  explicit Curvatures(const Scene& s) : mesh_(*s.cloth.mesh), across_(s.cloth.mesh->edges.size()) {
    const std::size_t count = s.cloth.mesh->triangles.size();
    const auto pinned = [&](std::uint32_t v) {
      return std::binary_search(s.pins.vertices.begin(), s.pins.vertices.end(), v);
    };
    owner_.assign(across_.size(), kNone);
    for (std::uint32_t t = 0; t < count; ++t)
      if (pinned(mesh_.corner(t, 0)) && pinned(mesh_.corner(t, 1)) && pinned(mesh_.corner(t, 2)))
        for (int k = 0; k < 3; ++k)
          if (owner_[mesh_.edge_of(t, k)] == kNone) set(t, k, own_across(mesh_, t, k));
    for (std::uint32_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k)
        if (owner_[mesh_.edge_of(t, k)] == kNone) set(t, k, across_of(mesh_, t, k));
  }

  double area(std::uint32_t t) const { return mesh_.area(t); }

  Curvature of(std::uint32_t t) const {
    std::map<std::uint32_t, Vec3> sum;
    const double area = mesh_.area(t);
    // The mean second derivative is an integral of first derivatives over the border; `of`: their direction.
    const auto add = [&](std::uint32_t v, const Vec2& normal, const Vec2& of, double share) {
      Vec3& to = sum.try_emplace(v, Vec3{}).first->second;
      to[0] += share * normal[0] * of[0] / area;
      to[1] += share * normal[1] * of[1] / area;
      to[2] += share * (normal[0] * of[1] + normal[1] * of[0]) / (std::sqrt(2.0) * area);
    };
    for (int k = 0; k < 3; ++k) {
      const Vec2 e = mesh_.side(t, k);
      const double l = norm2(e);
      const Vec2 normal = {e[1], -e[0]}, along = {e[0] / l, e[1] / l}, outward = {e[1] / l, -e[0] / l};
      add(mesh_.corner(t, k + 1), normal, along, 1 / l);
      add(mesh_.corner(t, k), normal, along, -1 / l);
      const std::uint32_t edge = mesh_.edge_of(t, k);
      const double out = owner_[edge] == t ? 1 : -1;
      for (const auto& [v, share] : across_[edge]) add(v, normal, outward, out * share);
    }
    return {sum.begin(), sum.end()};
  }

 private:
  void set(std::uint32_t t, int k, Form form) {
    owner_[mesh_.edge_of(t, k)] = t;
    across_[mesh_.edge_of(t, k)] = std::move(form);
  }

  FlatMesh mesh_;
  std::vector<Form> across_;          // by edge: the derivative out of the edge's owner
  std::vector<std::uint32_t> owner_;  // by edge: a triangle
};

}  // namespace

BendingMatrix bending_matrix(const Scene& scene) {
  const Curvatures curvatures(scene);
  const std::size_t n = scene.cloth.vertex_count(), count = scene.cloth.mesh->triangles.size();
  std::vector<Curvature> all;
  std::vector<std::vector<std::uint32_t>> at(n);  // triangles whose curvature a vertex is part of
  for (std::uint32_t t = 0; t < count; ++t) {
    all.push_back(curvatures.of(t));
    for (const auto& [v, share] : all[t]) at[v].push_back(t);
  }
  const double B = scene.material.bending_rigidity_N_m;
  BendingMatrix out;
  out.first.push_back(0);
  std::map<std::uint32_t, double> row;
  for (std::uint32_t i = 0; i < n; ++i) {
    row.clear();
    for (const std::uint32_t t : at[i]) {
      const auto mine =
          std::lower_bound(all[t].begin(), all[t].end(), i, [](const auto& p, auto v) { return p.first < v; });
      for (const auto& [v, share] : all[t])
        if (v != i) row[v] += B * curvatures.area(t) * dot(mine->second, share);
    }
    for (const auto& [v, stiffness] : row) {
      out.columns.push_back(v);
      out.stiffness.push_back(stiffness);
    }
    out.first.push_back(static_cast<std::uint32_t>(out.columns.size()));
  }
  // A is the matrix of absolute values.
  out.max_per_s2 = eigenvalue_bound(vertex_masses(scene), [&](const auto& v, auto& to) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      double diagonal = 0, sum = 0;
      for (std::uint32_t e = out.first[i]; e < out.first[i + 1]; ++e) {
        diagonal -= out.stiffness[e];
        sum += std::abs(out.stiffness[e]) * v[out.columns[e]];
      }
      to[i] = sum + std::abs(diagonal) * v[i];
    }
  });
  return out;
}

std::uint32_t bending_iterations(double largest) {
  constexpr double kReleased = 1e-3;
  constexpr std::uint32_t kMax = 1000;
  const double root = std::sqrt(1 + largest), rate = (root - 1) / (root + 1);
  if (!(rate > 0)) return 2;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(std::log(kReleased / 2) / std::log(rate)), 2.0, double{kMax}));
}

SlicedRows<BendingEntry> bending_table(const BendingMatrix& K) {
  const auto n = static_cast<std::uint32_t>(K.first.size() - 1);
  const auto length = [&](std::uint32_t i) { return K.first[i + 1] - K.first[i]; };
  return sliced<BendingEntry>(n, length, [&](std::uint32_t i, std::uint32_t j) {
    if (i >= n || j >= length(i)) return BendingEntry{std::min(i, n - 1), 0};
    return BendingEntry{K.columns[K.first[i] + j], static_cast<float>(K.stiffness[K.first[i] + j])};
  });
}

}  // namespace clothbench::pbd_gpu
