#include "truth/draw.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/dice.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/change.hpp"
#include "scenario/load.hpp"
#include "truth/reference_case.hpp"
#include "truth/solutions.hpp"

namespace clothbench::truth {
namespace {

using nlohmann::json;

using std::numbers::pi;
constexpr int kFewestFrames = 8;

class Drawing {
 public:
  Drawing(const Scene& s, std::uint64_t seed)
      : scene_(s),
        seed_(seed),
        dice_(seed, s.reference_case),
        rate_hz_(s.time.frame_rate_hz),
        j_(json::parse(s.json)) {}

  DrawnScene draw() {
    const std::string& known = scene_.reference_case;
    const double old = scene_.cloth.width_m, old_g = norm(scene_.gravity_m_per_s2);
    note("length_m", length_ = dice_.between(0.1, 2));
    note("areal_density_kg_per_m2", density_ = dice_.between(0.05, 1));
    if (old_g > 0) note("gravity_m_per_s2", g_ = dice_.between(1, 25));
    SceneChange sized;
    sized.length = length_ / old;
    sized.time = old_g > 0 && known != "free-fall" ? std::sqrt(sized.length * old_g / g_) : 1;
    j_ = change_scene(std::move(j_), sized, scene_.source);
    if (scene_.cloth.mesh) mesh();
    if (old_g > 0) set_gravity(scaled(g_ / old_g, scene_.gravity_m_per_s2));
    j_["cloth"]["areal_density_kg_per_m2"] = density_;
    if (known == "free-fall") draw_stiffness(100);
    if (known == "heavy-strip")
      draw_stiffness(std::max(100.0, 100 * density_ * g_ * length_));  // strains of 1 % at most
    if (known == "swing-strip") as_stiff();
    if (known == "incline") slope();
    if (known == "capstan") overhangs();
    j_["time"]["frame_rate_hz"] = rate_hz_;
    j_ = change_scene(std::move(j_), elsewhere(), scene_.source);
    enough_frames();
    j_["seed"] = seed_;
    DrawnScene out{scene_from_json(std::move(j_), scene_.source), std::move(values_)};
    out.scene.name = scene_.name;
    reference_case_of(out.scene);  // refuses what it does not answer
    return out;
  }

 private:
  static double norm(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
  void note(const std::string& name, double value) { values_.emplace_back(name, value); }
  void set_gravity(const Vec3& g) { j_["gravity_m_per_s2"] = g; }

  void draw_stiffness(double least) {
    const double stiffness = dice_.log_between(least, 1e6);
    note("membrane_stiffness_N_per_m", stiffness);
    j_["material"]["membrane_stiffness_N_per_m"] = stiffness;
  }

  void mesh() {
    json& drawn = j_["cloth"]["mesh"]["drawn"];
    const double turned_deg = dice_.between(0, 90);
    const int seed = dice_.whole(1, 1000);
    note("turned_deg", turned_deg);
    note("mesh_seed", seed);
    drawn["turned_deg"] = turned_deg;
    drawn["seed"] = seed;
  }

  /// As stiff against its weight as it was: a strip that the reference case takes for inextensible.
  void as_stiff() {
    const double weight = density_ * g_ * length_,
                 before = scene_.cloth.areal_density_kg_per_m2 * norm(scene_.gravity_m_per_s2) * scene_.cloth.width_m;
    if (const auto Y = scene_.material.membrane_stiffness_N_per_m)
      j_["material"]["membrane_stiffness_N_per_m"] = *Y * weight / before;
  }

  /// Gravity turns, the face stays; the box is made as long as the displacement.
  void slope() {
    const auto known = reference_case_of(scene_);
    const double friction = dice_.between(0.1, 0.8), critical = std::atan(friction);
    const bool stops = norm(scene_.cloth.initial_velocity_m_per_s) > 0,
               sticks = std::abs(known->quantity(known->columns(scene_.time.frames()))) < 1e-9 * scene_.cloth.width_m;
    double angle = critical + dice_.between(0.3, 3) * pi / 180 * (sticks ? -1 : 1), speed = 0;
    if (stops) {
      angle = dice_.between(0, critical / 2);
      speed = dice_.between(0.5, 2) * std::sqrt(g_ * length_);
      note("speed_m_per_s", speed);
    }
    note("friction", friction);
    note("angle_deg", angle * 180 / pi);
    const Vec3 d = slope_direction();
    const Vec3 &u = scene_.cloth.axis_u, &v = scene_.cloth.axis_v;
    const Vec3 n = {v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0]};
    Vec3 gravity{};
    for (std::size_t k = 0; k < 3; ++k) gravity[k] = g_ * (std::sin(angle) * d[k] - std::cos(angle) * n[k]);
    set_gravity(gravity);
    j_["cloth"]["initial_velocity_m_per_s"] = scaled(speed, d);
    json& face = j_["colliders"][0];
    face["friction"] = friction;
    const double slowing = g_ * (friction * std::cos(angle) - std::sin(angle)),
                 T = j_["time"]["duration_s"].get<double>();
    if (stops) j_["time"]["duration_s"] = 1.5 * speed / slowing;
    const double displacement = stops ? speed * speed / (2 * slowing) : sticks ? 0 : -0.5 * slowing * T * T;
    if (face["type"] == "box")
      for (const std::size_t k : {0u, 2u}) face["size_m"][k] = 2 * (2 * length_ + 1.5 * displacement);
  }

