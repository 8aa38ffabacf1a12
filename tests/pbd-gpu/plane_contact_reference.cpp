#include "plane_contact_reference.hpp"

#include <algorithm>
#include <cmath>

#include "contact_pieces.hpp"
#include "plane_contact_features.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr double kGuard = 2e-4, kRecovered = 0.1, kStandingShare = 0.75, kRounding = 2e-7;
constexpr int kSweeps = 30;
using V = Eigen::Vector3d;
using Points = std::vector<V>;

V point(const Vec3& p) { return {p[0], p[1], p[2]}; }
V point(const std::vector<double>& x, std::size_t i) { return {x[3 * i], x[3 * i + 1], x[3 * i + 2]}; }

double gap_along(const V& n, const Points& cloth, const Points& piece) {
  double low = 1e30, high = -1e30;
  for (const V& p : cloth) low = std::min(low, n.dot(p));
  for (const V& p : piece) high = std::max(high, n.dot(p));
  return low - high;
}

}  // namespace

double PlaneContactReference::Piece::displacement() const {
  double most = 0;
  for (std::size_t k = 0; k < first.size(); ++k) most = std::max(most, (last[k] - first[k]).norm());
  return most;
}

PlaneContactReference::PlaneContactReference(const Scene& scene, int substeps) : scene_(scene), substeps_(substeps) {
  const std::vector<double> start = initial_positions(scene), speed = initial_velocities(scene);
  for (std::size_t i = 0; i < scene.cloth.vertex_count(); ++i) {
    x.push_back(point(start, i));
    v.push_back(point(speed, i));
  }
  for (const double m : vertex_masses(scene)) w_.push_back(1 / m);
  fans_.resize(x.size());
  for (const auto& t : triangles(scene.cloth)) {
    for (std::size_t c = 0; c < 3; ++c) fans_[t[c]].push_back({elements_.size(), c});
    elements_.push_back({{t[0], t[1], t[2]}, {}});
  }
  for (std::size_t i = 0; i < x.size(); ++i) elements_.push_back({{i}, {}});
  least_margin_ = 0.01 * std::min(scene.cloth.du(), scene.cloth.dv());
  for (const Collider& c : scene.colliders) {
    most_margin_ = std::max(most_margin_, std::max(c.margin_m, least_margin_));
    if (c.shape == Collider::Shape::Plane)
      halves_.push_back({point(c.normal), point(c.normal).dot(point(c.center_m)), c.margin_m, c.friction});
  }
  thickness_ = scene.cloth.self_collision.thickness_m;
  most_margin_ = std::max(most_margin_, 0.5 * thickness_);
  self_wishes_.resize(x.size());
  self_planes_.resize(x.size());
  if (thickness_ > 0) make_self_contacts();
}

void PlaneContactReference::place_pieces(int index) {
  pieces_.clear();
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
    const Collider& c = scene_.colliders[k];
    const auto pose = [&](int instant) {
      return scene_.motion.empty() ? ColliderPose{}
                                   : scene_.motion.at(static_cast<std::size_t>(instant)).colliders.at(k);
    };
    const auto add = [&](const Points& first, const Points& last, double radius) {
      pieces_.push_back({first, last, {}, {}, radius, std::max(c.margin_m, least_margin_), c.friction, c.moves()});
    };
    if (c.shape == Collider::Shape::Sphere) add({point(c.center_m)}, {point(c.center_m)}, c.radius_m);
    if (c.shape == Collider::Shape::Box) {
      const auto corner = [&](const std::array<double, 3>& signs) {
        V at = point(c.center_m);
        for (std::size_t axis = 0; axis < 3; ++axis) at += signs[axis] * c.half_extent_m[axis] * point(c.axes[axis]);
        return at;
      };
      // Each face as two triangles.
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
          for (const bool second : {false, true}) {
            std::array<double, 3> from{}, to{}, third{};
            const std::size_t u = axis, v = (axis + 1) % 3, n = (axis + 2) % 3;
            from[n] = to[n] = third[n] = side;
            from[u] = from[v] = -1;
            to[u] = to[v] = 1;
            third[u] = second ? -1 : 1;
            third[v] = second ? 1 : -1;
            const Points corners = {corner(from), corner(third), corner(to)};
            add(corners, corners, 0);
          }
    }
    if (c.shape == Collider::Shape::Capsules) {
      const ColliderPose a = pose(index), b = pose(index + 1);
      for (std::size_t i = 0; i < c.capsules.size(); ++i)
        add({point(a.capsules[i].a_m), point(a.capsules[i].b_m)}, {point(b.capsules[i].a_m), point(b.capsules[i].b_m)},
            c.capsules[i].radius_m);
    }
    if (c.shape == Collider::Shape::Mesh) place_mesh(k, pose(index), pose(index + 1));
  }
}

