#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_set>

#include "metrics/motion_check/body_state.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

/// Radius [m] of a finger. A skinned hand that moves by more than half of it in a frame may push in any direction.
constexpr double kFinger_m = 0.01;
/// Frames whose contacts are kept: a window and its neighbours.
constexpr std::size_t kFramesKept = 16;

}  // namespace

AllBodies::AllBodies(const Motion& motion, std::span<const double> contact_offsets_m) : m(motion) {
  for (std::size_t k = 0; k < m.scene.colliders.size(); ++k) {
    const Collider& c = m.scene.colliders[k];
    const double said = k < contact_offsets_m.size() ? contact_offsets_m[k] : c.margin_m;
    Body& b = bodies.emplace_back(
        Body{c, kind_of(c), std::isfinite(said) ? std::max(said, c.margin_m) : c.margin_m, CentreLine(c)});
    if (b.kind.capsules != nullptr) {
      for (const Capsule& q : b.kind.capsules(c, {})) {
        b.radius_m = std::min(b.radius_m, q.radius_m);
        b.lengths_m.push_back((to_v3(q.b_m) - to_v3(q.a_m)).norm());
      }
    } else if (c.shape == Collider::Shape::Box) {
      b.radius_m = std::min({c.half_extent_m[0], c.half_extent_m[1], c.half_extent_m[2]});
    } else if (c.moves()) {
      b.radius_m = kFinger_m;
    }
    if (c.shape == Collider::Shape::Box) add_middle(b);
    if (b.kind.surface == nullptr || b.kind.half_space) continue;
    const ColliderSurface surface = b.kind.surface(c, m.scripted(0) ? m.scripted(0)->colliders[k] : ColliderPose{}, {});
    b.triangles.assign(surface.triangles.begin(), surface.triangles.end());
    if (b.moves() || b.triangles.empty()) continue;
    b.still = std::make_unique<contact::TriangleTree>(contact::TriangleMeshView{surface.positions, b.triangles});
  }
  highest_speed = collider_speed_m_per_s(m.scene);
  for (const Jump& j : m.scene.jumps) highest_speed = std::max(highest_speed, j.distance_m / m.scene.time.dt());
  links = contact::edges_of(m.triangles);
  each.resize(m.vertices);
  std::iota(each.begin(), each.end(), 0u);
  reached.assign(m.frames, {});
  depth.assign(m.frames, 0);
  faces.assign(m.frames, {});
}

std::vector<double> AllBodies::cloth(std::size_t frame) const {
  std::vector<double> out;
  out.reserve(3 * m.vertices);
  for (std::size_t v = 0; v < m.vertices; ++v) {
    const V3 x = m.at(frame, v);
    out.insert(out.end(), {x[0], x[1], x[2]});
  }
  return out;
}

Pose& AllBodies::pose(Body& b, std::size_t frame) {
  if (!b.moves()) frame = 0;
  std::unique_ptr<Pose>& slot = b.poses[frame % b.poses.size()];
  if (slot && slot->frame == frame) return *slot;
  slot = std::make_unique<Pose>();
  slot->frame = frame;
  const std::size_t index = static_cast<std::size_t>(&b - bodies.data());
  const FrameMotion* now = m.scripted(frame);
  const ColliderPose pose = now != nullptr && index < now->colliders.size() ? now->colliders[index] : ColliderPose{};
  if (b.kind.capsules != nullptr)
    slot->capsules = b.kind.capsules(b.collider, pose);
  else if (!b.kind.half_space)
    slot->positions = b.kind.surface(b.collider, pose, {}).positions;
  return *slot;
}

/// Largest displacement [m] of any point of a collider from the previous frame to this one.
double AllBodies::displacement(Body& b, std::size_t frame) {
  if (!b.moves() || frame == 0 || frame >= m.frames) return 0;
  std::pair<std::size_t, double>& known = b.displacements[frame % b.displacements.size()];
  if (known.first == frame) return known.second;
  const Pose &was = pose(b, frame - 1), &now = pose(b, frame);
  double most = 0;
  for (std::size_t i = 0; i < now.capsules.size(); ++i)
    most = std::max({most, (to_v3(now.capsules[i].a_m) - to_v3(was.capsules[i].a_m)).norm(),
                     (to_v3(now.capsules[i].b_m) - to_v3(was.capsules[i].b_m)).norm()});
  for (std::size_t i = 0; i < now.positions.size(); i += 3)
    most = std::max(most, (V3::Map(now.positions.data() + i) - V3::Map(was.positions.data() + i)).norm());
  known = {frame, most};
  return most;
}

