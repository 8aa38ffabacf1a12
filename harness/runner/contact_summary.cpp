#include "runner/contact_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "clothbench/motion.hpp"
#include "metrics/metric.hpp"

namespace clothbench {
namespace {

constexpr double kSettled_s = 0.5;
constexpr int kPopFrames = 3;

const std::vector<double>* find(const AccuracyPass& pass, const std::string& name) {
  for (const MetricSeries& m : pass.metrics)
    if (m.name == name && !m.values.empty() && m.values.size() == pass.time_s.size()) return &m.values;
  return nullptr;
}

double greatest(const std::vector<double>* v, std::size_t from = 0) {
  if (v == nullptr || from >= v->size()) return kMissing;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t f = from; f < v->size(); ++f) most = max_or_nan(most, (*v)[f]);
  return most;
}

/// Mean over time, by trapezoids; NaN if any value is.
double time_mean(const std::vector<double>& v, const std::vector<double>& t) {
  if (v.size() < 2) return kMissing;
  double sum = 0;
  for (std::size_t f = 1; f < v.size(); ++f) sum += (t[f] - t[f - 1]) * (v[f] + v[f - 1]) / 2;
  return sum / (t.back() - t.front());
}

/// Distance [m] of vertex v between two stored frames.
double moved(const AccuracyPass& pass, std::size_t vertices, std::size_t v, std::size_t from, std::size_t to) {
  const float *a = &pass.position[3 * (from * vertices + v)], *b = &pass.position[3 * (to * vertices + v)];
  return norm(static_cast<double>(b[0]) - static_cast<double>(a[0]),
              static_cast<double>(b[1]) - static_cast<double>(a[1]),
              static_cast<double>(b[2]) - static_cast<double>(a[2]));
}

/// Popping: how far and how fast the cloth goes once a moving collider has left it (the paper's Fig. 8). A cloth that
/// swings back onto a hand at rest is no longer swept by it: the contact that counts is the last that began before the
/// hand stood still.
void summarise_popping(const Scene& scene, const AccuracyPass& pass, std::map<std::string, double>& s) {
  const std::vector<double>*touching = find(pass, "touching_fraction"), *speed = find(pass, "speed_max");
  const bool moves =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const Collider& c) { return c.moves(); });
  if (!moves || touching == nullptr || speed == nullptr || !std::isfinite(greatest(touching))) return;
  const std::vector<double> speeds = collider_speeds_m_per_s(scene);
  const double fastest = speeds.empty() ? 0 : *std::max_element(speeds.begin(), speeds.end());
  const auto rests = [&](std::size_t frame) {  // but for rounding; up to the frame and from it on
    return speeds[frame] <= 1e-6 * fastest && (frame + 1 == speeds.size() || speeds[frame + 1] <= 1e-6 * fastest);
  };
  std::size_t last = std::min(touching->size(), speeds.size());
  while (last > 0 && ((*touching)[last - 1] == 0 || rests(last - 1))) --last;
  if (last > 0)
    while (last < touching->size() && (*touching)[last] != 0) ++last;
  // Never touched, or touched to the end: nothing was let go.
  if (last == 0 || last == touching->size()) return;
  --last;
  const std::size_t vertices = scene.cloth.vertex_count();
  double far = 0;
  for (std::size_t f = last + 1; f < std::min(last + 1 + kPopFrames, pass.time_s.size()); ++f)
    for (std::size_t v = 0; v < vertices; ++v) far = max_or_nan(far, moved(pass, vertices, v, last, f));
  s["pop_displacement_m"] = far;
  s["pop_speed_m_per_s"] = greatest(speed, last + 1);
  // What may move so fast: what the collider pushed at up to twice its own speed (as off a bat), and what fell as far
  // as the cloth is long.
  const Vec3& g = scene.gravity_m_per_s2;
  const double fall = std::sqrt(2 * norm(g[0], g[1], g[2]) * std::max(scene.cloth.width_m, scene.cloth.height_m));
  const double limit = std::max(2 * fastest, fall);
  s["pop_speed_ratio"] = limit > 0 ? s["pop_speed_m_per_s"] / limit : kMissing;
}

/// Frames in which anything is through or inside a collider's surface.
std::vector<bool> violated(const AccuracyPass& pass) {
  std::vector<bool> out(pass.time_s.size(), false);
  for (const char* name : {"contact_length_m", "tunnelled_fraction", "wrong_side_samples"})
    if (const std::vector<double>* v = find(pass, name))
      for (std::size_t f = 0; f < out.size(); ++f) out[f] = out[f] || !((*v)[f] == 0);
  return out;
}

void summarise_violation(const AccuracyPass& pass, std::map<std::string, double>& s) {
  if (find(pass, "contact_length_m") == nullptr || pass.time_s.size() < 2) return;
  const std::vector<bool> bad = violated(pass);
  // A frame stands for the time up to it.
  double longest = 0, run = 0, first = kMissing, end = kMissing;
  for (std::size_t f = 0; f < bad.size(); ++f) {
    const double dt = f == 0 ? 0 : pass.time_s[f] - pass.time_s[f - 1];
    run = bad[f] ? run + dt : 0;
    longest = std::max(longest, run);
    if (!bad[f]) continue;
    if (!(first >= 0)) first = pass.time_s[f] - dt;
    end = pass.time_s[f];
  }
  s["contact_violated_longest_s"] = longest;
  s["untangle_s"] = bad.back() ? std::numeric_limits<double>::infinity() : end - first;
}

