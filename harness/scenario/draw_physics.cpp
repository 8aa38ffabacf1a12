// Random scenes with an exact solution, and random held cloth. Parameters are sampled at the size of the scene's file;
// then the scene is scaled.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "scenario/draw_contact.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using std::numbers::pi;

/// Flat size of the cloth [m]; the longer side is the first.
json& size_of(json& scene) {
  json& cloth = scene["cloth"];
  return cloth.contains("mesh") ? cloth["mesh"]["drawn"]["size_m"] : cloth["size_m"];
}

void set_cells(json& cloth, int cells) {
  if (cloth.contains("mesh")) {
    cloth["mesh"]["drawn"]["cells"] = cells;
    return;
  }
  if (cloth["size_m"][0] == cloth["size_m"][1]) cloth["grid"][1] = cells + 1;
  cloth["grid"][0] = cells + 1;
}

/// Angular frequency of the slowest oscillation [1/s]: stretch of a hanging strip, or sag of a cantilever, which
/// gravity stiffens as it does a hanging chain.
double slowest_per_s(json& scene) {
  const double L = size_of(scene)[0], density = scene["cloth"]["areal_density_kg_per_m2"];
  const json& material = scene["material"];
  if (scene["truth"]["case"] == "heavy-strip")
    return pi / 2 * std::sqrt(material["membrane_stiffness_N_per_m"].get<double>() / density) / L;
  const double bends = 3.516 * std::sqrt(material["bending_rigidity_N_m"].get<double>() / density) / (L * L);
  return std::max(bends, 1.1 * std::sqrt(kGravity_m_per_s2 / L));
}

/// Samples the damping as a fraction of the slowest oscillation's critical damping. The scene lasts until this
/// oscillation has decayed to e^-7.
void settle(json& scene, DrawnValues& draw) {
  constexpr double kMax_per_s = 20, kDecay = 7;
  const double slowest = slowest_per_s(scene), half = draw.between("damping_ratio") * std::min(slowest, kMax_per_s);
  scene["material"]["damping_per_s"] = 2 * half;
  scene["time"]["duration_s"] = kDecay / (half <= slowest ? half : half - std::sqrt(half * half - slowest * slowest));
}

/// Samples the ranges that dotted keys name, and the resolution.
void draw_numbers(json& scene, DrawnValues& draw) {
  for (const auto& [key, unused] : draw.ranges().items())
    if (key.find('.') != std::string::npos) apply_override(scene, key + "=" + dump(json(draw.natural(key))), draw.at());
  if (draw.ranges().contains("cells")) set_cells(scene["cloth"], draw.whole("cells"));
  if (draw.ranges().contains("damping_ratio")) settle(scene, draw);
}

/// Scales the scene to a random size. Gravity stays, so times grow with the root of the size; with a range
/// "time_factor" they are multiplied by that factor. The duration is rounded down to whole frames, because some
/// solutions hold only for a limited time.
void resize(json& scene, DrawnValues& draw) {
  json& time = scene["time"];
  const double factor = draw.natural("size_m") / size_of(scene)[0].get<double>(), rate_hz = time["frame_rate_hz"];
  const bool timed = draw.ranges().contains("time_factor");
  scale_units(scene, factor, timed ? draw.natural("time_factor") : std::sqrt(factor));
  if (!timed) time["frame_rate_hz"] = rate_hz;
  const double rate = time["frame_rate_hz"], duration_s = time["duration_s"];
  time["duration_s"] = std::max(1.0, std::floor(duration_s * rate + 1e-6)) / rate;
}

}  // namespace

double draw_keys(json& scene, DrawnValues& draw) {
  draw_numbers(scene, draw);
  if (draw.ranges().contains("size_m")) resize(scene, draw);
  return 0;
}