  Vec3 slope_direction() const {
    const Vec3& u = scene_.cloth.axis_u;
    if (norm(scene_.cloth.initial_velocity_m_per_s) > 0)
      return scaled(1 / norm(scene_.cloth.initial_velocity_m_per_s), scene_.cloth.initial_velocity_m_per_s);
    const Vec3& g = scene_.gravity_m_per_s2;
    const double along = u[0] * g[0] + u[1] * g[1] + u[2] * g[2];
    return along < 0 ? scaled(-1, u) : u;
  }

  /// Rows on the cylinder and below it, of a strip as long as was drawn.
  void drape(int turns, int light, int heavy) {
    const int links = light + heavy + turns - 1;
    const double cell = length_ / links, radius = cell / (2 * std::sin(pi / (2 * turns)));
    json &cloth = j_["cloth"], &cylinder = j_["colliders"][0];
    cloth["grid"][0] = links + 1;
    cloth["size_m"] = {length_, 4 * cell};
    cloth["pose"]["drape"] = {{"radius_m", radius}, {"offset_m", 0.5 * (heavy - light) * cell}};
    const double margin = 0.04 * radius;
    cylinder["margin_m"] = margin;
    cylinder["radius_m"] = radius - margin;
    cylinder["length_m"] = 12 * cell;
    note("radius_m", radius);
    note("turns", turns);
  }

  void overhangs() {
    const auto before = reference_case_of(scene_);
    const bool holds = before->quantity(before->columns(scene_.time.frames())) == 0;
    const int turns = dice_.whole(9, 15), light = dice_.whole(5, 9);
    const double friction = dice_.between(0.1, 0.4), cell = 1, radius = cell / (2 * std::sin(pi / (2 * turns)));
    const Capstan cylinder{friction, radius, 1, 1, turns};
    const double most = greatest_overhang_m(cylinder, light - 0.5), factor = dice_.between(0.1, 0.3);
    const int heavy = holds ? std::max(light, static_cast<int>(std::floor((1 - factor) * most + 0.5)))
                            : static_cast<int>(std::ceil((1 + factor) * most + 0.5));
    note("friction", friction);
    j_["colliders"][0]["friction"] = friction;
    drape(turns, light, heavy);
    if (holds) return;
    // While a third of the light side runs off.
    const double real = length_ / (light + heavy + turns - 1);
    const Capstan real_cylinder{friction, radius * real, density_, g_, turns};
    double T = 0.05 * std::sqrt(length_ / g_);
    while (slide_over(real_cylinder, (light - 0.5) * real, (heavy - 0.5) * real, std::vector<double>{0, 1.1 * T})
               .back()
               .displacement_m < (light - 0.5) * real / 3)
      T *= 1.1;
    j_["time"]["duration_s"] = T;
  }

  SceneChange elsewhere() {
    SceneChange c;
    c.turn = dice_.rotation();
    for (double& x : c.offset_m) x = dice_.between(-1, 1) * 10 / std::sqrt(3.0);
    note("origin_away_m", norm(c.offset_m));
    return c;
  }

  void enough_frames() {
    json& time = j_["time"];
    const double T = time["duration_s"].get<double>(), least = kFewestFrames / T;
    double rate = time["frame_rate_hz"].get<double>();
    while (rate < least) rate *= 2;
    time["frame_rate_hz"] = rate;
    time["duration_s"] = std::floor(T * rate * (1 + 1e-12)) / rate;  // whole frames, and no horizon passed
  }

  const Scene& scene_;
  std::uint64_t seed_;
  Dice dice_;
  double rate_hz_;
  json j_;
  double length_ = 0, density_ = 0, g_ = 0;
  std::vector<std::pair<std::string, double>> values_;
};

}  // namespace

DrawnScene draw(const Scene& scene, std::uint64_t seed) {
  const bool drawn =
      !scene.reference_case.empty() && scene.reference_case != "cantilever" && scene.reference_case != "two-hand-pull";
  if (!drawn)
    throw Error(
        scene.source +
        ": --seed draws parameters for scenes whose \"truth\" is a fall, a swing, a hanging strip, an incline or "
        "a capstan, and this is none of them; `clothbench study contact --seed N` draws contact scenes");
  reference_case_of(scene);
  return Drawing(scene, seed).draw();
}

}  // namespace clothbench::truth
