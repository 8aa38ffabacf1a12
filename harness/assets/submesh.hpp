#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "assets/mesh.hpp"
#include "assets/room.hpp"

namespace clothbench::assets {

/// Which triangles of a room belong to the part that a box cuts out.
enum class CutMode {
  AnyVertexInside,  ///< as published: Kim, Ma & Hong (2025), section 3.2.4, Algorithm 2
  Crossing,         ///< also triangles that cross the box without a vertex in it, as large ones of a scan do
};

/// Part of a mesh with new vertex indices. Vertices and triangles keep the order of the source.
struct SubMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> source_vertex;    ///< one per vertex
  std::vector<std::uint32_t> source_triangle;  ///< one per triangle
  std::size_t crossing_only = 0;               ///< triangles that AnyVertexInside would have left out
};

/// Cuts the part of a mesh in a box out of it. The faces of the box count as inside.
SubMesh cut(const TriangleMesh&, const Box&, CutMode);

/// The axis-aligned bounding box of six points, as Algorithm 2 builds it. Throws Error unless all are finite.
Box box_of(const std::array<Vector, 6>& points);

/// The six points for a table: the corners of its top, and the top's centre `below_m` lower and `above_m` higher.
std::array<Vector, 6> six_points(const Table&, double below_m = 0.10, double above_m = 0.05);

/// A table that fills an axis-aligned box, for points that a user picked. Its top is the box's upper face.
Table table_in(const Box& world);

/// Whether a triangle and a box intersect, by the 13 (3 + 1 + 9) separating axes of Akenine-Moller 2001, in double
/// precision without a tolerance.
bool overlaps(const Box&, const Vector& a, const Vector& b, const Vector& c);

}  // namespace clothbench::assets
