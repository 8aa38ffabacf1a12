#pragma once
#include <memory>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::render {

/// Of each vertex the stretch l/l0 - 1 of that structural edge at it which is furthest from its rest length; NaN where
/// an end is not finite. Positions xyz interleaved [m].
std::vector<float> vertex_strain(const Cloth&, std::span<const double> position_m);

/// How deep each vertex is in the colliders of a scene [m], the deepest where it is in several, 0 outside; NaN where it
/// is not finite.
///
/// Planes, spheres, boxes and capsules: from their distance. Triangles with an inside (closed, or hands): the distance
/// to the surface of vertices with a winding number above 1/2. Others (rooms): the distance to the surface of vertices
/// whose way since the start has crossed it, so frames come in order from the start; after one that is not finite this
/// is NaN.
class VertexDepth {
 public:
  /// Throws Error where a mesh is to be asked and this build has no contact metrics
  /// (-DCLOTHBENCH_WITH_CONTACT_METRICS=OFF).
  explicit VertexDepth(const Scene&);  ///< outlives this
  ~VertexDepth();
  VertexDepth(const VertexDepth&) = delete;
  VertexDepth& operator=(const VertexDepth&) = delete;

  /// Goes on to frame `frame` (0 = the start). Every frame in order; depths are computed only if `wanted`, else none
  /// come back.
  std::vector<float> at(int frame, std::span<const double> position_m, bool wanted);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clothbench::render
