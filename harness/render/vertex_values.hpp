#pragma once
#include <memory>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::render {

/// For each vertex, the stretch l/l0 - 1 of its structural edge with the greatest deviation from rest length; NaN if an
/// end is not finite. Positions xyz interleaved [m].
std::vector<float> vertex_strain(const Cloth&, std::span<const double> position_m);

/// Penetration depth of each vertex in the colliders of a scene [m]: the greatest over all colliders, 0 outside, NaN if
/// the position is not finite.
///
/// Planes, spheres, boxes and capsules: from their signed distance. Meshes with an inside (closed, or hands): distance
/// to the surface for vertices with a winding number above 1/2. Other meshes (rooms): distance to the surface for
/// vertices whose path since the start has crossed it. This needs all frames in order from the start, and is NaN after
/// a frame that is not finite.
class VertexDepth {
 public:
  /// Throws Error if the scene has a mesh and this build has no contact metrics
  /// (-DCLOTHBENCH_WITH_CONTACT_METRICS=OFF).
  explicit VertexDepth(const Scene&);  ///< must outlive this object
  ~VertexDepth();
  VertexDepth(const VertexDepth&) = delete;
  VertexDepth& operator=(const VertexDepth&) = delete;

  /// Advances to frame `frame` (0 = the start). Call for every frame in order. Computes depths only if `wanted`;
  /// otherwise returns none.
  std::vector<float> at(int frame, std::span<const double> position_m, bool wanted);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clothbench::render
