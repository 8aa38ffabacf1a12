// How the cloth intersects the colliders of its scene: results of ColliderContact per frame, and scalars of a run.
#include <algorithm>
#include <limits>

#include "metrics/collider_contact.hpp"
#include "metrics/reduction.hpp"

namespace clothbench {
namespace {

bool can_tunnel(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), counts_crossings);
}

bool has_depth(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), has_inside);
}

auto contact_field(double SceneContact::*field) {
  return [field](const MetricFrame& f) { return f.contact->*field; };
}

/// Depth times area over the cloth's area, mean over time.
double spread_depth(const RunView& r) {
  const std::vector<double>*depth = r.series("depth_mean_m"), *area = r.series("penetrating_area_m2");
  if (depth == nullptr || area == nullptr) return kMissing;
  std::vector<double> spread;
  for (std::size_t f = 0; f < depth->size(); ++f)
    spread.push_back((*depth)[f] * (*area)[f] / (r.scene.cloth.width_m * r.scene.cloth.height_m));
  return mean_over_time(spread, r.pass.time_s);
}

/// Series that measure cloth through or inside a collider's surface.
std::vector<std::string> violating() { return {"contact_length_m", "tunnelled_fraction", "wrong_side_samples"}; }

/// Frames in which any cloth is through or inside a collider's surface; none if that is not known.
std::vector<bool> violated(const RunView& r) {
  if (r.series("contact_length_m") == nullptr || r.pass.time_s.size() < 2) return {};
  std::vector<bool> out(r.pass.time_s.size(), false);
  for (const std::string& name : violating())
    if (const std::vector<double>* v = r.series(name))
      for (std::size_t f = 0; f < out.size(); ++f) out[f] = out[f] || !((*v)[f] == 0);
  return out;
}

/// Time [s] that a frame represents: the interval before it.
double time_of(const RunView& r, std::size_t frame) {
  return frame == 0 ? 0 : r.pass.time_s[frame] - r.pass.time_s[frame - 1];
}

double violated_longest(const RunView& r) {
  const std::vector<bool> bad = violated(r);
  return bad.empty() ? kMissing : longest_time(bad, r.pass.time_s);
}

/// Infinite if the last frame is violated.
double untangle(const RunView& r) {
  const std::vector<bool> bad = violated(r);
  const auto first = std::find(bad.begin(), bad.end(), true);
  if (first == bad.end()) return kMissing;
  if (bad.back()) return std::numeric_limits<double>::infinity();
  const auto from = static_cast<std::size_t>(first - bad.begin());
  std::size_t to = bad.size() - 1;
  while (!bad[to]) --to;
  return r.pass.time_s[to] - (r.pass.time_s[from] - time_of(r, from));
}

std::vector<Metric> contact_series() {
  using C = SceneContact;
  constexpr Needs kMeshes{"mesh colliders", can_tunnel}, kInside{"colliders with an inside", has_depth};
  return {
      {"contact_length_m", "m", "length of the curves in which cloth and colliders cross", kColliders,
       contact_field(&C::length_m), plotted("contour [m]", 2, 1)},
      {"contact_pairs", "1", "pairs of cloth triangle and collider triangle or capsule that meet", kColliders,
       contact_field(&C::pairs)},
      {"contact_cloth_fraction", "1", "share of the cloth's triangles in such a pair", kColliders,
       contact_field(&C::cloth_fraction)},
      {"tunnelled_fraction", "1", "share of the cloth that has passed to the other side of a mesh", kMeshes,
       contact_field(&C::tunnelled_fraction), plotted("tunnelled share of the cloth", 1, 2)},
      {"tunnelled_depth_m", "m", "greatest distance of a tunnelled vertex from the mesh", kMeshes,
       contact_field(&C::tunnelled_depth_m), plotted("tunnelled depth [m]", 3, 3)},
      {"depth_m", "m", "greatest depth in a collider, between the vertices too", kInside, contact_field(&C::depth_m),
       plotted("depth [m]", 4, 4)},
      {"depth_vertex_m", "m", "greatest depth of a vertex in a collider", kInside, contact_field(&C::depth_vertex_m),
       plotted("depth at vertices [m]", 5, 5)},
      {"depth_p99_m", "m", "depth that 99 % of the penetrating area keeps below", kInside,
       contact_field(&C::depth_p99_m)},
      {"depth_mean_m", "m", "mean depth of the penetrating area", kInside, contact_field(&C::depth_mean_m)},
      {"penetrating_area_m2", "m2", "area of the cloth inside colliders", kInside, contact_field(&C::area_m2)},
  };
}

}  // namespace

// Slack. Contact amplifies rounding until a fold lies elsewhere, so differences appear as whole edges and percents. The
// slack of contour lengths is a third of an edge of a 32 x 32 cloth, and that of depths at most half of the millimetre
// that the scenes' own verdicts allow. Those verdicts hold without any additional slack.
MetricGroup contact_metrics() {
  using enum SlackUnit;
  static constexpr Gate kShare{2e-3, One, 0.1, true, "two vertices of a 32 × 32 cloth"},
      kTunnelDepth{1e-3, Length, 0.1, true, "a millimetre on a cloth of 1 m"},
      kAtRest{1e-2, Length, 0.1, true, "a third of an edge of a 32 × 32 cloth"},
      kImpact{0.1, Length, 0.5, false, "one moment of an impact, three edges"},
      kDepth{5e-4, Length, 0.1, false, "half a millimetre on a cloth of 1 m"},
      kCell{1e-3, Area, 0.15, false, "one cell of a 32 × 32 grid"},
      kMoment{0.05, One, 0.25, false, "four frames at 72 Hz"};
  using enum Expect;
  return {contact_series(),
          {{"tunnelled_fraction_max", greatest("tunnelled_fraction"), Yes, &kShare, 10},
           {"tunnelled_fraction_end", last("tunnelled_fraction"), Yes, &kShare, 20},
           {"tunnelled_depth_max_m", greatest("tunnelled_depth_m"), Yes, &kTunnelDepth, 30},
           {"contact_length_max_m", greatest("contact_length_m"), Yes, &kImpact, 40},
           {"contact_length_settled_m", greatest_settled("contact_length_m"), Yes, &kAtRest, 50},
           {"depth_max_m", greatest("depth_m"), Yes, &kDepth, 60},
           {"depth_vertex_max_m", greatest("depth_vertex_m"), Yes, &kDepth, 70},
           {"depth_p99_m", greatest("depth_p99_m"), Yes, &kDepth, 80},
           {"depth_mean_m", greatest("depth_mean_m"), Yes, &kDepth, 90},
           {"penetrating_area_max_m2", greatest("penetrating_area_m2"), Yes, &kCell, 100},
           {"contact_length_mean_m", time_mean("contact_length_m"), No, nullptr, 180},
           {"depth_time_mean_m",
            own({"depth_mean_m", "penetrating_area_m2"}, "depth times area over the cloth's area, mean over time",
                spread_depth, "m"),
            No, &kDepth, 190},
           {"contact_violated_longest_s",
            own(violating(),
                "longest time without a break in which cloth and colliders cross or cloth is on the wrong side",
                violated_longest, "s"),
            Yes, &kMoment, 200},
           {"untangle_s",
            own(violating(),
                "time from the first frame in which they cross or cloth is on the wrong side to the last; infinite if "
                "that is the end",
                untangle, "s"),
            Yes, nullptr, 210}}};
}

}  // namespace clothbench