void AllBodies::touch_plane(const Body& b, const std::vector<V3>& x, const std::vector<double>& reach) {
  const V3 normal = to_v3(b.collider.normal), on = to_v3(b.collider.center_m);
  for (std::size_t v = 0; v < x.size(); ++v) {
    const double d = normal.dot(x[v] - on);
    if (!(d < reach[v])) continue;
    (*flags)[v] = true;
    note(x[v] - d * normal, normal, b, false);
  }
}

void AllBodies::touch_capsules(Body& b, std::size_t frame, const std::vector<V3>& x, const std::vector<double>& reach,
                               bool any) {
  const double far = *std::max_element(reach.begin(), reach.end());
  const double near_cell = std::max(m.cell_m * 1.5, far);
  std::vector<bool> noted(x.size(), false);
  for (const Capsule& c : pose(b, frame).capsules) {
    const V3 a = to_v3(c.a_m), e = to_v3(c.b_m);
    std::vector<bool> close(x.size(), false);
    bool some = false;
    const Box box = contact::grown(Box(a.cwiseMin(e), a.cwiseMax(e)), c.radius_m + far + near_cell);
    for (std::size_t v = 0; v < x.size(); ++v)
      if (box.contains(x[v])) close[v] = some = true;
    if (!some) continue;
    for (const Corners& t : m.triangles) {
      if (!(close[t[0]] || close[t[1]] || close[t[2]])) continue;
      const Simplex<3> corners{x[t[0]], x[t[1]], x[t[2]]};
      const double allowed = c.radius_m + std::max({reach[t[0]], reach[t[1]], reach[t[2]]});
      const auto [on_cloth, on_axis] = nearest_of(corners, a, e);
      const V3 out = on_cloth - on_axis;
      const double distance = out.norm();
      if (distance < allowed) {
        const V3 normal = distance > 0 ? V3(out / distance) : V3(V3::Zero());
        note(on_axis + c.radius_m * normal, normal, b, any);
        for (const std::uint32_t v : t) (*flags)[v] = true;
      }
      for (const std::uint32_t v : t) {
        const V3 from = x[v] - a - contact::axis_share(x[v], {a, e, c.radius_m}) * (e - a);
        const double d = from.norm();
        if (!(d < c.radius_m + reach[v]) || noted[v]) continue;
        (*flags)[v] = noted[v] = true;
        const V3 normal = d > 0 ? V3(from / d) : V3(V3::Zero());
        note(x[v] - (d - c.radius_m) * normal, normal, b, any);
      }
    }
  }
}

