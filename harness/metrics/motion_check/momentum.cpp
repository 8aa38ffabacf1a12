// Momentum and angular momentum of the whole cloth. Forces inside the cloth cancel in both, so no material law is
// needed: attachments and colliders in reach must be able to exert the force beyond gravity and damping. Its distance
// from the cone of their forces is found by column generation and NNLS (Lawson & Hanson 1974, 23).
#include <algorithm>
#include <cmath>

#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

/// Mean distance [frames] of an impulse from its stored frame, weighted by the hat function of a second difference.
constexpr double kChord = 1.0 / 3;
/// Tolerance [weights] of a lasting force; fraction of a tolerance to which distances are computed.
constexpr double kLasting = 0.05, kResolved = 0.1;
/// Number of intervals over which forces are averaged.
constexpr std::size_t kWindow = 12;
/// Tolerance of friction coefficients: 10 % and 0.02.
constexpr double kFrictionFactor = 1.1, kFrictionSlack = 0.02;
/// Tolerances of steady sliding on a face: normal force and tangential force [weights], and fraction of friction.
constexpr double kSteady = 0.05, kSliding = 0.03, kFrictionShare = 0.05;
/// Numbers of intervals over which sliding is averaged.
constexpr std::size_t kSlidingSpans[] = {4, 12};

/// The residual of minimum norm: w minus a sum of non-negative `multiples` of the columns.
template <class Columns>
V6 residual_of_cone(const Columns& columns, const V6& w, Eigen::VectorXd& multiples) {
  const auto n = static_cast<Eigen::Index>(columns.cols());
  multiples = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> passive;
  V6 rest = w;
  for (int round = 0; round < 3 * n + 10; ++round) {
    Eigen::Index best = -1;
    double gain = 1e-9;
    for (Eigen::Index j = 0; j < n; ++j)
      if (std::find(passive.begin(), passive.end(), j) == passive.end() && columns.col(j).dot(rest) > gain)
        gain = columns.col(j).dot(rest), best = j;
    if (best < 0) break;
    passive.push_back(best);
    while (!passive.empty()) {
      Eigen::MatrixXd a(6, static_cast<Eigen::Index>(passive.size()));
      for (std::size_t i = 0; i < passive.size(); ++i) a.col(static_cast<Eigen::Index>(i)) = columns.col(passive[i]);
      const Eigen::VectorXd z = a.completeOrthogonalDecomposition().solve(w);
      double step = 1;
      for (std::size_t i = 0; i < passive.size(); ++i) {
        const double now = multiples[passive[i]], then = z[static_cast<Eigen::Index>(i)];
        if (then <= 0) step = std::min(step, now - then > 0 ? now / (now - then) : 0);
      }
      for (std::size_t i = 0; i < passive.size(); ++i)
        multiples[passive[i]] += step * (z[static_cast<Eigen::Index>(i)] - multiples[passive[i]]);
      if (step >= 1) break;
      std::erase_if(passive, [&](Eigen::Index j) {
        if (multiples[j] > 1e-12) return false;
        multiples[j] = 0;
        return true;
      });
    }
    rest = w - columns * multiples;
  }
  return rest;
}

/// Unit force of a contact with the largest component along h, or zero. `coulomb`: in the friction cone; else any push.
V3 best_force(const Contact& c, const V3& h, bool coulomb) {
  if (c.any_force) return h.normalized();
  const double along = h.dot(c.normal);
  const V3 across = h - along * c.normal;
  const double size = across.norm();
  if (!coulomb) return along >= 0 ? V3(h.normalized()) : (size > 0 ? V3(across / size) : V3(V3::Zero()));
  const double slope = kFrictionFactor * (c.friction + kFrictionSlack);
  const V3 force = size > 0 ? V3(c.normal + slope / size * across) : c.normal;
  return force.dot(h) > 0 ? V3(force.normalized()) : V3(V3::Zero());
}

/// One contact for each distinct cone of forces, for tests that ignore points.
std::vector<Contact> directions_of(std::span<const Contact> contacts) {
  std::vector<Contact> out;
  for (const Contact& c : contacts) {
    const auto same = [&](const Contact& o) {
      return o.normal == c.normal && o.friction == c.friction && o.any_force == c.any_force;
    };
    if (out.size() > 16 || std::none_of(out.begin(), out.end(), same)) out.push_back(c);
  }
  return out;
}

class Momentum {
 public:
  Momentum(const Motion& m, Bodies& b, Findings& f) : m_(m), bodies_(b), found_(f), arm_m_(m.length_m / 2) {}

