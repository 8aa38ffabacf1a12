// Speed, energy and strain that falling, colliders and attachments can give the cloth.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

/// Maximum stiffness [N/m] in the charge for stored energy: above it, strain shows only how accurate a solver is.
constexpr double kStiffest = 1000, kInextensible = 1e4;

class Limits {
 public:
  Limits(const Motion& m, const Bodies& b, Findings& f)
      : m_(m),
        bodies_(b),
        found_(f),
        scripted_(std::max(b.speed(), m.grip_speed)),
        moves_(b.any_moves() || m.grip_speed > 0) {
    driven_ = std::max(scripted_, m.start_speed);
    area_m2_ = m.mass_kg / m.scene.cloth.areal_density_kg_per_m2;
    whip_ = std::max(3.0, std::sqrt(2 * m.length_m / m.cell_m));
    stiffness_ = m.scene.material.membrane_stiffness_N_per_m;
    is_held_.assign(m.vertices, false);
    for (const std::uint32_t v : m.scene.pins.vertices) is_held_[v] = true;
    for (const std::uint32_t v : m.scene.grips.vertices) is_held_[v] = true;
    if (m.scene.material.bending_rigidity_N_m > 0) bends_ = edges(m.scene.cloth, EdgeKind::SkipOne);
  }

  void run() {
    for (std::size_t k = 0; k < m_.frames; ++k) frame(k);
  }

