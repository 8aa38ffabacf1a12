#include "xpbd_contact_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "xpbd_contact.hpp"

namespace clothbench::pbd_gpu {
namespace {

using V = Eigen::Vector3d;

constexpr double kKeep = 0.02, kSlack = 0.05, kTolerance = 1e-4, kTaken = 0.9, kOther = 0.8;

V vec(const Vec3& v) { return {v[0], v[1], v[2]}; }
V vec(const std::vector<double>& x, std::size_t i) { return {x[3 * i], x[3 * i + 1], x[3 * i + 2]}; }
V mix(const V& a, const V& b, double t) { return a + t * (b - a); }

/// Weights of the point of a triangle nearest to p, by the region of its plane that p lies over (Ericson 2005, 5.1.5).
V nearest_on_triangle(const V& p, const V& a, const V& b, const V& c) {
  const V ab = b - a, ac = c - a, bc = c - b;
  const double d1 = ab.dot(p - a), d2 = ac.dot(p - a), d3 = ab.dot(p - b), d4 = ac.dot(p - b), d5 = ab.dot(p - c),
               d6 = ac.dot(p - c);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = bc.dot(p - b) / bc.squaredNorm();
    return {0, 1 - t, t};
  }
  return V(va, vb, vc) / (va + vb + vc);
}

}  // namespace

ContactReference::ContactReference(const Scene& scene, int substeps, int samples)
    : scene_(scene), substeps_(substeps), samples_(samples) {
  const Cloth& c = scene.cloth;
  const std::vector<double> start = initial_positions(scene);
  for (double m : vertex_masses(scene)) w_.push_back(1 / m);
  for (std::uint32_t p : scene.pins.vertices) w_[p] = 0;
  for (std::size_t i = 0; i < w_.size(); ++i) {
    x.push_back(vec(start, i));
    v.push_back(w_[i] > 0 ? vec(c.initial_velocity_m_per_s) : V(V::Zero()));
  }
  side_ = x;
  const std::size_t steps[] = {1, static_cast<std::size_t>(c.columns), static_cast<std::size_t>(c.columns) + 1};
  for (int k = 0; k < 3 * samples; ++k)
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::size_t j = std::min(i + steps[k / samples], x.size() - 1);
      sample_side_.push_back(mix(x[i], x[j], (k % samples + 1.0) / (samples + 1)));
    }
  for (const Collider& k : scene.colliders)
    marks_.push_back(k.mesh ? edge_marks(k.mesh->positions, k.mesh->triangles) : std::vector<std::uint32_t>());
  least_margin_ = 0.01 * std::min(c.du(), c.dv());
  border_margin_ = 0.72 * std::hypot(c.du(), c.dv()) / (samples + 1);
}

void ContactReference::add_shape(const Collider& c, std::size_t index, const V& at, double now,
                                 std::vector<Piece>& all) const {
  const auto add = [&](double d, const V& n, const V& delta) { all.push_back({d, n, delta, c.margin_m, c.friction}); };
  const V center = vec(c.center_m);
  if (c.shape == Collider::Shape::Plane) add(vec(c.normal).dot(at - center), vec(c.normal), V::Zero());
  if (c.shape == Collider::Shape::Sphere) add((at - center).norm() - c.radius_m, (at - center).normalized(), V::Zero());
  if (c.shape == Collider::Shape::Box) {
    V nearest = center;
    double deepest = -std::numeric_limits<double>::infinity();
    V face = V::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = vec(c.axes[k]).dot(at - center);
      nearest += std::clamp(along, -c.half_extent_m[k], c.half_extent_m[k]) * vec(c.axes[k]);
      if (std::abs(along) - c.half_extent_m[k] > deepest) {
        deepest = std::abs(along) - c.half_extent_m[k];
        face = (along < 0 ? -1 : 1) * vec(c.axes[k]);
      }
    }
    if (deepest > 0)
      add((at - nearest).norm(), (at - nearest).normalized(), V::Zero());
    else
      add(deepest, face, V::Zero());
  }
  for (std::size_t k = 0; k < c.capsules.size(); ++k) {
    const auto motion = static_cast<std::size_t>(frame_);
    const Capsule &s = scene_.motion[motion].colliders[index].capsules[k],
                  &e = scene_.motion[motion + 1].colliders[index].capsules[k];
    const V a = mix(vec(s.a_m), vec(e.a_m), now), ab = mix(vec(s.b_m), vec(e.b_m), now) - a;
    const double t = ab.squaredNorm() > 0 ? std::clamp(ab.dot(at - a) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
    const V d = at - a - t * ab;
    add(d.norm() - s.radius_m, d.normalized(), mix(vec(e.a_m) - vec(s.a_m), vec(e.b_m) - vec(s.b_m), t));
  }
}

