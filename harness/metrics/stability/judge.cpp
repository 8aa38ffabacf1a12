#include "metrics/stability/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "clothbench/vector.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {
namespace {

using namespace stability;

/// Twice the triangle's area, as a vector along its normal.
Vec3 area_vector(const std::vector<double>& x, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return cross(minus(vertex_at(x, b), vertex_at(x, a)), minus(vertex_at(x, c), vertex_at(x, a)));
}

/// Inner edges: both corners of the edge in the first triangle's winding order, then the two opposite corners.
std::vector<std::array<std::uint32_t, 4>> folds_of(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::uint32_t, 3>> open;
  std::vector<std::array<std::uint32_t, 4>> out;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const auto other = open.find({b, a});
      if (other == open.end())
        open[{a, b}] = {a, b, c};
      else
        out.push_back({other->second[0], other->second[1], other->second[2], c});
    }
  return out;
}

std::vector<Edge> structural(const Cloth& c) {
  std::vector<Edge> out;
  for (const Edge& e : edges(c, EdgeKind::Structural))
    if (e.rest_m > 0) out.push_back(e);  // a strain needs a length
  return out;
}

constexpr unsigned bit(int k) { return 1u << k; }

/// Converts the strain of the diagonals to energy: a shear of g strains them by g/2 and stores G g^2/2, G = 3/8 Y;
/// reported over Y/2.
double shear_square(const Scene& scene, const std::vector<double>& x) {
  if (!scene.needs.has(Feature::Shear)) return 0;
  double squares = 0;
  const std::vector<Edge> all = edges(scene.cloth, EdgeKind::Shear);
  for (const Edge& e : all) squares += std::pow(length(minus(vertex_at(x, e.b), vertex_at(x, e.a))) / e.rest_m - 1, 2);
  return 1.5 * squares / static_cast<double>(all.size());
}

}  // namespace

StabilityJudge::StabilityJudge(const MetricContext& context)
    : context_(context),
      scene_(context.scene),
      bounds_(envelope(scene_)),
      mass_(vertex_masses(scene_)),
      start_(initial_positions(scene_)),
      edges_(structural(scene_.cloth)),
      triangles_(triangles(scene_.cloth)),
      folds_(folds_of(triangles_)) {
  if (auto known = truth::reference_case_of(scene_); known && known->settles) at_rest_ = std::move(known);
  const bool moving_capsule = std::any_of(scene_.colliders.begin(), scene_.colliders.end(),
                                          [](const Collider& c) { return c.capsules.size() == 1; });
  if (moving_capsule) crossing_ = std::make_unique<CapsuleCrossing>(scene_);
  total_mass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
  longer_m_ = std::max(scene_.cloth.width_m, scene_.cloth.height_m);
  g_ = length(scene_.gravity_m_per_s2);
  stiffness_ = greatest_stiffness(scene_);
}

StabilityFrame StabilityJudge::judge(int frame, const ClothState& state, const SceneContact* contact,
                                     const TruthErrors* truth) {
  StabilityFrame out;
  if (!finite(state.position) || !finite(state.velocity)) {
    out.classes = bit(0);
    return out;
  }
  const Strain strain = strain_of(state.position);
  judge_motion(frame, state, strain, out);
  judge_strain(frame, strain, truth, out);
  judge_geometry(state, out);
  judge_contact(frame, state, contact, out);
  judge_rest(frame, state, out);
  judge_fall(frame, state, out);
  out.classes &= scene_.stability.judged | bit(0);
  return out;
}

StabilityJudge::Strain StabilityJudge::strain_of(const std::vector<double>& x) const {
  std::vector<double> all;
  double sum = 0, squares = 0;
  for (const Edge& e : edges_) {
    all.push_back(length(minus(vertex_at(x, e.b), vertex_at(x, e.a))) / e.rest_m - 1);
    sum += std::abs(all.back());
    squares += all.back() * all.back();
  }
  const auto n = static_cast<double>(all.size());
  const auto p99 = all.begin() + static_cast<std::ptrdiff_t>(0.99 * (n - 1));
  std::nth_element(all.begin(), p99, all.end());
  return {sum / n, std::sqrt(squares / n), *std::max_element(p99, all.end()), *p99};
}

double StabilityJudge::visible_energy(const ClothState& s) const {
  double energy = 0;
  for (std::size_t v = 0; v < mass_.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      const double speed = s.velocity[3 * v + k];
      energy +=
          mass_[v] * (0.5 * speed * speed - scene_.gravity_m_per_s2[k] * (s.position[3 * v + k] - start_[3 * v + k]));
    }
  return energy;
}