void PlaneContactReference::place_mesh(std::size_t k, const ColliderPose& begin, const ColliderPose& end) {
  const Collider& c = scene_.colliders[k];
  const auto at = [&](const ColliderPose& pose) {
    return c.moves() ? posed_positions(*c.mesh, pose) : c.mesh->positions;
  };
  const std::vector<double> a = at(begin), b = at(end),
                            rest = at(c.moves() ? scene_.motion.at(0).colliders.at(k) : ColliderPose{});
  const auto add = [&](const std::vector<std::uint32_t>& corners) {
    Piece piece;
    for (const std::uint32_t q : corners) {
      piece.first.push_back(point(a, q));
      piece.last.push_back(point(b, q));
    }
    piece.margin = std::max(c.margin_m, least_margin_);
    piece.friction = c.friction;
    piece.moves = c.moves();
    pieces_.push_back(piece);
  };
  const Clusters clusters = cluster(rest, c.mesh->triangles);
  std::size_t next = 0;
  for (const std::uint32_t size : clusters.sizes) {
    std::vector<std::uint32_t> all;
    for (const std::size_t last = next + size; next < last; ++next) {
      const auto& t = c.mesh->triangles[clusters.triangles[next]];
      all.insert(all.end(), t.begin(), t.end());
      if (!c.moves()) add({t[0], t[1], t[2]});
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    if (c.moves()) add(all);
  }
}

void PlaneContactReference::frame(int index) {
  place_pieces(index);
  h_ = scene_.time.dt() / substeps_;
  for (Element& e : elements_) e.pairs.assign(pieces_.size(), {});
  for (Element& e : elements_)
    for (std::size_t k = 0; k < e.pairs.size(); ++k) e.pairs[k].piece = k;
  for (int s = 0; s < substeps_; ++s) substep(s);
}

void PlaneContactReference::substep(int s) {
  const double begin = static_cast<double>(s) / substeps_, end = (s + 1.0) / substeps_;
  double carried = 0;
  for (Piece& p : pieces_) {
    p.start = p.end = p.first;
    for (std::size_t k = 0; k < p.first.size(); ++k) {
      p.start[k] += begin * (p.last[k] - p.first[k]);
      p.end[k] += end * (p.last[k] - p.first[k]);
    }
    carried = std::max(carried, p.displacement() / substeps_);
  }
  const V g = h_ * point(scene_.gravity_m_per_s2);
  x0_ = x;
  y_ = x;
  for (std::size_t i = 0; i < x.size(); ++i) y_[i] += h_ * (v[i] + g);
  const auto rooms = [&] {
    std::vector<double> room(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) room[i] = (y_[i] - x0_[i]).norm() + carried + most_margin_;
    return room;
  };
  for (Element& e : elements_) query(e);
  respond(true, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    v[i] += g;
    x[i] += h_ * v[i];
  }
  y_ = x;
  const std::vector<double> room = rooms();
  for (Element& e : elements_) query(e);
  query_self(room);
  respond(false, 0);
  respond(false, 1);
  for (Element& e : elements_)
    for (Pair& pair : e.pairs)
      if (pair.plane) choose(e, pair);
  choose_self();
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = place(i, room[i]);
    v[i] += (x[i] - y_[i]) / h_;
  }
}

PlaneContactReference::Nearest PlaneContactReference::nearest(const Points& cloth, const Points& piece,
                                                              const Points& end) const {
  Nearest r;
  const Closest c = Features(cloth, piece).closest();
  V from = V::Zero(), to = V::Zero();
  for (std::size_t i = 0; i < cloth.size(); ++i) {
    to += c.on_cloth[Eigen::Index(i)] * cloth[i];
    r.on_cloth[Eigen::Index(i)] = c.on_cloth[Eigen::Index(i)];
  }
  for (std::size_t j = 0; j < piece.size(); ++j) {
    from += c.on_piece[Eigen::Index(j)] * piece[j];
    r.witness += c.on_piece[Eigen::Index(j)] * end[j];
  }
  r.way = r.witness - from;
  r.n = (to - from).normalized();
  r.gap = gap_along(r.n, cloth, piece);
  return r;
}

double PlaneContactReference::kept_margin(const Element& e, const Pair& pair) const {
  const Piece& p = pieces_[pair.piece];
  const bool inner = e.vertices.size() == 3 && pair.nearest.on_cloth.maxCoeff() < 1 - 1e-6;
  return p.margin * (inner && !p.moves ? kStandingShare : 1);
}