void ContactReference::add_mesh(std::size_t index, const V& at, double now, std::vector<Piece>& all) const {
  const Collider& c = scene_.colliders[index];
  const std::vector<double>&start = mesh_start_[index], &end = mesh_end_[index];
  for (std::size_t k = 0; k < c.mesh->triangles.size(); ++k) {
    const auto& t = c.mesh->triangles[k];
    V corner[3], way[3];
    for (std::size_t i = 0; i < 3; ++i) {
      way[i] = vec(end, t[i]) - vec(start, t[i]);
      corner[i] = vec(start, t[i]) + now * way[i];
    }
    const V w = nearest_on_triangle(at, corner[0], corner[1], corner[2]);
    const V d = at - w[0] * corner[0] - w[1] * corner[1] - w[2] * corner[2];
    bool border = false, sharp = false;
    for (int i = 0; i < 3; ++i) {
      border = border || (w[i] == 0 && (marks_[index][k] >> i & 1) != 0);
      sharp = sharp || (w[i] == 0 && (marks_[index][k] >> (3 + i) & 1) != 0);
    }
    const double share = sampling_ && !c.moves() && !border && !sharp ? 0.6 : 1;
    const double margin = border ? std::max(c.margin_m, border_margin_) : share * c.margin_m;
    all.push_back({d.norm(), d.normalized(), w[0] * way[0] + w[1] * way[1] + w[2] * way[2], margin, c.friction});
  }
}

std::vector<ContactReference::Piece> ContactReference::pieces(const V& at, double now) const {
  std::vector<Piece> all;
  // Shapes first, kind by kind, then meshes, as the kernels have them: the order decides between equals.
  using Shape = Collider::Shape;
  for (const Shape kind : {Shape::Plane, Shape::Sphere, Shape::Box, Shape::Capsules})
    for (std::size_t k = 0; k < scene_.colliders.size(); ++k)
      if (scene_.colliders[k].shape == kind) add_shape(scene_.colliders[k], k, at, now, all);
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k)
    if (scene_.colliders[k].shape == Shape::Mesh) add_mesh(k, at, now, all);
  for (Piece& p : all) p.margin = std::max(p.margin, least_margin_);
  return all;
}

ContactReference::Found ContactReference::look(const Way& way, const V& active_normal) const {
  Found f{};
  f.free_share = 1;
  double nearest_gap = std::numeric_limits<double>::infinity(), other_gap = nearest_gap;
  for (const Piece& p : pieces(way.at, way.now)) {
    const double closing = -(way.left - way.part * p.delta).dot(p.normal), spare = p.distance - kKeep * p.margin;
    if (closing > 0 && closing > spare) f.free_share = std::min(f.free_share, kTaken * std::max(spare, 0.0) / closing);
    const double gap = p.distance - p.margin;
    if (gap < nearest_gap) {
      nearest_gap = gap;
      f.nearest = p;
    }
    if (gap < kSlack * p.margin && closing - gap > kTolerance * p.margin && gap < other_gap &&
        p.normal.dot(active_normal) < kOther) {
      other_gap = gap;
      f.other = p;
      f.has_other = true;
    }
  }
  return f;
}

void ContactReference::respond_to(const Piece& piece, Way& way, V& velocity) {
  ++active_contacts;
  const double rate = scene_.time.frame_rate_hz;
  V relative = velocity - rate * piece.delta;
  const double approach = std::max(0.0, -relative.dot(piece.normal));
  relative += approach * piece.normal;
  const V path = way.left - way.part * piece.delta;
  const double along = path.dot(piece.normal);
  V slide = path - along * piece.normal;
  const V slip = relative - relative.dot(piece.normal) * piece.normal;
  const double most = piece.friction * approach;
  if (slip.norm() > 0) relative -= std::min(1.0, most / slip.norm()) * slip;
  if (slide.norm() > 0) slide *= std::max(0.0, 1 - most * way.part / rate / slide.norm());
  velocity = rate * piece.delta + relative;
  way.left = way.part * piece.delta + slide + std::max(along, piece.margin - piece.distance) * piece.normal;
}