/// What the cloth crosses of itself beyond what it did at the start.
void summarise_self_contact(const Scene& scene, const AccuracyPass& pass, std::map<std::string, double>& s) {
  const std::vector<double>*length = find(pass, "self_contact_length_m"), *pairs = find(pass, "self_contact_pairs");
  if (length == nullptr || pairs == nullptr) return;
  const auto beyond = [](const std::vector<double>& v, double value) { return max_or_nan(0, value - v.front()); };
  s["self_contact_pairs_max"] = beyond(*pairs, greatest(pairs));
  s["self_contact_pairs_end"] = beyond(*pairs, pairs->back());
  s["self_contact_length_max_m"] = beyond(*length, greatest(length));
  if (pass.time_s.size() != static_cast<std::size_t>(scene.time.frames()) + 1) return;
  std::size_t from = pass.time_s.size() - 1;
  while (from > 0 && pass.time_s[from - 1] >= pass.time_s.back() - kSettled_s - 0.5 * scene.time.dt()) --from;
  s["self_contact_length_settled_m"] = beyond(*length, greatest(length, from));
}

/// Over the last half second: how the cloth trembles (second differences, which a steady drift leaves 0), how it
/// creeps.
void summarise_rest(const Scene& scene, const AccuracyPass& pass, std::map<std::string, double>& s) {
  const std::size_t vertices = scene.cloth.vertex_count(), frames = pass.time_s.size();
  if (frames != static_cast<std::size_t>(scene.time.frames()) + 1) return;
  std::size_t from = frames - 1;
  while (from > 0 && pass.time_s[from - 1] >= pass.time_s.back() - kSettled_s - 0.5 * scene.time.dt()) --from;
  if (frames - from < 3) return;
  double jitter = 0, drift = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t f = from + 1; f + 1 < frames; ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = [&](std::size_t frame) {
          return static_cast<double>(pass.position[3 * (frame * vertices + v) + k]);
        };
        const double bend = (at(f + 1) - 2 * at(f) + at(f - 1)) / 2;
        jitter += bend * bend;
      }
    const double way = moved(pass, vertices, v, from, frames - 1);
    drift += way * way;
  }
  const auto n = static_cast<double>(vertices);
  s["rest_jitter_m"] = std::sqrt(jitter / (n * static_cast<double>(frames - from - 2)));
  s["rest_drift_m_per_s"] = std::sqrt(drift / n) / (pass.time_s.back() - pass.time_s[from]);
  if (const std::vector<double>* slip = find(pass, "slip_m")) {
    s["slip_settled_m"] = 0;
    for (std::size_t f = from + 1; f < frames; ++f) s["slip_settled_m"] += (*slip)[f];
  }
}

/// What the hands that hold the cloth pull apart in a frame, over their distance at the start: the most of all pairs of
/// vertices that lay at least a quarter of the cloth's shorter side apart; at least 1.
double pulled(const Scene& scene, const std::vector<double>& start, std::size_t frame) {
  const FrameMotion& m = scene.motion[frame];
  const double apart = std::min(scene.cloth.width_m, scene.cloth.height_m) / 4;
  double most = 1;
  for (std::size_t i = 0; i < scene.grips.vertices.size(); ++i)
    for (std::size_t k = i + 1; k < scene.grips.vertices.size(); ++k) {
      if (m.grip_held[i] == 0 || m.grip_held[k] == 0) continue;
      const double *a = &start[3 * scene.grips.vertices[i]], *b = &start[3 * scene.grips.vertices[k]];
      const double rest = norm(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
      const Vec3 &p = m.grip_position_m[i], &q = m.grip_position_m[k];
      if (rest >= apart) most = std::max(most, norm(q[0] - p[0], q[1] - p[1], q[2] - p[2]) / rest);
    }
  return most;
}

/// Whether any hand that holds moves between a frame and the one before.
bool pulls(const Scene& scene, std::size_t frame) {
  if (frame == 0) return false;
  const FrameMotion &was = scene.motion[frame - 1], &is = scene.motion[frame];
  for (std::size_t g = 0; g < is.grip_held.size(); ++g)
    if (is.grip_held[g] != 0 && was.grip_position_m[g] != is.grip_position_m[g]) return true;
  return false;
}

/// How far the longest edge goes beyond what the hands impose, while they pull, once they hold, and what is left of the
/// strain a second after they let go (the failure of the paper's Fig. 13).
void summarise_grips(const Scene& scene, const AccuracyPass& pass, std::map<std::string, double>& s) {
  const std::vector<double>*most = find(pass, "stretch_max"), *mean = find(pass, "stretch_mean_positive");
  if (most == nullptr || mean == nullptr || pass.time_s.size() > scene.motion.size()) return;
  s["grip_error_max_m"] = greatest(find(pass, "grip_error_m"));
  constexpr std::size_t kSettling = 3;  // frames
  const std::vector<double> start = initial_positions(scene);
  double all = -1, held = -1;
  std::size_t moved_at = 0, let_go = 0;
  for (std::size_t f = 0; f < pass.time_s.size(); ++f) {
    const auto& holds = scene.motion[f].grip_held;
    if (std::find(holds.begin(), holds.end(), 1) == holds.end()) break;
    let_go = f + 1;
    if (pulls(scene, f)) moved_at = f;
    const double ratio = (1 + (*most)[f]) / pulled(scene, start, f);
    all = max_or_nan(all, ratio);
    // Hands that stand still before they pull are no pull that has ended.
    if (moved_at == f)
      held = -1;
    else if (moved_at > 0 && f >= moved_at + kSettling)
      held = max_or_nan(held, ratio);
  }
  s["grip_edge_ratio_max"] = all == -1 ? kMissing : all;
  s["grip_edge_ratio_held"] = held == -1 ? kMissing : held;
  for (std::size_t f = let_go; f < pass.time_s.size(); ++f)
    if (pass.time_s[f] >= pass.time_s[std::min(let_go, pass.time_s.size() - 1)] + 1 - 1e-9) {
      s["strain_mean_released"] = (*mean)[f];
      break;
    }
}

}  // namespace

