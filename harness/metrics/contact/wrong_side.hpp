#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {

/// A piece of an object's centre line: the axis of a capsule, a bone of a hand.
using Bone = std::array<Point<3>, 2>;

/// Follows samples of a cloth (vertices, centres of cells) in the frame of an object that moves through it, and tells which
/// are on the wrong side of it.
///
/// An object that came at the cloth from the side `side` and pushes it ahead leaves a gap in its wake: between its centre
/// line and that side there is no cloth. Through that gap runs the surface that the centre line sweeps towards `side`,
/// carried along. A sample that has passed it an odd number of times, signed crossings counted in space-time (SweptMesh),
/// has gone through the object's wake, hence through the object, unless it went round a free end: through the half-plane
/// beyond an end that no other bone shares, which the centre line and side x bone span. One chain of joined bones, a
/// finger, is one wake with its own ends.
///
/// A bone parallel to `side` sweeps nothing and says nothing. A cloth that legitimately wraps right round a finger, or one
/// that has come off a fingertip as a whole and is then passed below, is taken for wrong where its samples did not
/// themselves pass the free end.
class WrongSide {
 public:
  /// `side`: unit vector. `reach_m`: how far the wake goes, well beyond the cloth. Bones without length are left out.
  WrongSide(std::span<const Bone> bones, const Point<3>& side, double reach_m, std::size_t samples);

  /// Samples, xyz interleaved, and bones (as many as before) at the end of the next frame; both moved in straight lines.
  /// The first call is the start. Once a sample is not finite nothing is known any more.
  void advance(std::span<const double> samples, std::span<const Bone> bones);

  bool known() const { return !lost_; }
  bool wrong(std::size_t sample) const;
  std::size_t count() const;

 private:
  /// Bones joined end to end. Open meshes: its wake, and what lies beyond its free ends.
  struct Chain {
    std::vector<std::size_t> bones;
    std::vector<std::array<std::size_t, 2>> free_ends;  ///< (bone, which end)
    std::vector<std::array<std::uint32_t, 3>> wake_triangles, beyond_triangles;
    std::vector<double> wake, beyond;  ///< positions at the last frame
    TunnelHistory crossed, rounded;
  };
  void place(const Chain&, std::span<const Bone>, std::vector<double>& wake, std::vector<double>& beyond) const;

  Point<3> side_;
  double reach_m_;
  std::vector<Chain> chains_;
  std::vector<double> before_;  ///< samples; empty before the first call
  bool lost_ = false;
};

}  // namespace clothbench::contact