  void run() {
    found_.define("impulse");
    std::vector<double> off(m_.frames, 0), slip(m_.frames, 0);
    // Forces only: the point in time and space at which a sliding contact acts is too uncertain for moments.
    M6 forces_only = M6::Zero();
    forces_only.topLeftCorner<3, 3>().setIdentity();
    all_.resize(m_.frames);
    for (std::size_t k = 0; k + 1 < m_.frames; ++k) {
      Interval& now = all_[k];
      now = interval(k);
      const V3 middle = middle_of(k);
      const M6 keep = free_of_attachments(m_, k, middle);
      now.wrench = keep * now.wrench;
      const std::vector<Contact> contacts = contacts_round(k);
      now.contact = !contacts.empty();
      if (now.contact && k > 0 && !m_.has_attachments()) now.slip = slip_of(k);
      const bool attached = !keep.isIdentity(1e-9);
      now.judged =
          !(attached && std::any_of(contacts.begin(), contacts.end(), [](const Contact& c) { return c.any_force; }));
      window(k);
      if (!now.judged) continue;
      const double allowed = kLasting + noise(k);
      off[k] = now.contact ? outside_cone(now.wrench, contacts, keep, middle, now.hidden + kResolved * allowed)
                           : now.wrench.norm();
      off[k] = std::max(0.0, off[k] - now.hidden);
      if (k == 0)
        found_.add("first_step", off[0] / (0.55 + noise(0)), 0);
      else
        found_.add("impulse", off[k] / (0.5 + noise(k)), k);
      for (const std::size_t span : kSlidingSpans) sliding(k, span);
      if (now.contact && !attached) {
        slip[k] = outside_cone(forces_only * now.wrench, directions_of(contacts), forces_only, middle,
                               kResolved * allowed, true);
        // An impact within one interval: a quarter of the force is tolerated.
        found_.add("friction", slip[k] / ((k == 0 ? 0.55 : 0.5) + 0.25 * now.wrench.head<3>().norm() + noise(k)), k);
      }
      if (k < 3) continue;
      const auto median = [&](const std::vector<double>& x) {
        return std::max(std::min(x[k - 2], x[k - 1]), std::min(std::max(x[k - 2], x[k - 1]), x[k]));
      };
      found_.add("force", median(off) / allowed, k);
      if (now.contact && !attached) found_.add("friction", median(slip) / allowed, k);
    }
    if (!bodies_.empty() && !m_.has_attachments()) free_motion();
  }

 private:
  /// State for Coulomb's law while only one face is in reach and the cloth neither lands on it nor leaves it.
  struct Slip {
    bool steady = false;
    bool slides = false;     ///< every vertex moves along the face by more than friction can stop in an interval
    V3 across = V3::Zero();  ///< force along the face [weights]
    V3 way = V3::Zero();     ///< mean direction of the motion along the face
    double spread = 0;       ///< largest distance of a vertex's direction from the mean
    double limit = 0;        ///< friction times the normal force [weights]
  };
  struct Interval {
    V6 wrench = V6::Zero();  ///< minus the part that attachments can exert
    double hidden = 0;       ///< angular part: possible error of the lever arms
    bool judged = true, contact = false;
    Slip slip;
  };

