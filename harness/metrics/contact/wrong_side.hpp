#pragma once
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {

/// A segment of an object's centre line: the axis of a capsule, or a bone of a hand.
using Bone = std::array<Point<3>, 2>;

/// What shows that an object is in the cloth.
struct Evidence {
  bool contour = false;  ///< cloth and object cross in this frame or the one before
  /// Whether a segment between two points meets the object in this frame; empty: no.
  std::function<bool(const Point<3>&, const Point<3>&)> crosses = {};
};

/// Tracks samples of a cloth (vertices, cell centres) in the frame of an object that moves through it, and finds those
/// on the wrong side of the object.
///
/// An object that approaches the cloth from the side `side` and pushes it ahead leaves a gap in its wake: there is no
/// cloth between its centre line and that side. The wake is the surface through that gap which the centre line sweeps
/// towards `side`; it moves with the object. A sample that has passed it an odd number of times (signed crossings in
/// space-time, SweptMesh) is on the wrong side, with these exceptions:
///   - It went round a free end: through the half-plane beyond an end that no other bone shares, spanned by the centre
///     line and side x bone. One chain of joined bones, a finger, is one wake with its own ends.
///   - It need not have passed. A frame gives the start and end of a sample's path, but not when the sample moved.
///     If that decides whether it passed (moving uniformly, at once or at the end), it is put on the side of those
///     neighbours that the wake does not separate from it.
///   - It is laid over the object, with its border or as a fold. The links between a piece of such cloth and the rest
///   go
///     through the wake, or round an end through the continuation of the wake there. Cloth that the centre line went
///     through has links that do neither: they are torn. A piece counts only if one of its links is torn and there is
///     evidence for it: since that link was last whole there was a contour, or the link crosses the object. Everything
///     else went round.
///
/// A bone parallel to `side` sweeps no area and is not used. A cloth that has come off a fingertip as a whole and is
/// then passed below counts as wrong for those samples that did not themselves pass the free end.
class WrongSide {
 public:
  /// `side`: unit vector. `reach_m`: length of the wake, well beyond the cloth. Bones without length are ignored.
  /// `links` between the samples; without them nothing is laid over. Throws Error.
  WrongSide(std::span<const Bone> bones, const Point<3>& side, double reach_m, std::size_t samples,
            std::vector<Link> links = {});

  /// Samples, xyz interleaved, and bones (as many as before) at the end of the next frame; paths are straight. The
  /// first call is the start. After a sample that is not finite the result is unknown.
  void advance(std::span<const double> samples, std::span<const Bone> bones, const Evidence& evidence = {});

  bool known() const { return !lost_; }
  bool wrong(std::size_t sample) const;
  /// Whether it has passed a wake an odd number of times without being wrong.
  bool laid_over(std::size_t sample) const;
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
    Surface wake, endless, beyond;  ///< endless: the wake of a finger extended straight beyond its free ends
    std::optional<TunnelHistory> rounded;
    std::vector<bool> torn;     ///< (link) with evidence
    std::vector<bool> through;  ///< (sample) odd, in a piece with such a link
    bool wrong(std::size_t sample) const;
  };
  class Passage;
  void place(Chain&, std::span<const Bone>) const;
  void follow(Surface&, const Passage&, std::span<const double> samples) const;
  bool parted(const Surface&, const Passage&, const Link&, std::span<const double> samples) const;
  void find_torn(Chain&, const Passage& wake, const Passage& endless, std::span<const double> samples,
                 const Evidence&) const;

  Point<3> side_;
  double reach_m_;
  std::vector<Link> links_;
  std::vector<std::vector<std::size_t>> links_of_;  ///< (sample)
  std::vector<Chain> chains_;
  std::vector<double> before_;  ///< samples; empty before the first call
  bool lost_ = false;
};

}  // namespace clothbench::contact
