#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "assets/mesh.hpp"

namespace clothbench::assets {

/// A table as the headset's user marked it. Captures also contain each table's top as a rectangle, up to 3 mm off the
/// box; it is not read.
struct Table {
  std::string uuid;        ///< of the box
  std::string stands_for;  ///< procedural rooms: uuid prefix of the scanned table that it replaces; otherwise empty
  Frame frame;             ///< of the box; +z is up in the world
  Box box;                 ///< in that frame

  /// Corners of the box's upper face in the world [m], counter-clockwise from above.
  std::array<Vector, 4> top_corners() const;
  /// Height of that face [m].
  double top_height() const;
};

/// A room: one mesh in world coordinates (right-handed, +y up, y = 0 near the floor). Normals point into free space, so
/// the signed volume is negative.
struct Room {
  std::string name;
  TriangleMesh mesh;
  std::vector<Table> tables;
};

/// Reads a Quest room capture as @iwer/sem stores them (protobuf JSON: zero fields are left out). It takes the mesh of
/// the one entity with `triangleMesh_META`. Its label is not used, as one of the five captures labels it UNRECOGNIZED.
/// Throws Error with the file and JSON pointer.
Room load_room(const std::filesystem::path&);
/// The same from text; `source` is for messages, `name` for the room.
Room parse_room(const std::string& text, const std::string& source, const std::string& name);

/// The table whose uuid (or `stands_for`) starts with `prefix`. Throws Error listing the room's tables if none or more
/// than one does.
const Table& find_table(const Room&, const std::string& prefix);

/// The triangles of a mesh that have a vertex in a box, faces included, in the order of the source: Algorithm 2 of Kim,
/// Ma & Hong (2025), section 3.2.4. It leaves out large triangles that cross the box without a vertex in it.
TriangleMesh cut(const TriangleMesh&, const Box&);

/// The box that the algorithm cuts out around a table: the bounding box of six points, which are the corners of its top
/// and the top's centre `below_m` lower and `above_m` higher.
Box box_around(const Table&, double below_m = 0.10, double above_m = 0.05);

}  // namespace clothbench::assets