bool PlaneContactReference::parted_by_face(const Element& e, Pair& pair) const {
  const Piece& p = pieces_[pair.piece];
  if (p.first.size() != 3 || p.moves || e.vertices.size() != 3) return false;
  V n = (p.start[1] - p.start[0]).cross(p.start[2] - p.start[0]).normalized();
  const auto least = [&](const std::vector<V>& all) {
    double low = 1e30;
    for (const std::size_t i : e.vertices) low = std::min(low, n.dot(all[i] - p.start[0]));
    return low;
  };
  double most = -1e30;
  for (const std::size_t i : e.vertices) most = std::max(most, n.dot(x0_[i] - p.start[0]));
  if (most < 0) n = -n;
  const double gap = least(x0_);
  if (!(gap >= std::max(kGuard, kStandingShare * p.margin) && least(y_) >= kGuard)) return false;
  pair.nearest.n = n;
  pair.nearest.gap = gap;
  return true;
}

/// Of all pairs, however far apart: contacts that do not push and planes that do not cut change nothing.
void PlaneContactReference::query(Element& e) {
  Points cloth;
  for (const std::size_t i : e.vertices) cloth.push_back(x0_[i]);
  for (Pair& pair : e.pairs) {
    const Piece& p = pieces_[pair.piece];
    const std::size_t piece = pair.piece;
    pair = Pair{};
    pair.piece = piece;
    if (parted_by_face(e, pair)) {
      pair.plane = true;
      continue;
    }
    pair.nearest = nearest(cloth, p.start, p.end);
    if (!(pair.nearest.gap > 0)) continue;
    pair.nearest.gap -= p.radius;
    pair.contact = true;
    pair.plane = e.vertices.size() == 3;
    pair.target = std::min(kept_margin(e, pair), pair.nearest.gap);
  }
}

void PlaneContactReference::push_of(const Element& e, Pair& pair, int round) const {
  const Piece& p = pieces_[pair.piece];
  const Nearest& r = pair.nearest;
  double gap = -r.n.dot(r.witness) - p.radius, mass = 0;
  V slip = -r.way;
  for (std::size_t c = 0; c < e.vertices.size(); ++c) {
    const std::size_t i = e.vertices[c];
    const double b = r.on_cloth[Eigen::Index(c)];
    gap += b * r.n.dot(y_[i]);
    slip += b * (y_[i] - x0_[i]);
    mass += w_[i] * b * b;
  }
  const double push = pair.target - gap;
  const double out_by = round == 0 ? std::clamp(kept_margin(e, pair) - pair.target, 0.0, kRecovered * p.margin) : 0;
  if (!(push + out_by > 0)) return;
  const double moving = std::max(0.0, push);
  slip -= slip.dot(r.n) * r.n;
  pair.push = moving * r.n;
  if (slip.norm() > 0 && moving > 0) pair.push -= std::min(1.0, p.friction * moving / slip.norm()) * slip;
  pair.push /= mass;
  pair.out_by = (push + out_by - moving) / mass;
}

void PlaneContactReference::respond(bool before, int round) {
  for (Element& e : elements_)
    for (Pair& pair : e.pairs)
      if (pair.contact) {
        pair.push = V::Zero();
        pair.out_by = 0;
        if (!before || pieces_[pair.piece].moves) push_of(e, pair, round);
      }
  for (auto& all : self_wishes_) all.clear();
  if (!before) wish_self(round);
  std::vector<V> by(x.size(), V::Zero()), moving(x.size(), V::Zero());
  for (std::size_t i = 0; i < x.size(); ++i) {
    double lengths = 0;
    const auto propose = [&](const V& m, const V& out) {
      const double l = (m + out).norm();
      by[i] += l * (m + out);
      moving[i] += l * m;
      lengths += l;
    };
    for (const Half& half : halves_) {
      if (before) break;
      const double gap0 = half.n.dot(x0_[i]) - half.offset, gap = half.n.dot(y_[i]) - half.offset;
      const double push = std::min(half.margin, gap0) - gap;
      const double out = round == 0 ? std::clamp(half.margin - gap0, 0.0, kRecovered * half.margin) : 0;
      if (!(push + out > 0)) continue;
      const double m = std::max(0.0, push);
      responses += m > 0;
      V slip = y_[i] - x0_[i], correction = m * half.n;
      slip -= slip.dot(half.n) * half.n;
      if (slip.norm() > 0 && m > 0) correction -= std::min(1.0, half.friction * m / slip.norm()) * slip;
      propose(correction, (push + out - m) * half.n);
    }
    const auto from = [&](const Element& e, std::size_t corner) {
      for (const Pair& pair : e.pairs) {
        if (!pair.contact) continue;
        const double share = w_[i] * pair.nearest.on_cloth[Eigen::Index(corner)];
        propose(share * pair.push, share * pair.out_by * pair.nearest.n);
        responses += pair.push.norm() > 0;
      }
    };
    from(elements_[elements_.size() - x.size() + i], 0);
    for (const auto& [triangle, corner] : fans_[i]) from(elements_[triangle], corner);
    for (const Wish& wish : self_wishes_[i]) propose(wish.moving, wish.out);
    if (lengths > 0) by[i] /= lengths, moving[i] /= lengths;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    v[i] += moving[i] / h_;
    (before ? x[i] : y_[i]) += before ? V(by[i] - moving[i]) : by[i];
  }
}

