#include "metrics/stability/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace clothbench {
namespace {

using Bounds = StabilityJudge::Bounds;

// Thresholds of the outcome classes, all chosen for this project; published work rarely states its own.
constexpr double kSpeed = 10;        // F0: speed over v_char
constexpr double kGain = 0.1;        // F1: energy gained, divided by M g L
constexpr double kStrain = 0.10;     // F2: maximum strain beyond the exact or load strain, in more than kStrainFrames
constexpr int kStrainFrames = 3;     // consecutive frames
constexpr double kStrainP99 = 0.05;  // F2: 99th percentile, in any frame
constexpr double kTorn = 1;          // F2: maximum strain beyond the exact or load strain, in any frame
constexpr double kRelaxed = 0.01;    // if delayed: F1 and F2 are evaluated once mean |strain| is below this
constexpr double kQuantity = 0.02, kQuantityLength = 1e-3;  // F2 at the end: error of the quantity at rest

double distance(const Vec3& a, const Vec3& b) { return length(minus(a, b)); }

/// Rest length of the straight line between two vertices [m].
double rest_distance(const Cloth& c, std::uint32_t a, std::uint32_t b) {
  if (c.mesh) return distance(c.mesh->vertices[a], c.mesh->vertices[b]);
  const int ia = static_cast<int>(a) % c.columns, ib = static_cast<int>(b) % c.columns;
  const int ja = static_cast<int>(a) / c.columns, jb = static_cast<int>(b) / c.columns;
  return std::hypot(c.line_u_m(ia) - c.line_u_m(ib), (ja - jb) * c.dv());
}

/// Largest strain between two held vertices, at least one of them attached; if `m` is null, between two pinned ones.
double imposed_strain(const Scene& s, const std::vector<double>& start, const FrameMotion* m) {
  std::vector<std::pair<std::uint32_t, Vec3>> held;
  for (const std::uint32_t v : s.pins.vertices) held.emplace_back(v, vertex_at(start, v));
  const std::size_t first = m == nullptr ? 0 : held.size();
  for (std::size_t k = 0; m != nullptr && k < s.grips.vertices.size(); ++k)
    if (m->grip_held[k] != 0) held.emplace_back(s.grips.vertices[k], m->grip_position_m[k]);
  double most = 0;
  for (std::size_t i = first; i < held.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double rest = rest_distance(s.cloth, held[i].first, held[j].first); rest > 0)
        most = std::max(most, distance(held[i].second, held[j].second) / rest - 1);
  return most;
}

/// Maximum displacement of a hand or of a capsule's end in one frame.
double step_of(const FrameMotion& a, const FrameMotion& b, bool hands) {
  double most = 0;
  if (hands) {
    for (std::size_t i = 0; i < a.grip_position_m.size(); ++i)
      if (b.grip_held[i] != 0) most = std::max(most, distance(a.grip_position_m[i], b.grip_position_m[i]));
    return most;
  }
  for (std::size_t k = 0; k < a.colliders.size(); ++k)
    for (std::size_t c = 0; c < a.colliders[k].capsules.size(); ++c) {
      const Capsule &p = a.colliders[k].capsules[c], &q = b.colliders[k].capsules[c];
      most = std::max({most, distance(p.a_m, q.a_m), distance(p.b_m, q.b_m)});
    }
  return most;
}

/// Maximum distance of a start position from the flat rest position, and the start's maximum structural strain.
std::pair<double, double> start_of(const Scene& s) {
  const std::vector<double> x = initial_positions(s);
  double far = 0, strain = 0;
  for (int j = 0; j < s.cloth.rows; ++j)
    for (int i = 0; i < s.cloth.columns; ++i) {
      const auto v = static_cast<std::size_t>(j * s.cloth.columns + i);
      far = std::max(far, distance(vertex_at(x, v), s.rest_position(i, j)));
    }
  for (const Edge& e : edges(s.cloth, EdgeKind::Structural))
    if (e.rest_m > 0) strain = std::max(strain, distance(vertex_at(x, e.a), vertex_at(x, e.b)) / e.rest_m - 1);
  return {far, strain};
}

/// Maximum membrane stiffness in the scene [N/m]; 0 = inextensible.
double greatest_stiffness(const Scene& s) {
  double most = s.material.membrane_stiffness_N_per_m.value_or(0);
  for (const StiffnessRegion& r : s.material.regions) most = std::max(most, r.membrane_stiffness_N_per_m.value_or(0));
  return most;
}

/// The bounds at every frame; frame 0 is the start.
///
/// Free fall: sqrt(2 g H), H = twice the diagonal for pinned or attached cloth, otherwise the diagonal plus g t^2/2.
/// Waves: a strain e travels at c = sqrt(Y/rho) with particle speed e c. The static strain is M g/(Y w), w the shorter
/// side; sudden loads double it. The strain bound adds 3 v/c for hands (wave and first reflections), 2 v/c for
/// colliders, and v/c for cloth that falls slack and is stopped suddenly.
std::vector<Bounds> envelope(const Scene& s) {
  const Cloth& c = s.cloth;
  const std::vector<double> mass = vertex_masses(s);
  const double M = std::accumulate(mass.begin(), mass.end(), 0.0), g = length(s.gravity_m_per_s2),
               Y = greatest_stiffness(s);
  double softest = Y;
  for (const StiffnessRegion& r : s.material.regions)
    softest = std::min(softest, r.membrane_stiffness_N_per_m.value_or(softest));
  if (s.material.membrane_stiffness_N_per_m) softest = std::min(softest, *s.material.membrane_stiffness_N_per_m);
  const double wave = Y > 0 ? std::sqrt(Y / c.areal_density_kg_per_m2) : 0,
               diagonal = std::hypot(c.width_m, c.height_m);
  const double shorter = std::min(c.width_m, c.height_m);
  const bool held = !s.pins.vertices.empty() || !s.grips.vertices.empty();
  const auto [far, start_strain] = start_of(s);
  const double v0 = length(c.initial_velocity_m_per_s) + length(c.spin_rad_per_s) * diagonal / 2;
  const double loads = softest > 0 && (held || !s.colliders.empty()) ? 2 * M * g / (softest * shorter) : 0;
  const std::vector<double> start = initial_positions(s);
  std::vector<Bounds> out;
  double v_hand = 0, v_collider = 0, path = 0, imposed = imposed_strain(s, start, nullptr), jump_speed = 0;
  for (int f = 0; f <= s.time.frames(); ++f) {
    Bounds b;
    const FrameMotion* now = s.motion.empty() ? nullptr : &s.motion[static_cast<std::size_t>(f)];
    for (const Jump& jump : s.jumps)
      if (jump.frame == f) {
        b.jumped = true;
        jump_speed = std::max(jump_speed, jump.distance_m / s.time.dt_after(f - 1));
      }
    // A start that is not at rest counts as a jump.
    if (f == 0 && !c.start.at_rest()) {
      b.jumped = c.start.shape != Start::Shape::Rest || !c.start.merged.empty() || !c.start.moved.empty();
      if (b.jumped) jump_speed = far / s.time.dt_after(0);
    }
    if (f > 0 && now != nullptr) {
      const FrameMotion& before = s.motion[static_cast<std::size_t>(f - 1)];
      const double dt = s.time.dt_after(f - 1), hand = step_of(before, *now, true),
                   collider = step_of(before, *now, false);
      path += hand + collider;
      if (!b.jumped) {
        v_hand = std::max(v_hand, hand / dt);
        v_collider = std::max(v_collider, collider / dt);
      }
    }
    if (now != nullptr) imposed = std::max(imposed, imposed_strain(s, start, now));
    const double t = s.time.at(f), H = (held ? 2 : 1) * diagonal + far + (held ? 0 : 0.5 * g * t * t),
                 fall = std::sqrt(2 * g * H);
    b.strain = std::max(0.0, imposed) + loads + (s.stability.when_relaxed ? 0 : std::max(0.0, start_strain));
    // Cloth that falls slack is stopped suddenly: v/c.
    if (wave > 0) b.strain += (3 * v_hand + 2 * v_collider + (held || !s.colliders.empty() ? fall : 0)) / wave;
    b.speed_m_per_s = std::max({fall, v_hand, v_collider, v0});
    // Without compliance, stretched cloth returns within one frame.
    b.speed_m_per_s =
        std::max(b.speed_m_per_s, wave > 0 ? b.strain * wave : imposed * std::max(c.width_m, c.height_m) / s.time.dt());
    b.jump_speed_m_per_s = std::max(jump_speed, far > 0 && wave > 0 ? start_strain * wave : 0);
    const double v = 2 * std::max(v_hand, v_collider), way = std::min(path, 1e3 * diagonal);
    b.work_J = 0.5 * M * v * v + M * g * way + Y * shorter * b.strain * way;
    out.push_back(b);
  }
  return out;
}

constexpr unsigned bit(int k) { return 1u << k; }

constexpr unsigned kDegrading = bit(2);

/// Index of the lowest class in a set.
int least(unsigned classes) {
  int k = 0;
  while ((classes & bit(k)) == 0) ++k;
  return k;
}

/// Elastic energy of the diagonals, divided by Y/2: a shear g strains them by g/2 and stores G g^2/2, G = 3/8 Y.
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
      edges_(edges(scene_.cloth, EdgeKind::Structural)) {
  std::erase_if(edges_, [](const Edge& e) { return !(e.rest_m > 0); });  // strain needs a positive rest length
  if (auto known = truth::reference_case_of(scene_); known && known->settles) at_rest_ = std::move(known);
  total_mass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
  longer_m_ = std::max(scene_.cloth.width_m, scene_.cloth.height_m);
  g_ = length(scene_.gravity_m_per_s2);
  stiffness_ = greatest_stiffness(scene_);
}

StabilityFrame StabilityJudge::judge(int frame, const ClothState& state, const std::optional<TruthErrors>& truth) {
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

/// Evaluates F0 and F1, and finds the frame from which F1 and F2 are evaluated.
void StabilityJudge::judge_motion(int frame, const ClothState& state, const Strain& strain, StabilityFrame& out) {
  const Bounds& b = bounds_[static_cast<std::size_t>(frame)];
  const auto set_base = [&] {
    const double area = scene_.cloth.width_m * scene_.cloth.height_m;
    energy_base_J_ = visible_energy(state) +
                     0.5 * stiffness_ * area * (strain.rms * strain.rms + shear_square(scene_, state.position));
    work_base_J_ = b.work_J;
  };
  if (frame == 0) set_base();
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

/// Evaluates F2. A moving reference case gives the exact strain of every edge; a reference case at rest gives it only
/// once the cloth rests. Without a reference case, loads and hands give an upper bound of the strain.
void StabilityJudge::judge_strain(int frame, const Strain& strain, const std::optional<TruthErrors>& truth,
                                  StabilityFrame& out) {
  const StabilityRules& rules = scene_.stability;
  if (!relaxed_) {
    stretched_frames_ = 0;
    if (rules.relax_s > 0 && !ever_relaxed_ && scene_.time.at(frame) > rules.relax_s) out.classes |= bit(2);
    return;
  }
  const Bounds& b = bounds_[static_cast<std::size_t>(frame)];
  const bool known = truth && std::isfinite(truth->stretch_max) && (!at_rest_ || settled(frame));
  out.strain_excess = known ? truth->stretch_max : strain.greatest - b.strain;
  const double p99 = known ? truth->stretch_p99 : strain.p99 - b.strain;
  stretched_frames_ = out.strain_excess > kStrain ? stretched_frames_ + 1 : 0;
  if (stretched_frames_ > kStrainFrames || !(p99 <= kStrainP99) || !(out.strain_excess <= kTorn)) out.classes |= bit(2);
  if (at_rest_ && truth && frame == scene_.time.frames()) {
    const double right = at_rest_->quantity(at_rest_->columns(frame));
    const double most = std::max(kQuantity * std::abs(right), kQuantityLength * longer_m_);
    if (!(std::abs(truth->quantity - right) <= most)) out.classes |= bit(2);
  }
}

StabilityVerdict stability_verdict(const AccuracyPass& pass) {
  StabilityVerdict out;
  const auto series = std::find_if(pass.metrics.begin(), pass.metrics.end(),
                                   [](const MetricSeries& m) { return m.name == "stability_classes"; });
  if (series == pass.metrics.end()) return out;
  for (const bool fatal : {true, false})
    for (std::size_t f = 0; f < series->values.size(); ++f) {
      const auto set = static_cast<unsigned>(series->values[f]) & (fatal ? ~kDegrading : kDegrading);
      if (set == 0) continue;
      out.grade = fatal ? StabilityVerdict::Grade::Failed : StabilityVerdict::Grade::Degraded;
      out.klass = "F" + std::to_string(least(set));
      out.frame = static_cast<int>(f);
      return out;
    }
  return out;
}

std::string StabilityVerdict::text() const {
  static constexpr const char* kClasses[] = {"not finite or unbounded", "energy gained", "strain beyond the load"};
  return std::string(grade == Grade::Failed ? "failed: " : "degraded: ") + klass + " " + kClasses[klass[1] - '0'];
}

}  // namespace clothbench