/// F1 and F2, and the frame from which F1 to F3 count.
void StabilityJudge::judge_motion(int frame, const ClothState& state, const Strain& strain, StabilityFrame& out) {
  const Bounds& b = bounds_[static_cast<std::size_t>(frame)];
  const Bounds& base = bounds_[0];
  const auto set_base = [&] {
    const double area = scene_.cloth.width_m * scene_.cloth.height_m;
    energy_base_J_ = visible_energy(state) +
                     0.5 * stiffness_ * area * (strain.rms * strain.rms + shear_square(scene_, state.position));
    work_base_J_ = b.work_J;
  };
  if (frame == 0) {
    set_base();
    work_base_J_ = base.work_J;
  }
  const StabilityRules& rules = scene_.stability;
  if (!rules.when_relaxed)
    relaxed_ = true;
  else if (b.jumped)
    relaxed_ = false;
  else if (!relaxed_ && strain.mean < kRelaxed) {
    relaxed_ = ever_relaxed_ = true;
    set_base();
  }
  double speed = 0;
  for (std::size_t v = 0; v < state.velocity.size(); v += 3)
    speed = std::max(speed, length(vertex_at(state.velocity, v / 3)));
  const double allowed = relaxed_ ? b.speed_m_per_s : std::max(b.speed_m_per_s, b.jump_speed_m_per_s);
  out.speed = allowed > 0 ? speed / allowed : speed > 0 ? std::numeric_limits<double>::infinity() : 0;
  if (!(out.speed <= kSpeed)) out.classes |= bit(1);
  if (!relaxed_) return;
  // An energy within the rounding error of the coordinates counts as zero.
  const double scale = g_ > 0 ? total_mass_ * g_ * longer_m_ : total_mass_ * b.speed_m_per_s * b.speed_m_per_s;
  const double gained = std::max(0.0, visible_energy(state) - energy_base_J_ - (b.work_J - work_base_J_));
  out.energy_gain = scale > 0 ? gained / scale : gained > 0 ? std::numeric_limits<double>::infinity() : 0;
  if (!(out.energy_gain <= kGain)) out.classes |= bit(2);
}

bool StabilityJudge::settled(int frame) const {
  const double from = scene_.stability.settle_s;
  return frame == scene_.time.frames() || (from > 0 && scene_.time.at(frame) >= from);
}

/// F3. A reference case of a motion gives the strain of every edge; one of a shape at rest only once the cloth rests
/// there. Without a reference case, loads and hands give an upper bound of the true strain.
void StabilityJudge::judge_strain(int frame, const Strain& strain, const TruthErrors* truth, StabilityFrame& out) {
  const StabilityRules& rules = scene_.stability;
  if (!relaxed_) {
    stretched_frames_ = 0;
    if (rules.relax_s > 0 && !ever_relaxed_ && scene_.time.at(frame) > rules.relax_s) out.classes |= bit(3);
    return;
  }
  const Bounds& b = bounds_[static_cast<std::size_t>(frame)];
  const bool known = truth != nullptr && std::isfinite(truth->stretch_max) && (!at_rest_ || settled(frame));
  out.strain_excess = known ? truth->stretch_max : strain.greatest - b.strain;
  out.strain_p99 = known ? truth->stretch_p99 : strain.p99 - b.strain;
  stretched_frames_ = out.strain_excess > kStrain ? stretched_frames_ + 1 : 0;
  if (stretched_frames_ > kStrainFrames || !(out.strain_p99 <= kStrainP99) || !(out.strain_excess <= kTorn))
    out.classes |= bit(3);
  if (at_rest_ && truth != nullptr && frame == scene_.time.frames()) {
    const double right = at_rest_->quantity(at_rest_->columns(frame));
    const double most = std::max(kQuantity * std::abs(right), kQuantityLength * longer_m_);
    if (!(std::abs(truth->quantity - right) <= most)) out.classes |= bit(3);
  }
}

void StabilityJudge::judge_geometry(const ClothState& state, StabilityFrame& out) const {
  if ((scene_.stability.judged & bit(4)) == 0 || !relaxed_) return;
  const Cloth& c = scene_.cloth;
  double bad = 0, counted = 0;
  for (const auto& t : triangles_) {
    const double u = rest_distance(c, t[0], t[1]), v = rest_distance(c, t[1], t[2]), w = rest_distance(c, t[2], t[0]);
    const double half = (u + v + w) / 2, rest = std::sqrt(std::max(0.0, half * (half - u) * (half - v) * (half - w)));
    if (!(rest > 0)) continue;
    const double share = length(area_vector(state.position, t[0], t[1], t[2])) / 2 / rest;
    counted += 1;
    if (!(share >= kAreaLow && share <= kAreaHigh)) bad += 1;
  }
  double folded = 0;
  const double sharpest = std::cos(kFoldDegrees * std::numbers::pi / 180);
  for (const auto& f : folds_) {
    const Vec3 a = area_vector(state.position, f[0], f[1], f[2]), b = area_vector(state.position, f[1], f[0], f[3]);
    if (dot(a, b) < sharpest * length(a) * length(b)) folded += 1;
  }
  out.bad_geometry =
      std::max(counted > 0 ? bad / counted : 0, folds_.empty() ? 0 : folded / static_cast<double>(folds_.size()));
  if (!(out.bad_geometry <= kBadShare)) out.classes |= bit(4);
}