 private:
  void frame(std::size_t k) {
    double low = 1e300;
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      low = std::min(low, height(k, v));
      if (k == 0) top_ = std::max(top_, height(k, v));
    }
    lowest_ = std::min(lowest_, low);
    const bool falls = m_.gravity.norm() > 0;
    const double fall = std::max(top_ - lowest_, m_.has_attachments() ? m_.length_m : 0.0);
    budget_ = std::max(budget_, (falls ? std::sqrt(2 * m_.weight_unit * fall) : 0) + 2 * driven_);
    double tensile = 0;
    for (const Edge& e : m_.edges) tensile += std::pow(std::max(m_.strain(k, e), 0.0), 2);
    tensile_ = std::max(tensile_, tensile / static_cast<double>(std::max<std::size_t>(m_.edges.size(), 1)));
    if (k > 0) velocities(k);
    energy(k);
    strain(k);
  }

  void velocities(std::size_t k) {
    const double recoil = wave_speed() * std::sqrt(tensile_);
    const double t = m_.dt(k), floor = m_.weight_unit * t + 4 * m_.resolution_m / t;
    double fastest = 0, change = 0;
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      const V3 now = (m_.at(k, v) - m_.at(k - 1, v)) / t;
      fastest = std::max(fastest, now.norm());
      if (k > 1) change += (now - (m_.at(k - 1, v) - m_.at(k - 2, v)) / m_.dt(k - 1)).squaredNorm();
    }
    found_.add("speed", fastest / (whip_ * (budget_ + recoil + floor)), k);
    if (k > 1)
      found_.add(
          "speed_change",
          std::sqrt(change / static_cast<double>(m_.vertices)) / (1.25 * (budget_ + 2 * scripted_ + recoil) + floor),
          k);
  }

  /// Kinetic energy from a frame's mean velocities is a lower bound of the mean within the frame (Jensen's inequality).
  void energy(std::size_t k) {
    double mean_square = 0;
    for (const Edge& e : m_.edges) mean_square += std::pow(m_.strain(k, e), 2);
    mean_square /= static_cast<double>(std::max<std::size_t>(m_.edges.size(), 1));
    if (k == 0) {
      for (std::size_t v = 0; v < m_.vertices; ++v)
        start_energy_ += m_.masses_kg[v] * m_.start_velocity_of(v).squaredNorm() / 2;
      elastic_start_ = stiffness_.value_or(kInextensible) * elastic(mean_square);
      return;
    }
    const double t = m_.dt(k), g = m_.weight_unit, M = m_.mass_kg;
    double kinetic = 0, height_gained = 0;
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      kinetic += m_.masses_kg[v] * ((m_.at(k, v) - m_.at(k - 1, v)) / t).squaredNorm() / 2;
      height_gained += m_.masses_kg[v] * ((height(k, v) + height(k - 1, v)) / 2 - height(0, v));
    }
    const double potential = g * height_gained * (m_.gravity.norm() > 0);
    rise(k, kinetic + potential, kinetic, mean_square);
    // If the scene states no stiffness, links may store any energy in a strained start.
    if (moves_ || (!stiffness_ && mean_square > 0 && !m_.scene.cloth.start.at_rest())) return;
    kinetic_most_ = std::max(kinetic_most_, kinetic);
    const double step = 3 * g * t * std::sqrt(2 * kinetic_most_ * M), noise = 6 * M * std::pow(m_.resolution_m / t, 2);
    const double allowed = 0.02 * M * g * m_.length_m + 0.05 * start_energy_ + step + noise;
    found_.add("energy", (kinetic + potential - start_energy_ - elastic_start_) / allowed, k);
  }

  /// Only driven colliders and attachments add energy. Without them, no frame has more energy than an earlier one. The
  /// earlier energy includes the energy that links and bending may store or that a rebound hides for a few frames.
  void rise(std::size_t k, double energy, double kinetic, double mean_square) {
    constexpr std::size_t kHides = 4;
    double bent = 0;
    for (const Edge& e : bends_) bent += std::max(-m_.strain(k, e), 0.0);
    const double stored =
        stiffness_.value_or(kInextensible) * elastic(mean_square) + 8 * m_.scene.material.bending_rigidity_N_m * bent;
    const double t = m_.dt(k), g = m_.weight_unit, M = m_.mass_kg, before = std::exchange(stored_before_, stored);
    const auto step = [&](double of) { return 1.5 * g * t * std::sqrt(2 * M * of); };
    if (driven(k)) {
      had_.clear(), kinetic_.clear();
      least_ = std::numeric_limits<double>::infinity();
      return;
    }
    if (std::isfinite(least_)) {
      const double noise = 6 * M * std::pow(m_.resolution_m / t, 2);
      const double allowed =
          0.02 * M * g * m_.length_m + step(*std::max_element(kinetic_.begin(), kinetic_.end())) + noise;
      found_.add("rise", (energy - least_) / allowed, k);
    }
    had_.push_back(energy + std::max(before, stored) + step(kinetic)), kinetic_.push_back(kinetic);
    if (had_.size() < kHides) return;
    if (had_.size() > kHides) had_.erase(had_.begin()), kinetic_.erase(kinetic_.begin());
    least_ = std::min(least_, *std::max_element(had_.begin(), had_.end()));
  }

  /// Whether a collider or an attachment may give energy to the cloth in the interval before a frame.
  bool driven(std::size_t k) const {
    if (!moves_) return false;
    for (std::size_t v = 0; v < m_.vertices; ++v)
      if (bodies_.touched(k - 1, v) || bodies_.touched(k, v)) return true;
    const FrameMotion *was = m_.scripted(k - 1), *now = m_.scripted(k);
    for (std::size_t g = 0; was != nullptr && g < now->grip_held.size(); ++g)
      if ((now->grip_held[g] || was->grip_held[g]) && now->grip_position_m[g] != was->grip_position_m[g]) return true;
    return false;
  }

  void strain(std::size_t k) {
    double charged = 0, compressed = 0, count = static_cast<double>(std::max<std::size_t>(m_.edges.size(), 1));
    const std::vector<bool> held =
        m_.scene.grips.vertices.empty() ? std::vector<bool>(m_.vertices, false) : m_.is_held(k);
    std::vector<std::array<double, 2>> loose;  // change of strain in the frame, impact speed
    for (const Edge& e : m_.edges) {
      if (!(e.rest_m > 0)) continue;
      const double s = m_.strain(k, e);
      if (k > 0 && !is_held_[e.a] && !is_held_[e.b])
        loose.push_back({std::abs(s - m_.strain(k - 1, e)), impact_speed(k, e)});
      charged += std::pow(std::max(std::abs(s) - 3 * m_.resolution_m / e.rest_m, 0.0), 2) / count;
      compressed += std::max(-s, 0.0) / count;
      if (held[e.a] || held[e.b]) imposed_ = std::max(imposed_, std::abs(s));
    }
    constexpr std::ptrdiff_t kOthers = 12;
    if (loose.size() > 2 * kOthers) {
      std::nth_element(loose.begin(), loose.begin() + kOthers, loose.end(), std::greater());
      const double others = 0.15 + 4 * loose[kOthers][0], rebound = 2 * m_.dt(k) / m_.cell_m;
      double most = 0;
      for (const auto& [change, impact] : loose)
        most = std::max(most, change / (others + rebound * (scripted_ + impact)));
      found_.add("tear", most, k);
    }
    if (k == 0) charged_start_ = charged, compressed_start_ = compressed;
    const double weight = m_.mass_kg * m_.weight_unit, Y = stiffness_.value_or(kInextensible);
    // A recoil compresses by at most the previous stretch, an impact by its speed divided by the wave speed.
    const double sudden = std::sqrt(tensile_) + scripted_ / wave_speed();
    found_.add("compression", (compressed - compressed_start_) / (0.02 + 2 * weight / (m_.length_m * Y) + sudden), k);
    // Without a stated stiffness, the stiffness of links is the solver's choice.
    if (!stiffness_) return;
    const double pays = m_.mass_kg * (m_.weight_unit * std::max(top_ - lowest_, m_.length_m) + 2 * driven_ * driven_) +
                        Y * area_m2_ * imposed_ * imposed_;
    const double stored = std::min(Y, kStiffest) * elastic(charged - charged_start_);
    found_.add("strain", stored / pays / (scripted_ > 0 ? 3 : 1), k);
  }

  /// Speed [m/s] at which an edge in reach of a collider hits it in the interval before frame k: the collider may stop
  /// or reverse one end while the other moves on. Computed from the previous interval, so that no jump explains itself.
  double impact_speed(std::size_t k, const Edge& e) const {
    double fastest = 0;
    bool in_reach = false;
    for (const std::uint32_t v : {e.a, e.b}) {
      in_reach = in_reach || bodies_.touched(k - 1, v) || bodies_.touched(k, v);
      fastest = std::max(
          fastest, k > 1 ? (m_.at(k - 1, v) - m_.at(k - 2, v)).norm() / m_.dt(k - 1) : m_.start_velocity_of(v).norm());
    }
    return in_reach ? fastest : 0;
  }

  double height(std::size_t k, std::size_t v) const { return -m_.at(k, v).dot(m_.gravity) / m_.weight_unit; }
  /// Speed of a membrane wave [m/s].
  double wave_speed() const {
    return std::sqrt(stiffness_.value_or(kInextensible) / m_.scene.cloth.areal_density_kg_per_m2);
  }
  double elastic(double mean_square) const { return area_m2_ * mean_square; }

  const Motion& m_;
  const Bodies& bodies_;
  Findings& found_;
  double scripted_, driven_ = 0, area_m2_ = 0;
  bool moves_;
  /// Bound on a whip's speed: the sheet's energy in its border, whose vertices have half the mass of others.
  double whip_;
  std::optional<double> stiffness_;
  std::vector<bool> is_held_;  ///< per vertex: attached in any frame
  double top_ = -1e300, lowest_ = 1e300, budget_ = 0, tensile_ = 0;
  double start_energy_ = 0, kinetic_most_ = 0, elastic_start_ = 0, charged_start_ = 0, compressed_start_ = 0;
  double imposed_ = 0;  ///< largest strain next to an attachment so far
  std::vector<Edge> bends_;
  /// Upper bound of the cloth's energy, and its kinetic energy [J], in the last frames without a driver.
  std::vector<double> had_, kinetic_;
  double stored_before_ = 0, least_ = std::numeric_limits<double>::infinity();
};

}  // namespace

void check_limits(const Motion& m, Bodies& bodies, Findings& found) { Limits(m, bodies, found).run(); }

}  // namespace clothbench::motion_check
