#include <cmath>
#include <limits>
#include <numbers>

#include "base/json_text.hpp"
#include "truth/solutions.hpp"
#include "truth/strip.hpp"

namespace clothbench::truth {
namespace {

constexpr double kPlace = 1e-6;  // fraction of L: tolerance for the positions in a scene

/// The face on which a sheet lies: its outward normal, and the height of the sheet above the face's contact offset.
struct Face {
  Vec3 normal{};
  double gap_m = std::numeric_limits<double>::infinity();
};

/// A collider's face under the sheet. Box: a face below the sheet's corners at the start and after `displacement`.
Face face_of(const Strip& s, const Collider& c, const Vec3& displacement) {
  const Cloth& cloth = s.scene.cloth;
  const auto from = [&](const Vec3& normal, const Vec3& point) {
    return Face{normal, dot(cloth.center_m - point, normal) - c.margin_m};
  };
  if (c.shape == Collider::Shape::Plane) return from(c.normal, c.center_m);
  Face best;
  for (std::size_t k = 0; c.shape == Collider::Shape::Box && k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) {
      const Face f = from(sign * c.axes[k], c.center_m + sign * c.half_extent_m[k] * c.axes[k]);
      bool over = true;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 x = cloth.center_m + ((corner & 1) != 0 ? 0.5 : -0.5) * cloth.width_m * cloth.axis_u +
                       ((corner & 2) != 0 ? 0.5 : -0.5) * cloth.height_m * cloth.axis_v +
                       ((corner & 4) != 0 ? 1.0 : 0.0) * displacement;
        for (std::size_t other = 0; other < 3; ++other)
          if (other != k)
            over = over && std::abs(dot(x - c.center_m, c.axes[other])) < c.half_extent_m[other] - c.margin_m;
      }
      if (over && std::abs(f.gap_m) < std::abs(best.gap_m)) best = f;
    }
  return best;
}

/// `what` is not a std::string: GCC 14 would warn that the result refers to a temporary (-Wdangling-reference).
const Collider& only_collider(const Strip& s, const char* what) {
  s.need(s.scene.colliders.size() == 1, std::string("one collider: ") + what);
  return s.scene.colliders[0];
}

/// Displacement of the strip towards u1, from the material point that is on top.
std::function<double(const Columns&)> displacement_over(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  const double start = s.links / 2.0 - c.drape_offset_m / c.du();
  return [s, start, center = c.center_m, cell = c.du()](const Columns& x) {
    double row = std::numeric_limits<double>::quiet_NaN(), top = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      const double here = dot(x[i] - center, s.along), next = dot(x[i + 1] - center, s.along);
      if (!(here <= 0 && next > 0)) continue;
      const double share = -here / (next - here), height = dot(x[i] + share * (x[i + 1] - x[i]) - center, s.up);
      if (!(height > top)) continue;
      top = height;
      row = static_cast<double>(i) + share;
    }
    return (start - row) * cell;
  };
}

Columns draped_columns(const Strip& s, double displacement) {
  const Cloth& c = s.scene.cloth;
  return s.columns([&](int i) { return draped_row(c, i, c.drape_offset_m + displacement); });
}

}  // namespace

ReferenceCase incline(const Strip& s) {
  s.need_gravity();
  s.need_flat();
  s.need_even_masses();
  s.need_pins({}, "no pins and no grips");
  s.need_damping(false);
  const Cloth& c = s.scene.cloth;
  const Collider& collider = only_collider(s, "a plane or a box");
  const double most = s.time_s(s.scene.time.frames());
  const Vec3 v0 = c.initial_velocity_m_per_s;
  Face face = face_of(s, collider, {});
  const auto downhill = [&] {
    const Vec3 tangential = s.scene.gravity_m_per_s2 - dot(s.scene.gravity_m_per_s2, face.normal) * face.normal;
    if (length(tangential) > Strip::kLevel * s.g) return (1 / length(tangential)) * tangential;
    return length(v0) > 0 ? (1 / length(v0)) * v0 : s.along;
  };
  s.need(std::isfinite(face.gap_m), "a plane, or a box under the whole sheet");
  const Vec3 d = downhill();
  Incline slope;
  slope.angle_rad =
      std::atan2(std::max(0.0, dot(s.scene.gravity_m_per_s2, d)), -dot(s.scene.gravity_m_per_s2, face.normal));
  slope.friction = collider.friction;
  slope.speed_m_per_s = dot(v0, d);
  slope.gravity_m_per_s2 = s.g;
  s.need(std::abs(face.gap_m) <= kPlace * s.length_m, "a sheet that starts at the collider's margin");
  s.need(std::abs(dot(c.axis_u, face.normal)) <= Strip::kLevel && std::abs(dot(c.axis_v, face.normal)) <= Strip::kLevel,
         "a sheet parallel to the face");
  s.need(slope.angle_rad < std::numbers::pi / 2, "a face whose normal points up");
  s.need(slope.speed_m_per_s >= 0 && length(v0 - slope.speed_m_per_s * d) <= Strip::kLevel * (length(v0) + 1),
         "an initial velocity straight downhill, or none");
  const double whole = slide_down(slope, most).distance_m;
  face = face_of(s, collider, whole * d);
  s.need(std::isfinite(face.gap_m), "a box that is under the whole path of the sheet");
  ReferenceCase known = s.reference_case();
  known.by_quantity = true;
  if (whole > 0) known.quantity_scale = whole;
  const auto rest_m = [s](auto i) { return s.length_m * static_cast<double>(i) / s.links; };
  known.columns = [s, slope, d, rest_m](int frame) {
    const double displacement = slide_down(slope, s.time_s(frame)).distance_m;
    return s.columns([&](int i) { return s.start + rest_m(i) * s.along + displacement * d; });
  };
  known.quantity = [s, d, rest_m](const Columns& x) {
    return s.mean([&](std::size_t i) { return dot(x[i] - s.start - rest_m(i) * s.along, d); });
  };
  return known;
}