/// Every surface triangle within reach of a cloth triangle may push along its own normal, and along the line between
/// the nearest points of both, because a frame does not tell when they met. If the cloth moves by more than half a
/// cell, a surface triangle smaller than the reach counts as in reach if the boxes of both overlap.
void AllBodies::touch_triangle(Body& b, Pose& p, const Corners& corners, const std::vector<V3>& x, double reach,
                               bool any) {
  const Simplex<3> t{x[corners[0]], x[corners[1]], x[corners[2]]};
  const Box box = contact::grown(contact::box_of(t), reach);
  p.tree->for_each_overlapping(box, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const bool coarse = reach > m.cell_m / 2 && p.tree->item_boxes()[index].diagonal().norm() < reach;
    if (coarse)
      for (const std::uint32_t v : corners) (*flags)[v] = true;
    if (coarse && p.noted[index]) return;
    const Corners& c = b.triangles[p.near[index]];
    Simplex<3> s;
    for (std::size_t k = 0; k < 3; ++k) s[k] = V3::Map(p.positions.data() + 3 * c[k]);
    const V3 normal = (s[1] - s[0]).cross(s[2] - s[0]).normalized();
    if (!normal.allFinite()) return;
    const std::array<double, 3> height = {normal.dot(t[0] - s[0]), normal.dot(t[1] - s[0]), normal.dot(t[2] - s[0])};
    const auto [low, high] = std::minmax_element(height.begin(), height.end());
    if (!coarse && (*low > reach || *high < -reach)) return;
    if (coarse) {
      p.noted[index] = true;
      const V3 middle = (t[0] + t[1] + t[2]) / 3;
      note(point_of(s, contact::nearest_weights(middle, s)), normal, b, any);
      return;
    }
    const auto lowest = static_cast<std::size_t>((*low > 0 ? low : high) - height.begin());
    const auto best = *low * *high > 0 ? nearest_to_plane(t, s, lowest, box) : nearest_of_triangles(t, s, box);
    const double d = (best[0] - best[1]).norm();
    if (!(d < reach)) return;
    for (const std::uint32_t v : corners) (*flags)[v] = true;
    const V3 way = d > 0 ? V3((best[0] - best[1]) / d) : normal;
    // Next to coplanar triangles of one face, the direction to the farther triangle is not a surface normal.
    if (way.dot(normal) < 0.99 && b.kind.nearest != nullptr) {
      const SurfacePlace at = b.kind.nearest(b.collider, {best[0][0], best[0][1], best[0][2]});
      if (to_v3(at.normal).dot(normal) > 1 - 1e-6) {
        note(best[0] - at.distance_m * normal, normal, b, any);
        return;
      }
    }
    note(best[1], way, b, any);
    if (way.dot(normal) < 0.99) note(best[1], normal, b, any);
  });
}

void AllBodies::touch_surface(Body& b, std::size_t frame, const std::vector<V3>& x, const std::vector<double>& reach,
                              bool any) {
  Pose& p = pose(b, frame);
  if (p.positions.empty() || b.triangles.empty()) return;
  Box cloth_box;
  for (std::size_t v = 0; v < x.size(); ++v) {
    cloth_box.extend(V3(x[v] - V3::Constant(reach[v])));
    cloth_box.extend(V3(x[v] + V3::Constant(reach[v])));
  }
  if (!cloth_box.intersects(box_of(p.positions))) return;
  if (!p.tree || b.moves()) {
    p.near.clear();
    std::vector<Box> boxes;
    for (std::uint32_t i = 0; i < b.triangles.size(); ++i) {
      Box box;
      for (const std::uint32_t v : b.triangles[i]) box.extend(V3(V3::Map(p.positions.data() + 3 * v)));
      if (b.moves() && !cloth_box.intersects(box)) continue;
      boxes.push_back(box);
      p.near.push_back(i);
    }
    p.tree = std::make_unique<contact::BoxTree>(std::move(boxes));
  }
  p.noted.assign(p.near.size(), false);
  const std::size_t before = found->size();
  std::vector<SurfacePlace> places;
  if (b.kind.nearest != nullptr)
    for (const V3& q : x) places.push_back(b.kind.nearest(b.collider, {q[0], q[1], q[2]}));
  for (const Corners& t : m.triangles) {
    const double allowed = std::max({reach[t[0]], reach[t[1]], reach[t[2]]});
    // If a cloth triangle is above one flat face, its point nearest to the face is a vertex.
    if (!places.empty() && places[t[0]].normal == places[t[1]].normal && places[t[0]].normal == places[t[2]].normal) {
      const auto near = [&](std::uint32_t v) { return places[v].distance_m < allowed; };
      if (std::none_of(t.begin(), t.end(), near)) continue;
      for (const std::uint32_t v : t) {
        (*flags)[v] = true;
        const V3 normal = to_v3(places[v].normal);
        if (near(v)) note(x[v] - places[v].distance_m * normal, normal, b, any);
      }
      continue;
    }
    touch_triangle(b, p, t, x, allowed, any);
    if (any && m.has_attachments() && found->size() > before) {  // any force is possible: the frame is not evaluated
      flags->assign(x.size(), true);
      return;
    }
  }
}