void StabilityJudge::judge_contact(int frame, const ClothState& state, const SceneContact* contact,
                                   StabilityFrame& out) {
  if (contact == nullptr || (scene_.stability.judged & bit(5)) == 0) return;
  const bool through = (crossing_ && crossing_->add(frame, state.position) != 0) || contact->tunnelled_fraction > 0;
  double margin = 0;
  for (const Collider& c : scene_.colliders) margin = std::max(margin, c.margin_m);
  const double cell = std::max(scene_.cloth.du(), scene_.cloth.dv()),
               limit = std::max(kDepthMargins * margin, kDepthCells * cell);
  // Grace period: cloth that starts inside, or was just placed inside, may be on its way out.
  double since = scene_.time.at(frame);
  for (const Jump& jump : scene_.jumps)
    if (jump.frame <= frame) since = std::min(since, scene_.time.at(frame) - scene_.time.at(jump.frame));
  if (std::isfinite(contact->depth_m) && since > kContactGrace_s) out.depth = contact->depth_m / limit;
  if (through) out.depth = std::numeric_limits<double>::infinity();
  const bool lodged = scene_.stability.settle_s > 0 && settled(frame) && contact->length_m > 0;
  if (through || lodged || out.depth > 1) out.classes |= bit(5);
}

void StabilityJudge::judge_rest(int frame, const ClothState& state, StabilityFrame& out) {
  if ((scene_.stability.judged & bit(6)) == 0 || !settled(frame)) return;
  double squares = 0, moved = 0;
  for (std::size_t v = 0; v < mass_.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) squares += mass_[v] * state.velocity[3 * v + k] * state.velocity[3 * v + k];
  const double scale = g_ > 0 ? std::sqrt(g_ * longer_m_) : bounds_.back().speed_m_per_s;
  out.unrest = std::sqrt(squares / total_mass_) / scale;
  bool restless = !(out.unrest <= kUnrest);
  if (settled_at_.empty()) {
    settled_at_ = state.position;
    settled_s_ = scene_.time.at(frame);
  }
  const double since = scene_.time.at(frame) - settled_s_;
  for (std::size_t k = 0; k < settled_at_.size(); ++k)
    moved += (state.position[k] - settled_at_[k]) * (state.position[k] - settled_at_[k]);
  const double drift = std::sqrt(moved / static_cast<double>(mass_.size())) / longer_m_;
  // Over a shorter time the noise of a cloth that is still settling would be taken for a drift rate.
  if (since >= kDriftFrom_s && !(drift <= kDriftPerMinute * since / 60)) restless = true;
  if (restless) out.classes |= bit(6);
}

/// F7: the centre of mass against the solver's own integrator, which has no other error than rounding.
void StabilityJudge::judge_fall(int frame, const ClothState& state, StabilityFrame& out) const {
  const bool falls =
      scene_.pins.vertices.empty() && scene_.grips.vertices.empty() && scene_.colliders.empty() && g_ > 0;
  if ((scene_.stability.judged & bit(7)) == 0 || !falls || !scene_.time.ends_s.empty()) return;
  const double t = scene_.time.at(frame);
  if (t < kFallFrom_s || frame < 2) return;
  double error = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (scene_.gravity_m_per_s2[k] == 0) continue;
    Scene body;
    body.cloth = scene_.cloth;
    body.material = scene_.material;
    body.time = scene_.time;
    body.needs = scene_.needs;
    body.gravity_m_per_s2 = {0, scene_.gravity_m_per_s2[k], 0};
    body.cloth.initial_velocity_m_per_s = {0, scene_.cloth.initial_velocity_m_per_s[k], 0};
    double moved = 0;
    for (std::size_t v = 0; v < mass_.size(); ++v) moved += mass_[v] * (state.position[3 * v + k] - start_[3 * v + k]);
    const double d = moved / total_mass_ - context_.entry.free_fall_m(body, context_.settings, frame);
    error += d * d;
  }
  out.fall_error = std::sqrt(error) / (0.5 * g_ * t * t);
  if (!(out.fall_error <= kFall)) out.classes |= bit(7);
}

}  // namespace clothbench
