#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "assets/mesh.hpp"
#include "assets/room.hpp"

namespace clothbench::assets {

/// Which triangles of a room a box cuts out.
enum class CutMode {
  AnyVertexInside,  ///< as published: Kim, Ma & Hong (2025), section 3.2.4, Algorithm 2
  Crossing,         ///< also those that cross the box with no vertex in it, which large triangles of a scan do
};

/// Part of a mesh with its own vertex numbering; order of vertices and triangles as in the source.
struct SubMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> source_vertex;    ///< one per vertex
  std::vector<std::uint32_t> source_triangle;  ///< one per triangle
  std::size_t crossing_only = 0;               ///< triangles that AnyVertexInside would have left out
};

/// The box's faces belong to it.
SubMesh cut(const TriangleMesh&, const Box&, CutMode);

/// The axis-aligned box round six points, as Algorithm 2 builds it. Throws Error unless all are finite.
Box box_of(const std::array<Vector, 6>& points);

/// The six points for a table: corners of its top, and its middle `below_m` lower and `above_m` higher.
std::array<Vector, 6> six_points(const Table&, double below_m = 0.10, double above_m = 0.05);

/// A table that fills an upright box, its top the box's upper face: what stands between picked points.
Table table_in(const Box& world);

/// Whether a triangle and a box have a point in common: separating axes, 3 + 1 + 9 of them (Akenine-Moller 2001), in
/// double precision with nothing added for safety.
bool overlaps(const Box&, const Vector& a, const Vector& b, const Vector& c);

}  // namespace clothbench::assets
