#include "xr/picking.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "scenario/recorded_hand.hpp"

namespace clothbench::xr {
namespace {

constexpr std::size_t kPoints = 6;
constexpr double kMark_m = 0.012;

}  // namespace

std::optional<Vec3> hit(const assets::TriangleMesh& mesh, const Ray& ray) {
  const assets::Vector from = assets::Vector::Map(ray.from_m.data()), along = assets::Vector::Map(ray.along.data());
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    // Moller & Trumbore 1997: from + s along = a + u (b - a) + v (c - a).
    const assets::Vector a = mesh.vertex(t[0]), ab = mesh.vertex(t[1]) - a, ac = mesh.vertex(t[2]) - a;
    const assets::Vector p = along.cross(ac);
    const double det = ab.dot(p);
    if (det == 0) continue;
    const assets::Vector r = from - a, q = r.cross(ab);
    const double u = r.dot(p) / det, v = along.dot(q) / det, s = ac.dot(q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && s > 0 && s < nearest) nearest = s;
  }
  if (!std::isfinite(nearest)) return std::nullopt;
  const assets::Vector at = from + nearest * along;
  return Vec3{at.x(), at.y(), at.z()};
}

Picking::Picking(Session& session) : scanner_(session), controllers_(session) {}

bool Picking::ready(XrTime time) {
  if (!scan_ && (scan_ = scanner_.at(time)))
    room_ = assets::parse_room(assets::room_capture(*scan_), "the headset's room", "room").mesh;
  const Pressed pressed = controllers_.read(time);
  if (!scan_) return false;
  if (pressed.show) {
    shown_ = !shown_;
    changed_ = true;
  }
  if (pressed.pick && picked_.size() < kPoints)
    if (const auto point = hit(room_, *pressed.pick)) {
      picked_.push_back(*point);
      changed_ = true;
    }
  return picked_.size() == kPoints;
}

std::string Picking::waiting_for() const {
  if (!scan_) return "the headset has not reported where its room is";
  return fmt::format("{} of {} points were picked (A shows the room, the trigger picks)", picked_.size(), kPoints);
}

render::Surfaces Picking::surfaces() {
  changed_ = false;
  Scene scene;
  if (shown_) {
    Collider c;
    c.shape = Collider::Shape::Mesh;
    c.mesh = collider_mesh(room_);
    scene.colliders.push_back(std::move(c));
  }
  for (const Vec3& p : picked_) {
    Collider c;
    c.shape = Collider::Shape::Sphere;
    c.center_m = p;
    c.radius_m = kMark_m;
    scene.colliders.push_back(std::move(c));
  }
  const assets::Box all = assets::bounding_box(room_);
  const assets::Vector low = all.min(), high = all.max();
  return render::surfaces(scene, 0, {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}});
}

}  // namespace clothbench::xr