void AllBodies::touch(Body& b, std::size_t frame, const std::vector<V3>& x, const std::vector<double>& reach) {
  const double way = std::max(displacement(b, frame), displacement(b, frame + 1));
  const bool any = way > b.radius_m / 2;
  std::vector<double> its_reach(reach);
  const double fallen = m.weight_unit * m.dt(frame) * m.dt(frame) / 2;
  for (double& r : its_reach) {
    const double share = r + way / 2;
    r = kOffsetFactor * b.offset_m + 4 * m.resolution_m + share + std::min(share, fallen);
  }
  const std::size_t before = found->size();
  if (b.kind.half_space)
    touch_plane(b, x, its_reach);
  else if (b.kind.capsules != nullptr)
    touch_capsules(b, frame, x, its_reach, any);
  else
    touch_surface(b, frame, x, its_reach, any);
  // Depth, if a signed distance is known.
  const double margin = b.collider.margin_m > 0 ? b.collider.margin_m : kInfinite;
  const double allowed =
      std::max(std::isfinite(b.radius_m) ? std::min(margin, b.radius_m / 4) : (std::isfinite(margin) ? margin : 0.0),
               4 * m.resolution_m);
  if (b.kind.nearest == nullptr && found->size() > before) faces[frame].flat = false;
  double deepest = 0;
  for (std::size_t v = 0; v < x.size(); ++v) {
    const V3& p = x[v];
    double d = kInfinite;
    if (b.kind.nearest != nullptr) {
      const SurfacePlace at = b.kind.nearest(b.collider, {p[0], p[1], p[2]});
      d = at.distance_m;
      if (d < its_reach[v]) faces[frame].add(to_v3(at.normal), b.collider.friction);
    } else if (b.kind.capsules != nullptr) {
      for (const Capsule& c : pose(b, frame).capsules) {
        const V3 a = to_v3(c.a_m), e = to_v3(c.b_m);
        d = std::min(d, (p - a - contact::axis_share(p, {a, e, c.radius_m}) * (e - a)).norm() - c.radius_m);
      }
    }
    if (std::isfinite(d)) deepest = std::max(deepest, -d);
  }
  depth[frame] = std::max(depth[frame], deepest / allowed);
}

void Face::add(const V3& n, double mu) {
  if (!any) normal = n, friction = mu;
  flat = flat && n.dot(normal) > 1 - 1e-6 && mu == friction;
  any = true;
}

std::unique_ptr<Bodies> bodies_of(const Motion& m, std::span<const double> contact_offsets_m) {
  return std::make_unique<AllBodies>(m, contact_offsets_m);
}

std::span<const Contact> AllBodies::contacts(std::size_t frame) {
  const auto at = kept.find(frame);
  if (at != kept.end()) return at->second;
  while (kept.size() >= kFramesKept) kept.erase(kept.begin());
  found = &kept[frame];
  reached[frame].assign(m.vertices, false);
  flags = &reached[frame];
  std::vector<V3> x;
  std::vector<double> half_way;
  for (std::size_t v = 0; v < m.vertices; ++v) {
    x.push_back(m.at(frame, v));
    double way = 0;
    if (frame > 0) way = (x[v] - m.at(frame - 1, v)).norm();
    if (frame + 1 < m.frames) way = std::max(way, (m.at(frame + 1, v) - x[v]).norm());
    half_way.push_back(way / 2);
  }
  for (Body& b : bodies) touch(b, frame, x, half_way);
  // Neighbouring triangles give equal contacts at their common vertices; keep one of them.
  std::unordered_set<std::uint64_t> known_places;
  std::erase_if(*found, [&](const Contact& c) {
    std::uint64_t place = c.any_force ? 1 : std::bit_cast<std::uint64_t>(c.friction);
    for (int i = 0; i < 3; ++i)
      for (const double q : {c.point[i] / (10 * m.resolution_m), c.normal[i] / 0.01})
        place = place * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(std::llround(q));
    return !known_places.insert(place).second;
  });
  return *found;
}

}  // namespace clothbench::motion_check
