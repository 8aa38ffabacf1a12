#include "metrics/stability/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "clothbench/vector.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {
namespace {

using namespace stability;

std::vector<Edge> structural(const Cloth& c) {
  std::vector<Edge> out;
  for (const Edge& e : edges(c, EdgeKind::Structural))
    if (e.rest_m > 0) out.push_back(e);  // a strain needs a length
  return out;
}

constexpr unsigned bit(int k) { return 1u << k; }

constexpr unsigned kDegrading = bit(2);

/// Lowest class of a set.
int least(unsigned classes) {
  int k = 0;
  while ((classes & bit(k)) == 0) ++k;
  return k;
}

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

StabilityJudge::StabilityJudge(const Scene& scene)
    : scene_(scene),
      bounds_(envelope(scene_)),
      mass_(vertex_masses(scene_)),
      start_(initial_positions(scene_)),
      edges_(structural(scene_.cloth)) {
  if (auto known = truth::reference_case_of(scene_); known && known->settles) at_rest_ = std::move(known);
  total_mass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
  longer_m_ = std::max(scene_.cloth.width_m, scene_.cloth.height_m);
  g_ = length(scene_.gravity_m_per_s2);
  stiffness_ = greatest_stiffness(scene_);
}

StabilityFrame StabilityJudge::judge(int frame, const ClothState& state, const TruthErrors* truth) {
  StabilityFrame out;
  if (!finite(state.position) || !finite(state.velocity)) {
    out.classes = bit(0);
    return out;
  }
  const Strain strain = strain_of(state.position);
  judge_motion(frame, state, strain, out);
  judge_strain(frame, strain, truth, out);
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

/// F0 and F1, and the frame from which F1 and F2 count.
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
  if (!(out.speed <= kSpeed)) out.classes |= bit(0);
  if (!relaxed_) return;
  // An energy within the rounding error of the coordinates counts as zero.
  const double scale = g_ > 0 ? total_mass_ * g_ * longer_m_ : total_mass_ * b.speed_m_per_s * b.speed_m_per_s;
  const double gained = std::max(0.0, visible_energy(state) - energy_base_J_ - (b.work_J - work_base_J_));
  out.energy_gain = scale > 0 ? gained / scale : gained > 0 ? std::numeric_limits<double>::infinity() : 0;
  if (!(out.energy_gain <= kGain)) out.classes |= bit(1);
}

bool StabilityJudge::settled(int frame) const {
  const double from = scene_.stability.settle_s;
  return frame == scene_.time.frames() || (from > 0 && scene_.time.at(frame) >= from);
}

/// F2. A reference case of a motion gives the strain of every edge; one of a shape at rest only once the cloth rests
/// there. Without a reference case, loads and hands give an upper bound of the true strain.
void StabilityJudge::judge_strain(int frame, const Strain& strain, const TruthErrors* truth, StabilityFrame& out) {
  const StabilityRules& rules = scene_.stability;
  if (!relaxed_) {
    stretched_frames_ = 0;
    if (rules.relax_s > 0 && !ever_relaxed_ && scene_.time.at(frame) > rules.relax_s) out.classes |= bit(2);
    return;
  }
  const Bounds& b = bounds_[static_cast<std::size_t>(frame)];
  const bool known = truth != nullptr && std::isfinite(truth->stretch_max) && (!at_rest_ || settled(frame));
  out.strain_excess = known ? truth->stretch_max : strain.greatest - b.strain;
  const double p99 = known ? truth->stretch_p99 : strain.p99 - b.strain;
  stretched_frames_ = out.strain_excess > kStrain ? stretched_frames_ + 1 : 0;
  if (stretched_frames_ > kStrainFrames || !(p99 <= kStrainP99) || !(out.strain_excess <= kTorn)) out.classes |= bit(2);
  if (at_rest_ && truth != nullptr && frame == scene_.time.frames()) {
    const double right = at_rest_->quantity(at_rest_->columns(frame));
    const double most = std::max(kQuantity * std::abs(right), kQuantityLength * longer_m_);
    if (!(std::abs(truth->quantity - right) <= most)) out.classes |= bit(2);
  }
}

StabilityVerdict stability_verdict(const AccuracyPass& pass) {
  StabilityVerdict out;
  const auto series = std::find_if(pass.metrics.begin(), pass.metrics.end(),
                                   [](const MetricSeries& m) { return m.name == "stability_classes"; });
  const std::vector<double>* classes = series == pass.metrics.end() ? nullptr : &series->values;
  if (classes == nullptr) return out;
  for (const bool fatal : {true, false})
    for (std::size_t f = 0; f < classes->size(); ++f) {
      const auto set = static_cast<unsigned>((*classes)[f]) & (fatal ? ~kDegrading : kDegrading);
      if (set == 0) continue;
      out.grade = fatal ? StabilityVerdict::Grade::Failed : StabilityVerdict::Grade::Degraded;
      out.klass = "F" + std::to_string(least(set));
      out.frame = static_cast<int>(f);
      return out;
    }
  return out;
}

const char* name_of(StabilityVerdict::Grade g) {
  static constexpr const char* kNames[] = {"stable", "degraded", "failed"};
  return kNames[static_cast<std::size_t>(g)];
}

std::string class_name(int k) {
  static constexpr const char* kNames[] = {"not finite or unbounded", "energy gained", "strain beyond the load",
                                           "budget or device"};
  return "F" + std::to_string(k) + " " + kNames[k];
}

}  // namespace clothbench