double draw_incline(json& scene, DrawnValues& draw) {
  draw_numbers(scene, draw);
  json &cloth = scene["cloth"], &box = scene["colliders"][0];
  const double friction = box["friction"], side = cloth["size_m"][0], deep = box["size_m"][1],
               time_s = scene["time"]["duration_s"], speed = draw.between("speed_m_per_s");
  const double angle = std::atan(std::max(0.0, friction + draw.between("slope_above_friction")));
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const auto at = [&](double down, double above) -> json {
    return {down * cosine + above * sine, above * cosine - down * sine, 0};
  };
  const double pull = std::max(0.0, kGravity_m_per_s2 * (sine - friction * cosine)),
               path = (speed + pull * time_s / 2) * time_s;
  cloth["pose"] = {{"center_m", at(0, box["margin_m"])}, {"axis_u", at(1, 0)}, {"axis_v", {0, 0, 1}}};
  cloth["initial_velocity_m_per_s"] = at(speed, 0);
  box["center_m"] = at(0, -deep / 2);
  box["rotation_deg"] = {0, 0, -angle * 180 / pi};
  box["size_m"] = {2 * (path + side), deep, 4 * side};
  resize(scene, draw);
  return speed;
}

double draw_capstan(json& scene, DrawnValues& draw) {
  draw_numbers(scene, draw);
  json &cloth = scene["cloth"], &drape = cloth["pose"]["drape"];
  const double friction = scene["colliders"][0]["friction"], radius = drape["radius_m"];
  const int on_cylinder = draw.whole("rows_on_cylinder"), light = draw.whole("rows_of_light_end");
  const double cell = 2 * radius * std::sin(pi / (2 * on_cylinder)), light_m = (light - 0.5) * cell;
  // The smooth strip of truth/solutions.hpp (Capstan) slips if its heavy end is longer than `balance`.
  const double ratio = std::exp(friction * pi),
               balance = ratio * light_m + 2 * friction / (1 + friction * friction) * radius * (ratio + 1);
  const int heavy = std::max(light, static_cast<int>(std::lround(draw.between("load") * balance / cell + 0.5)));
  const int links = on_cylinder - 1 + light + heavy;
  cloth["grid"] = {links + 1, 5};
  cloth["size_m"] = {links * cell, 4 * cell};
  drape["offset_m"] = (heavy - light) * cell / 2;
  const double heavy_m = (heavy - 0.5) * cell, inertia_m = heavy_m + ratio * light_m + radius * (ratio - 1) / friction;
  // The light end must stay below the cylinder's axis.
  if (heavy_m > balance)
    scene["time"]["duration_s"] =
        std::min(scene["time"]["duration_s"].get<double>(),
                 0.6 * std::sqrt(2 * light_m * inertia_m / (kGravity_m_per_s2 * (heavy_m - balance))));
  resize(scene, draw);
  return 0;
}

double draw_held(json& scene, DrawnValues& draw) {
  draw_numbers(scene, draw);
  const double tilt = draw.between("tilt_deg") * pi / 180, speed = draw.between("speed_m_per_s");
  scene["cloth"]["pose"] = {{"axis_u", {1, 0, 0}}, {"axis_v", {0, -std::sin(tilt), std::cos(tilt)}}};
  // That many vertices; or a bar, a moving bar, two bars of which one moves.
  constexpr int kVertices = 4, kBar = 5, kMovingBar = 6;
  const int held = draw.whole("held"), side = scene["cloth"]["grid"][0];
  std::set<int> pinned;
  while (held <= kVertices && static_cast<int>(pinned.size()) < held)
    pinned.insert(draw.dice().whole(0, side * side - 1));
  scene["pins"] = json::array({json{{"vertices", pinned}}});
  if (held > kVertices) scene["pins"] = json::array({json{{"edge", "v0"}}});
  if (held == kMovingBar) scene.erase("pins");
  json bar = {{"edge", held == kMovingBar ? "v0" : "v1"}, {"ramp_s", 0.1}, {"stop_s", draw.between("stop_s")}};
  const auto turn = draw.dice().rotation();
  for (const double x : turn[0]) bar["velocity_m_per_s"].push_back(speed * x);
  if (held > kBar) scene["grips"] = json::array({bar});
  const json duration_s = scene["time"]["duration_s"], damping_per_s = scene["material"]["damping_per_s"];
  resize(scene, draw);
  scene["time"]["duration_s"] = duration_s;
  scene["material"]["damping_per_s"] = damping_per_s;
  return 0;
}

}  // namespace clothbench