V ContactReference::advance(const V& from, const V& to, double begin, V& velocity, bool& touched) {
  Way way{from, to - from, begin, 1.0 / substeps_};
  V normal = V::Zero();
  Found f{};
  constexpr int kSteps = 8;
  for (int k = 0; k < kSteps; ++k) {
    f = look(way, normal);
    const bool first = normal.isZero(0);
    const double gap = f.nearest.distance - f.nearest.margin;
    const double need = -gap - (way.left - way.part * f.nearest.delta).dot(f.nearest.normal);
    const bool by_nearest =
        first && gap < kSlack * f.nearest.margin && need > (k == 0 ? 0 : kTolerance * f.nearest.margin);
    const bool by_other = !by_nearest && f.has_other && (!first || f.other.normal.dot(f.nearest.normal) < kOther);
    if ((by_nearest || by_other) && k + 1 < kSteps) {
      const Piece& piece = by_nearest ? f.nearest : f.other;
      respond_to(piece, way, velocity);
      normal = piece.normal;
      touched = true;
      continue;
    }
    way.at += f.free_share * way.left;
    way.now += f.free_share * way.part;
    way.left *= 1 - f.free_share;
    way.part *= 1 - f.free_share;
    normal = V::Zero();
    if (f.free_share == 1) return way.at;
  }
  return way.at + way.part * f.nearest.delta;
}

void ContactReference::substep(int s) {
  const double h = scene_.time.dt() / substeps_, begin = static_cast<double>(s) / substeps_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (w_[i] == 0) continue;
    v[i] += h * vec(scene_.gravity_m_per_s2);
    x[i] += h * v[i];
  }
  const std::size_t columns = static_cast<std::size_t>(scene_.cloth.columns), n = x.size();
  std::vector<V> sum_x(n, V::Zero()), sum_v(n, V::Zero());
  std::vector<double> weight_x(n, 0), weight_v(n, 0);
  const auto ask = [&](std::size_t i, const V& way, const V& gain) {
    sum_x[i] += way.norm() * way;
    sum_v[i] += gain.norm() * gain;
    weight_x[i] += way.norm();
    weight_v[i] += gain.norm();
  };
  for (std::size_t k = 0; k < sample_side_.size(); ++k) {
    const std::size_t family = k / n / static_cast<std::size_t>(samples_), i = k % n;
    const bool right = family != 1, down = family != 0;
    if ((right && i % columns + 1 == columns) || (down && i + columns >= n)) continue;
    const std::size_t j = i + (right ? 1 : 0) + (down ? columns : 0);
    const double t = static_cast<double>(k / n % static_cast<std::size_t>(samples_) + 1) / (samples_ + 1);
    if (w_[i] + w_[j] == 0) continue;
    V from = sample_side_[k], velocity = mix(v[i], v[j], t);
    if (!((from - mix(side_[i], side_[j], t)).norm() < 0.5 * (side_[j] - side_[i]).norm())) from = side_[i];
    bool touched = false;
    sampling_ = true;
    sample_side_[k] = advance(from, mix(x[i], x[j], t), begin, velocity, touched);
    sampling_ = false;
    if (!touched) continue;
    const V way = sample_side_[k] - mix(x[i], x[j], t), gain = velocity - mix(v[i], v[j], t);
    const double share = w_[i] == 0 ? 1 / t : w_[j] == 0 ? 1 / (1 - t) : 1;
    ask(i, share * way, share * gain);
    ask(j, share * way, share * gain);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (w_[i] == 0) continue;
    if (weight_x[i] > 0) x[i] += sum_x[i] / weight_x[i];
    if (weight_v[i] > 0) v[i] += sum_v[i] / weight_v[i];
    bool touched = false;
    side_[i] = x[i] = advance(side_[i], x[i], begin, v[i], touched);
  }
}

void ContactReference::frame(int index) {
  frame_ = index;
  mesh_start_.assign(scene_.colliders.size(), {});
  mesh_end_ = mesh_start_;
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
    const Collider& c = scene_.colliders[k];
    if (!c.mesh) continue;
    const auto pose = [&](int instant) {
      return c.moves() ? scene_.motion[static_cast<std::size_t>(instant)].colliders[k] : ColliderPose{};
    };
    mesh_start_[k] = posed_positions(*c.mesh, pose(index));
    mesh_end_[k] = posed_positions(*c.mesh, pose(index + 1));
  }
  for (int s = 0; s < substeps_; ++s) substep(s);
}

}  // namespace clothbench::pbd_gpu