double imposed_speed(const Scene& scene) {
  const nlohmann::json j = nlohmann::json::parse(scene.json, nullptr, false);
  double told = 0;
  for (const char* list : {"colliders", "grips"})
    if (j.is_object() && j.contains(list))
      for (const auto& item : j[list])
        if (item.is_object()) told = std::max(told, item.value("speed_m_per_s", 0.0));
  if (told > 0) return told;
  const double seen = std::max(collider_speed_m_per_s(scene), grip_speed_m_per_s(scene));
  const Vec3& v = scene.cloth.initial_velocity_m_per_s;
  return seen > 0 ? seen : norm(v[0], v[1], v[2]);
}

std::map<std::string, double> summarise_contact(const Scene& scene, const AccuracyPass& pass) {
  std::map<std::string, double> s;
  for (const char* name : {"imposed_speed_m_per_s",
                           "wrong_side_samples_max",
                           "wrong_side_fraction_max",
                           "wrong_side_fraction_end",
                           "fold_roughness_end",
                           "fold_angle_rms_end_rad",
                           "contact_length_mean_m",
                           "depth_time_mean_m",
                           "contact_violated_longest_s",
                           "untangle_s",
                           "pop_displacement_m",
                           "pop_speed_m_per_s",
                           "pop_speed_ratio",
                           "rest_jitter_m",
                           "rest_drift_m_per_s",
                           "slip_m",
                           "slip_settled_m",
                           "grip_error_max_m",
                           "grip_edge_ratio_max",
                           "grip_edge_ratio_held",
                           "strain_mean_released",
                           "self_contact_pairs_max",
                           "self_contact_pairs_end",
                           "self_contact_length_max_m",
                           "self_contact_length_settled_m"})
    s[name] = kMissing;
  summarise_self_contact(scene, pass, s);
  if (scene.colliders.empty() && scene.grips.vertices.empty()) return s;
  s["imposed_speed_m_per_s"] = imposed_speed(scene);
  if (!scene.grips.vertices.empty()) summarise_grips(scene, pass, s);
  if (scene.colliders.empty()) return s;
  const auto end = [](const std::vector<double>* v) { return v == nullptr ? kMissing : v->back(); };
  s["wrong_side_samples_max"] = greatest(find(pass, "wrong_side_samples"));
  s["wrong_side_fraction_max"] = greatest(find(pass, "wrong_side_fraction"));
  s["wrong_side_fraction_end"] = end(find(pass, "wrong_side_fraction"));
  s["fold_roughness_end"] = end(find(pass, "fold_roughness"));
  s["fold_angle_rms_end_rad"] = end(find(pass, "fold_angle_rms_rad"));
  const std::vector<double>*length = find(pass, "contact_length_m"), *depth = find(pass, "depth_mean_m"),
        *area = find(pass, "penetrating_area_m2");
  s["contact_length_mean_m"] = length == nullptr ? kMissing : time_mean(*length, pass.time_s);
  if (depth != nullptr && area != nullptr) {
    std::vector<double> spread;
    for (std::size_t f = 0; f < depth->size(); ++f)
      spread.push_back((*depth)[f] * (*area)[f] / (scene.cloth.width_m * scene.cloth.height_m));
    s["depth_time_mean_m"] = time_mean(spread, pass.time_s);
  }
  if (const std::vector<double>* slip = find(pass, "slip_m")) {
    s["slip_m"] = 0;
    for (const double way : *slip) s["slip_m"] += way;
  }
  summarise_violation(pass, s);
  summarise_popping(scene, pass, s);
  summarise_rest(scene, pass, s);
  return s;
}

}  // namespace clothbench