ReferenceCase capstan(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  s.need_gravity();
  s.need(c.drape_radius_m > 0, "\"drape\" in its pose: a strip that starts over a cylinder");
  s.need(std::abs(dot(cross(c.axis_u, c.axis_v), s.up) + 1) <= Strip::kLevel, "axis_u x axis_v down");
  s.need_rest();
  s.need_even_masses();
  s.need_pins({}, "no pins and no grips");
  s.need_inextensible();
  s.need_no_bending();
  s.need_damping(false);
  const Collider& collider = only_collider(s, "a cylinder");
  const nlohmann::json j = json_from(s.scene.json).at("colliders").at(0);
  s.need(j.at("type") == "cylinder", "one collider: a cylinder");
  const auto vec = [&](const char* key) {
    return Vec3{j.at(key)[0].get<double>(), j.at(key)[1].get<double>(), j.at(key)[2].get<double>()};
  };
  const Vec3 off = c.center_m - vec("center_m"), axis = vec("axis");
  s.need(std::abs(std::abs(dot(axis, c.axis_v)) - 1) <= Strip::kLevel, "the cylinder's axis along axis_v");
  s.need(length(off - dot(off, axis) * axis) <= kPlace * s.length_m, "the cylinder's axis through center_m");
  s.need(j.at("length_m").get<double>() >= c.height_m + 2 * std::abs(dot(off, axis)),
         "a cylinder as long as the strip is wide");
  s.need(std::abs(j.at("radius_m").get<double>() + collider.margin_m - c.drape_radius_m) <= kPlace * s.length_m,
         "a drape radius equal to the cylinder's radius plus its margin");
  const double cell = c.du(), turns = std::numbers::pi / drape_turn_rad(c),
               middle = s.links / 2.0 - c.drape_offset_m / cell;
  const int m = static_cast<int>(std::lround(turns));
  const double first = middle - (m - 1) / 2.0, light = std::round(first);
  s.need(std::abs(turns - m) <= 1e-6 && std::abs(first - light) <= 1e-6,
         "rows that lie evenly on the cylinder: cells of 2 R sin(pi / 2m) for an integer m, and an offset that "
         "centres m rows on it");
  const double heavy = s.links - (m - 1) - light;
  s.need(light >= 1 && heavy >= 1, "ends that hang");
  s.need(heavy >= light, "an offset towards u1, or none");
  const double half_turn = std::numbers::pi / (2 * m), friction = collider.friction;
  s.need(friction > 0 && friction * std::tan(half_turn) < 1,
         "friction above 0 and below 1 / tan(half the angle between rows)");
  const double light_m = (light - 0.5) * cell, heavy_m = (heavy - 0.5) * cell;  // overhangs below the axis
  const auto moved = [&](int rows) {
    const Capstan cylinder{friction, c.drape_radius_m, c.areal_density_kg_per_m2, s.g, rows};
    return [states = slide_over(cylinder, light_m, heavy_m, s.times_s())](int frame) {
      return states.at(static_cast<std::size_t>(frame)).distance_m;
    };
  };
  const auto displacement = moved(m), smooth = moved(0);
  const double end = displacement(s.scene.time.frames());
  ReferenceCase known = s.reference_case();
  known.by_quantity = known.smooth_law = true;
  known.quantity = displacement_over(s);
  if (end > 0) known.quantity_scale = end;
  // While nothing slides, these equal the scene's initial positions exactly.
  known.columns = [s, displacement](int frame) { return draped_columns(s, displacement(frame)); };
  known.continuum = [s, smooth](double share, int frame) {
    return draped_columns(s, smooth(frame)).at(static_cast<std::size_t>(std::lround(share * s.links)));
  };
  return known;
}

}  // namespace clothbench::truth
