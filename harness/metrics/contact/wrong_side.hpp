#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {

/// A piece of an object's centre line: the axis of a capsule, a bone of a hand.
using Bone = std::array<Point<3>, 2>;

/// Two neighbouring samples of a cloth.
using Link = std::array<std::uint32_t, 2>;

/// How the samples of a cloth hang together, and which (sample) are on its border.
struct Weave {
  std::vector<Link> links;
  std::vector<bool> border;
};

/// Follows samples of a cloth (vertices, centres of cells) in the frame of an object that moves through it, and tells
/// which are on the wrong side of it.
///
/// An object that came at the cloth from the side `side` and pushes it ahead leaves a gap in its wake: between its
/// centre line and that side there is no cloth. Through that gap runs the surface that the centre line sweeps towards
/// `side`, carried along. A sample that has passed it an odd number of times, signed crossings counted in space-time
/// (SweptMesh), is on the wrong side, except where
/// - it went round a free end: through the half-plane beyond an end that no other bone shares, which the centre line
/// and
///   side x bone span. One chain of joined bones, a finger, is one wake with its own ends;
/// - it need not have passed. A frame tells where a sample's way began and ended, not when it was gone; if that decides
///   whether it passed (evenly, at once or at the end), it is put on the side of the neighbours that the wake doesn't
///   part it from;
/// - it belongs to a lap. Cloth whose border is laid over a finger passes the wake as one piece, and its links to the
/// rest go
///   through the wake, or round an end through the continuation of the wake there. What the finger went through has
///   links that do neither. A piece with part of the border and without such a link is let off, until it goes back.
///
/// A bone parallel to `side` sweeps nothing and says nothing. A cloth that has come off a fingertip as a whole and is
/// then passed below is taken for wrong where its samples did not themselves pass the free end.
class WrongSide {
 public:
  /// `side`: unit vector. `reach_m`: how far the wake goes, well beyond the cloth. Bones without length are left out.
  /// `weave`: the cloth between the samples; without links there are no laps. Throws Error.
  WrongSide(std::span<const Bone> bones, const Point<3>& side, double reach_m, std::size_t samples, Weave weave = {});

  /// Samples, xyz interleaved, and bones (as many as before) at the end of the next frame; ways are straight.
  /// The first call is the start. Once a sample is not finite nothing is known any more.
  void advance(std::span<const double> samples, std::span<const Bone> bones);

  bool known() const { return !lost_; }
  bool wrong(std::size_t sample) const;
  std::size_t count() const;

 private:
  /// An open mesh that moves with the bones.
  struct Surface {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<double> at;  ///< positions at the last frame
    std::vector<bool> odd;   ///< (sample) passed it an odd number of times
  };
  /// Bones joined end to end.
  struct Chain {
    std::vector<std::size_t> bones;
    std::vector<std::array<std::size_t, 2>> free_ends;  ///< (bone, which end)
    Surface wake, endless, beyond;  ///< endless: the wake of a finger that goes on straight beyond its free ends
    std::optional<TunnelHistory> rounded;
    std::vector<bool> lapped;  ///< (sample) odd, and once since it has been so in a piece that was whole
  };
  class Passage;
  void place(Chain&, std::span<const Bone>) const;
  void follow(Surface&, const Passage&, std::span<const double> samples) const;
  bool parted(const Surface&, const Passage&, const Link&, std::span<const double> samples) const;
  void find_laps(Chain&, const Passage& wake, const Passage& endless, std::span<const double> samples) const;

  Point<3> side_;
  double reach_m_;
  Weave weave_;
  std::vector<std::vector<std::size_t>> links_of_;  ///< (sample)
  std::vector<Chain> chains_;
  std::vector<double> before_;  ///< samples; empty before the first call
  bool lost_ = false;
};

}  // namespace clothbench::contact
