#pragma once
// Actions of the null runtime's user as functions of time; tests compare the solver's input with them.
#include <array>
#include <cmath>

namespace null_xr {

struct V {
  double x = 0, y = 0, z = 0;
};
inline V operator+(V a, V b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V operator*(double s, V a) { return {s * a.x, s * a.y, s * a.z}; }
inline V cross(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// x, y, z, w.
struct Q {
  double x = 0, y = 0, z = 0, w = 1;
};
inline Q operator*(Q a, Q b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
inline Q conjugate(Q q) { return {-q.x, -q.y, -q.z, q.w}; }
inline V turned(Q q, V v) {
  const V u{q.x, q.y, q.z};
  return v + 2 * q.w * cross(u, v) + 2 * cross(u, cross(u, v));
}

struct Pose {
  Q q;
  V p;
};
inline Pose operator*(const Pose& a, const Pose& b) { return {a.q * b.q, a.p + turned(a.q, b.p)}; }
inline Pose inverse(const Pose& a) { return {conjugate(a.q), turned(conjugate(a.q), -1 * a.p)}; }

/// Palm, in LOCAL: moves from the right (left hand: from the left) at 0.6 m/s, and 15 cm forward within half a second,
/// through a plane 60 cm in front of the eyes.
inline V palm_at(bool right, double t) {
  const double x = 0.3 - 0.6 * t, forward = t < 0 ? 0 : t < 0.5 ? t / 0.5 : 1;
  return {right ? x : -x, -0.15, -0.5 - 0.15 * forward};
}

inline constexpr double kJointRadius_m = 0.009, kCapsuleRadius_m = 0.011;

/// Joints of OpenXR relative to the palm: fingers to +y, palm to -z.
inline std::array<V, 26> joints(bool right) {
  std::array<V, 26> j{};
  j[1] = {0, -0.08, 0};
  const V thumb[4] = {{-0.03, -0.05, 0}, {-0.05, -0.01, 0}, {-0.06, 0.02, 0}, {-0.065, 0.04, 0}};
  for (int k = 0; k < 4; ++k) j[static_cast<std::size_t>(2 + k)] = thumb[k];
  const double y[5] = {-0.05, 0.03, 0.06, 0.085, 0.1};
  for (int finger = 0; finger < 4; ++finger)
    for (int k = 0; k < 5; ++k) j[static_cast<std::size_t>(6 + 5 * finger + k)] = {-0.03 + 0.02 * finger, y[k], 0};
  if (!right)
    for (V& v : j) v.x = -v.x;
  return j;
}

/// Orientation of every joint: -z along the fingers, +y out of the back of the hand.
inline Q joint_turn() { return {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}; }

/// Ends of the 19 capsules, as joint indices.
inline std::array<std::array<int, 2>, 19> capsule_joints() {
  std::array<std::array<int, 2>, 19> c{};
  std::size_t n = 0;
  for (int finger = 0; finger < 4; ++finger) c[n++] = {6 + 5 * finger, 7 + 5 * finger};
  for (int k = 0; k < 3; ++k) c[n++] = {2 + k, 3 + k};
  for (int finger = 0; finger < 4; ++finger)
    for (int k = 0; k < 3; ++k) c[n++] = {7 + 5 * finger + k, 8 + 5 * finger + k};
  return c;
}

/// The user's surroundings in LOCAL: floor, wall, a table that is no longer tracked, and a table.
struct Plane {
  Pose pose;
  double width_m, height_m;
  int alignment, label, state;
};
inline const Q kLevel = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}, kTurned = Q{0, 0.6, 0, 0.8} * kLevel;
inline const std::array<Plane, 4> kSurroundings = {{{{kLevel, {0, -1.2, 0}}, 5, 4, 0, 2, 3},
                                                    {{{}, {0, 0, -2}}, 5, 2.4, 2, 3, 3},
                                                    {{kLevel, {0, -0.6, 0}}, 3, 3, 0, 5, 2},
                                                    {{kTurned, {0.4, -0.5, -0.8}}, 1.2, 0.8, 0, 5, 3}}};

/// A performance counter: it reads as the frame's number, as half of it if it is not whole.
struct Counter {
  const char *path, *units;
  unsigned unit;   ///< XrPerformanceMetricsCounterUnitMETA
  unsigned flags;  ///< 1: any value; 2: a whole value; 4: a real value
};
inline constexpr std::array<Counter, 5> kCounters = {{{"app/gpu_frametime", "ms", 2, 5},
                                                      {"compositor/dropped_frame_count", "1", 0, 3},
                                                      {"device/cpu_utilization", "%", 1, 5},
                                                      {"device/gpu_frequency", "Hz", 4, 3},
                                                      {"device/memory", "B", 3, 7}}};

}  // namespace null_xr
