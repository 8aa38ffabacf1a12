#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "assets/mesh.hpp"

namespace clothbench::assets {

/// A table as marked by the headset's user. Captures also contain each table's top as a rectangle, up to 3 mm off the
/// box; this rectangle is not read.
struct Table {
  std::string uuid;        ///< identifies the box
  std::string stands_for;  ///< in procedural rooms: uuid prefix of the scanned table that it replaces; otherwise empty
  Frame frame;             ///< pose of the box in the world; its +z points up
  Box box;                 ///< the box in coordinates of `frame`

  /// Corners [m] of the box's upper face in world coordinates, counter-clockwise seen from above.
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

/// Reads a Quest room capture in the format of @iwer/sem (protobuf JSON: zero fields are omitted). Uses the mesh of the
/// one entity with `triangleMesh_META`. Ignores its label, because one of the five captures labels it UNRECOGNIZED.
/// Throws Error with the file and JSON pointer.
Room load_room(const std::filesystem::path&);
/// As load_room, from text; `source` is for messages, `name` for the room.
Room parse_room(const std::string& text, const std::string& source, const std::string& name);

/// The table whose uuid (or `stands_for`) starts with `prefix`. Throws Error listing the room's tables if none
/// or several match.
const Table& find_table(const Room&, const std::string& prefix);

/// The triangles of a mesh that have a vertex in or on a box, in the source's order: Algorithm 2 of Kim, Ma & Hong
/// (2025), section 3.2.4. It omits large triangles that cross the box without a vertex in it.
TriangleMesh cut(const TriangleMesh&, const Box&);

/// The box that the algorithm cuts out around a table: the bounding box of six points, the four corners of its top and
/// the top's centre moved `below_m` down and `above_m` up.
Box box_around(const Table&, double below_m = 0.10, double above_m = 0.05);

}  // namespace clothbench::assets
