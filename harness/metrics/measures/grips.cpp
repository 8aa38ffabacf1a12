// Cloth that hands grip and pull: how closely it follows them, how far it stretches, its strain after release.
#include <algorithm>

#include "metrics/registry.hpp"

namespace clothbench {
namespace {

double grip_error(const MetricFrame& f) {
  const Scene& scene = f.context.scene;
  const FrameMotion* motion = scene.motion_after(f.index - 1);
  double most = 0;
  // A vertex that is not finite gives NaN, attached or not.
  for (const double x : f.state.position) most += 0 * x;
  for (std::size_t k = 0; motion != nullptr && k < scene.grips.vertices.size(); ++k) {
    if (motion->grip_held[k] == 0) continue;
    const Vec3 x = vertex_at(f.state.position, scene.grips.vertices[k]);
    most = max_or_nan(most, length(minus(x, motion->grip_position_m[k])));
  }
  return most;
}

/// Stretch that the attachments impose in a frame: their current distance divided by their distance at the start. It is
/// the maximum over all pairs that started at least a quarter of the cloth's shorter side apart, and at least 1.
double pulled(const Scene& scene, const std::vector<double>& start, std::size_t frame) {
  const FrameMotion& m = scene.motion[frame];
  const double apart = std::min(scene.cloth.width_m, scene.cloth.height_m) / 4;
  double most = 1;
  for (std::size_t i = 0; i < scene.grips.vertices.size(); ++i)
    for (std::size_t k = i + 1; k < scene.grips.vertices.size(); ++k) {
      if (m.grip_held[i] == 0 || m.grip_held[k] == 0) continue;
      const Vec3 a = vertex_at(start, scene.grips.vertices[i]), b = vertex_at(start, scene.grips.vertices[k]);
      const double rest = length(minus(b, a));
      if (rest >= apart) most = std::max(most, length(minus(m.grip_position_m[k], m.grip_position_m[i])) / rest);
    }
  return most;
}

/// Number of frames from the start during which any attachment is active.
std::size_t held_frames(const RunView& r) {
  std::size_t f = 0;
  for (; f < r.pass.time_s.size(); ++f) {
    const auto& holds = r.scene.motion[f].grip_held;
    if (std::find(holds.begin(), holds.end(), 1) == holds.end()) break;
  }
  return f;
}

bool has_grips(const RunView& r) {
  return !r.scene.grips.vertices.empty() && r.pass.time_s.size() <= r.scene.motion.size();
}

/// Largest ratio of an edge to its rest length, divided by the imposed stretch; maximum over the attached frames.
double edge_ratio(const RunView& r) {
  const std::vector<double>* most = r.series("stretch_max");
  if (!has_grips(r) || most == nullptr) return kMissing;
  const std::vector<double> start = initial_positions(r.scene);
  double all = -1;
  const std::size_t let_go = held_frames(r);
  for (std::size_t f = 0; f < let_go; ++f) all = max_or_nan(all, (1 + (*most)[f]) / pulled(r.scene, start, f));
  return all == -1 ? kMissing : all;
}

/// Strain one second after release (large in the failure that the paper's Fig. 13 shows).
double strain_released(const RunView& r) {
  const std::vector<double>*mean = r.series("stretch_mean_positive"), &t = r.pass.time_s;
  if (!has_grips(r) || mean == nullptr) return kMissing;
  const std::size_t let_go = held_frames(r);
  for (std::size_t f = let_go; f < t.size(); ++f)
    if (t[f] >= t[let_go] + 1 - 1e-9) return (*mean)[f];
  return kMissing;
}

}  // namespace

MetricGroup grips_metrics() {
  using enum SlackUnit;
  using enum Expect;
  static constexpr Gate kEdge{0.05, One, 0, false, "a twentieth of an edge"},
      kLeft{1e-3, One, 0.1, false, "a tenth of what is allowed"};
  constexpr Needs kHold{"attachments", [](const Scene& s) { return !s.grips.vertices.empty(); }};
  return {
      {{"grip_error_m", "m", "maximum distance of an attached vertex from its prescribed position", kHold, grip_error}},
      {{"grip_error_max_m", greatest("grip_error_m"), Yes, &kErrorGate},
       {"grip_edge_ratio_max",
        own({"stretch_max"},
            "maximum stretch ratio of a structural edge, divided by the stretch that the hands impose, while they are "
            "attached",
            edge_ratio, "1"),
        Yes, &kEdge},
       {"strain_mean_released",
        own({"stretch_mean_positive"},
            "mean strain of the structural edges (compressed edges count as 0), 1 s after the last hand released the "
            "cloth",
            strain_released, "1"),
        Yes, &kLeft}}};
}

}  // namespace clothbench
