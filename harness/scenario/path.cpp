#include "scenario/path.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "clothbench/vector.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

/// Time [s] at full speed that gives the same displacement.
double ramped(double t, double ramp_s) {
  if (t >= ramp_s) return t - ramp_s / 2;
  return t / 2 - ramp_s / (2 * std::numbers::pi) * std::sin(std::numbers::pi * t / ramp_s);
}

}  // namespace

Path Path::read(const nlohmann::json& j) {
  Path p;
  p.velocity_m_per_s = vec3(j.at("velocity_m_per_s"));
  p.ramp_s = j.value("ramp_s", 0.0);
  p.start_s = j.value("start_s", 0.0);
  if (j.contains("stop_s")) p.stop_s = j["stop_s"].get<double>();
  if (j.contains("release_s")) p.release_s = j["release_s"].get<double>();
  if (j.contains("jumps"))
    for (const auto& at : j["jumps"]) p.jumps.push_back({at["time_s"].get<double>(), vec3(at["by_m"])});
  return p;
}

Vec3 Path::displacement(double time_s) const {
  const double until = stop_s ? std::min(time_s, *stop_s) : time_s;
  const double seconds = ramped(std::max(0.0, until - start_s), ramp_s);
  Vec3 out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = seconds * velocity_m_per_s[k];
  for (const At& jump : jumps)
    if (time_s > jump.time_s)
      for (std::size_t k = 0; k < 3; ++k) out[k] += jump.by_m[k];
  return out;
}

void note_jumps(const Path& path, Scene& scene) {
  for (const Path::At& jump : path.jumps) {
    int frame = 1;
    while (frame <= scene.time.frames() && !(scene.time.at(frame) > jump.time_s)) ++frame;
    if (frame > scene.time.frames()) continue;
    scene.jumps.push_back({frame, length(jump.by_m)});
  }
}

Capsule moved_capsule(const Path& path, const Vec3& center, const Vec3& axis, double length_m, double radius_m,
                      const Vec3& spin, double time_s) {
  // Rodrigues' formula.
  const double rate = length(spin);
  Vec3 turned = axis;
  if (rate > 0) {
    const Vec3 w = {spin[0] / rate, spin[1] / rate, spin[2] / rate};
    const double c = std::cos(rate * time_s), s = std::sin(rate * time_s), along = dot(w, axis);
    const Vec3 across = cross(w, axis);
    for (std::size_t k = 0; k < 3; ++k) turned[k] = axis[k] * c + across[k] * s + w[k] * along * (1 - c);
  }
  const Vec3 middle = plus(center, path.displacement(time_s)), half = scaled(length_m / 2, turned);
  return {minus(middle, half), plus(middle, half), radius_m};
}

}  // namespace clothbench