  Interval interval(std::size_t k) {
    Interval out;
    const double after = m_.dt(k + 1), before = m_.dt(k), c = m_.scene.material.damping_per_s;
    const Flight flight(before, after, c);
    const V3 middle = middle_of(k);
    const double fastest = std::sqrt(2 * m_.weight_unit * m_.length_m) + 2 * std::max(bodies_.speed(), m_.start_speed);
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      const V3 now = m_.at(k, v), ahead = m_.at(k + 1, v) - now;
      V3 force;  // over the vertex's mass
      if (k == 0) {
        force = (ahead - flight.a2 * m_.start_velocity_of(v) - flight.b2 * m_.gravity) / (after * after);
        const double speed = std::max(m_.start_velocity_of(v).norm(), ahead.norm() / after);
        out.hidden += m_.masses_kg[v] * std::min(speed, fastest) * force.norm();
      } else {
        const V3 behind = now - m_.at(k - 1, v);
        force = flight.unexplained(behind, ahead, m_.gravity);
        const double speed = std::min((ahead + behind).norm() / (before + after), fastest);
        out.hidden += m_.masses_kg[v] * speed * ((ahead / after - behind / before) / after - m_.gravity).norm();
      }
      out.wrench += m_.masses_kg[v] * wrench_of(force, (now - middle) / arm_m_);
    }
    const double weight = m_.mass_kg * m_.weight_unit;
    out.wrench /= weight;
    out.hidden *= kChord * after / (weight * arm_m_);
    return out;
  }

  std::vector<Contact> contacts_round(std::size_t k) {
    std::vector<Contact> out;
    if (bodies_.empty()) return out;
    for (std::size_t f = k == 0 ? 0 : k - 1; f <= std::min(k + 1, m_.frames - 1); ++f) {
      const std::span<const Contact> now = bodies_.contacts(f);
      out.insert(out.end(), now.begin(), now.end());
    }
    return out;
  }

  /// Distance of a wrench from the cone of the contacts' wrenches; an upper bound once it is at most `enough`.
  double outside_cone(const V6& w, const std::vector<Contact>& contacts, const M6& keep, const V3& middle,
                      double enough, bool coulomb = false) const {
    constexpr int kRounds = 60;
    Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, 0);
    Eigen::VectorXd multiples;
    V6 rest = w;
    // Without a projection a unit force has a wrench of norm 1 or more, so its gain is at most force.dot(h).
    const bool whole = keep.isIdentity();
    for (int round = 0; round < kRounds && rest.norm() > enough; ++round) {
      V6 best = V6::Zero();
      double gain = 1e-4 * std::max(1.0, w.norm());
      const V3 turning = rest.tail<3>();
      for (const Contact& c : contacts) {
        const V3 arm = (c.point - middle) / arm_m_, h = rest.head<3>() + turning.cross(arm);
        if (whole && !(h.squaredNorm() > gain * gain)) continue;
        const V3 force = best_force(c, h, coulomb);
        if (whole && !(force.dot(h) > gain)) continue;
        const V6 column = keep * wrench_of(force, arm);
        const double size = column.norm();
        if (size < 1e-6 || !(column.dot(rest) / size > gain)) continue;
        gain = column.dot(rest) / size;
        best = column / size;
      }
      if (best.isZero()) break;
      Eigen::Index kept = 0;
      for (Eigen::Index j = 0; j < columns.cols(); ++j)
        if (multiples[j] > 0) columns.col(kept++) = V6(columns.col(j));
      columns.conservativeResize(6, kept + 1);
      columns.col(kept) = best;
      const V6 next = residual_of_cone(columns, w, multiples);
      if (!(next.norm() < rest.norm() - 1e-6)) break;
      rest = next;
    }
    return rest.norm();
  }

  Slip slip_of(std::size_t k) const {
    Slip out;
    const Face face = bodies_.face(k);
    for (const std::size_t f : {k - 1, k, k + 1}) {
      const Face other = bodies_.face(f);
      if (!other.any || !other.flat || other.normal.dot(face.normal) < 1 - 1e-6 || other.friction != face.friction)
        return out;
    }
    const V3 force = all_[k].wrench.head<3>(), up = face.normal;
    const double normal_force = force.dot(up), rests = -m_.gravity.dot(up) / m_.weight_unit, t = m_.dt(k);
    out.steady = std::abs(normal_force - rests) < kSteady + noise(k);
    out.across = force - normal_force * up;
    out.limit = face.friction * std::max(normal_force, 0.0);
    const double stops_m = 8 * m_.resolution_m + face.friction * m_.weight_unit * t * t;
    out.slides = true;
    std::vector<V3> ways;
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      // Only for a sheet that touches the face everywhere: in a heap, layers move and contacts slide one after another.
      if (!bodies_.touched(k, v)) return {};
      for (const V3& way : {V3(m_.at(k, v) - m_.at(k - 1, v)), V3(m_.at(k + 1, v) - m_.at(k, v))}) {
        const V3 along = way - way.dot(up) * up;
        out.slides = out.slides && along.norm() > stops_m;
        ways.push_back(along.normalized());
        out.way += ways.back();
      }
    }
    out.way /= static_cast<double>(std::max<std::size_t>(ways.size(), 1));
    for (const V3& way : ways) out.spread = std::max(out.spread, (way - out.way).norm());
    return out;
  }

  /// Coulomb's law averaged over `span` intervals: friction is mu N against the motion if the cloth slides, else less.
  void sliding(std::size_t k, std::size_t span) {
    if (k < span + 1) return;
    V3 across = V3::Zero(), drag = V3::Zero();
    double limit = 0, spread = 0;
    bool slides = true;
    for (std::size_t i = k + 1 - span; i <= k; ++i) {
      const Slip& s = all_[i].slip;
      if (!s.steady) return;
      slides = slides && s.slides;
      across += s.across, drag -= s.limit * s.way, limit += s.limit, spread += s.limit * s.spread;
    }
    const double n = static_cast<double>(span);
    const double off = slides ? std::max(0.0, (across - drag).norm() - spread) : std::max(0.0, across.norm() - limit);
    found_.add("sliding", off / n / (kSliding + kFrictionShare * limit / n + noise(k) / n), k);
  }

  /// Mean wrench over the last kWindow intervals before k: resolution noise cancels in the sum of second differences.
  void window(std::size_t k) {
    if (k < kWindow + 1) return;
    V6 mean = V6::Zero();
    double hidden = 0;
    bool contact = false;
    for (std::size_t i = k - kWindow; i < k; ++i) {
      if (!all_[i].judged) return;
      mean += all_[i].wrench / kWindow;
      hidden += all_[i].hidden / kWindow;
      contact = contact || all_[i].contact;
    }
    if (!contact) {
      found_.add("mean_force", std::max(0.0, mean.norm() - hidden) / (kLasting + noise(k) / kWindow), k);
      return;
    }
    double moved = 0;
    for (std::size_t v = 0; v < m_.vertices; ++v) moved += (m_.at(k, v) - m_.at(k - kWindow - 1, v)).squaredNorm();
    if (!(std::sqrt(moved / static_cast<double>(m_.vertices)) < 0.002 * m_.length_m)) return;
    const std::size_t at = k - kWindow / 2;
    const V3 middle = middle_of(at);
    // Cloth at rest may have touched a collider only in an earlier or later frame of the window.
    std::vector<Contact> contacts = contacts_round(at);
    for (const std::size_t f : {k - kWindow, k - 1}) {
      const std::span<const Contact> more = bodies_.contacts(f);
      contacts.insert(contacts.end(), more.begin(), more.end());
    }
    const double allowed = 0.03 + noise(k) / kWindow;
    const double off =
        outside_cone(mean, contacts, free_of_attachments(m_, at, middle), middle, kResolved * allowed, true);
    found_.add("support", off / allowed, k);
  }

  /// Cloth without attachments that starts flat falls freely until a collider is in reach. The tolerance covers a
  /// first-order integrator with one step per frame, whose error is half of gravity times frame duration times time.
  void free_motion() {
    const Scene& s = m_.scene;
    if (!s.cloth.start.at_rest() || s.cloth.span_m > 0 || s.cloth.drape_radius_m > 0 ||
        s.cloth.spin_rad_per_s != Vec3{})
      return;
    found_.define("free_motion");
    std::vector<V3> fall(m_.vertices);
    for (std::size_t k = 1; k < m_.frames; ++k) {
      const Flight flight(m_.dt(k), m_.time_s(k), s.material.damping_per_s);
      double sum = 0, way = 0;
      for (std::size_t v = 0; v < m_.vertices; ++v) {
        const V3 to = m_.at(0, v) + flight.a2 * m_.start_velocity_of(v) + flight.b2 * m_.gravity;
        fall[v] = to;
        way = std::max(way, (m_.start_velocity_of(v) + m_.time_s(k) * m_.gravity).norm() * m_.dt(k));
        sum += (m_.at(k, v) - to).squaredNorm();
      }
      if (bodies_.near(k, fall, 2 * way)) return;
      const double first_order_m = 0.75 * m_.weight_unit * m_.dt(k) * m_.time_s(k);
      found_.add("free_motion",
                 std::sqrt(sum / static_cast<double>(m_.vertices)) / (4 * m_.resolution_m + first_order_m), k);
    }
  }

  V3 middle_of(std::size_t k) const {
    V3 sum = V3::Zero();
    for (std::size_t v = 0; v < m_.vertices; ++v) sum += m_.masses_kg[v] * m_.at(k, v);
    return sum / m_.mass_kg;
  }

  double noise(std::size_t k) const { return m_.noise(k, m_.vertices); }

  const Motion& m_;
  Bodies& bodies_;
  Findings& found_;
  double arm_m_;
  std::vector<Interval> all_;
};

}  // namespace

M6 free_of_attachments(const Motion& m, std::size_t k, const V3& middle) {
  M6 gram = M6::Zero();
  for (const std::size_t f : {k == 0 ? k : k - 1, k, std::min(k + 1, m.frames - 1)})
    for (const std::uint32_t v : m.held(f))
      for (int axis = 0; axis < 3; ++axis) {
        const V6 w = wrench_of(V3::Unit(axis), (m.at(k, v) - middle) / (m.length_m / 2));
        gram += w * w.transpose();
      }
  if (gram.isZero(0)) return M6::Identity();
  const Eigen::SelfAdjointEigenSolver<M6> eigen(gram);
  M6 keep = M6::Zero();
  for (int i = 0; i < 6; ++i)
    if (eigen.eigenvalues()[i] < 1e-6 * eigen.eigenvalues()[5])
      keep += eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose();
  return keep;
}

void check_momentum(const Motion& m, Bodies& bodies, Findings& found) { Momentum(m, bodies, found).run(); }

}  // namespace clothbench::motion_check