void PlaneContactReference::choose(const Element& e, Pair& pair) const {
  const Piece& p = pieces_[pair.piece];
  Points starting, proposed;
  for (const std::size_t i : e.vertices) {
    starting.push_back(x0_[i]);
    proposed.push_back(y_[i]);
  }
  V& n = pair.nearest.n;
  const double least = std::min(pair.nearest.gap, kGuard);
  if (gap_along(n, proposed, p.end) - p.radius < least) {
    const Nearest last = nearest(proposed, p.end, p.end);
    for (const double share : {1.0, 0.5, 0.75, 0.25}) {
      if (!(last.gap > p.radius)) break;
      const V mixed = (1 - share) * n + share * last.n;
      if (!(mixed.norm() > 0.2)) continue;
      const V other = mixed.normalized();
      if (gap_along(other, starting, p.start) - p.radius < least ||
          gap_along(other, proposed, p.end) - p.radius < least)
        continue;
      n = other;
      break;
    }
  }
  double high = -1e30;
  for (const V& q : p.end) high = std::max(high, n.dot(q));
  pair.offset = high + p.radius + least;
}

double PlaneContactReference::offset_of(const Half& h, std::size_t i) const {
  return h.offset + std::min(h.n.dot(x0_[i]) - h.offset, kGuard);
}

template <class Fn>
void PlaneContactReference::each_plane(std::size_t i, Fn fn) {
  for (const auto& [triangle, corner] : fans_[i])
    for (Pair& pair : elements_[triangle].pairs)
      if (pair.plane) fn(pair, corner);
}

double PlaneContactReference::worst(std::size_t i, const V& at) const {
  double least = 1e30;
  for (const Half& h : halves_) least = std::min(least, h.n.dot(at) - offset_of(h, i));
  const_cast<PlaneContactReference*>(this)->each_plane(
      i, [&](const Pair& pair, std::size_t) { least = std::min(least, pair.nearest.n.dot(at) - pair.offset); });
  for (const SelfPlane& plane : self_planes_[i]) least = std::min(least, plane.n.dot(at) - plane.offset);
  return least;
}

Eigen::Vector3d PlaneContactReference::projected_on_planes(std::size_t i, V at) {
  std::vector<double> multipliers(halves_.size(), 0.0);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double most = 0;
    const auto onto = [&](const V& n, double offset, double& multiplier) {
      const double by = std::max(-multiplier, offset + kRounding - n.dot(at));
      multiplier += by;
      at += by * n;
      most = std::max(most, std::abs(by));
    };
    for (std::size_t k = 0; k < halves_.size(); ++k) onto(halves_[k].n, offset_of(halves_[k], i), multipliers[k]);
    each_plane(i, [&](Pair& pair, std::size_t corner) { onto(pair.nearest.n, pair.offset, pair.multipliers[corner]); });
    for (SelfPlane& plane : self_planes_[i]) onto(plane.n, plane.offset, plane.multiplier);
    if (most < 0.5 * kRounding) break;
  }
  return at;
}

Eigen::Vector3d PlaneContactReference::place(std::size_t i, double room) {
  V at = y_[i];
  const V way = at - x0_[i];
  if (way.norm() > room) at = x0_[i] + room / way.norm() * way;
  if (worst(i, at) >= 0) return at;
  ++projected;
  at = projected_on_planes(i, at);
  if (worst(i, at) >= -kRounding && (at - x0_[i]).norm() <= room) return at;
  ++without_place;  // the scenes of the comparison need no free place
  return at;
}

}  // namespace clothbench::pbd_gpu
