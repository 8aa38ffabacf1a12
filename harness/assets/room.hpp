#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "assets/mesh.hpp"

namespace clothbench::assets {

/// A rectangle in the x-y plane of its frame, from `offset_m` to `offset_m + extent_m`.
struct Rectangle {
  std::string uuid;
  Frame frame;
  Eigen::Vector2d offset_m, extent_m;
};

/// A table as the headset's user marked it. Captures hold each table twice, as a box and as the rectangle of its top,
/// with different uuids and up to 3 mm apart. This struct pairs them.
struct Table {
  std::string uuid;        ///< of the box
  std::string stands_for;  ///< procedural rooms: uuid prefix of the scanned table that it replaces; otherwise empty
  Frame frame;             ///< of the box; +z is up in the world
  Box box;                 ///< in that frame
  std::optional<Rectangle> top;

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
  std::size_t entities = 0;             ///< number of entities of every kind in the capture
  std::size_t zero_area_triangles = 0;  ///< kept in the mesh: area below 1e-12 of the bounding box's diagonal squared
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

std::size_t count_zero_area(const TriangleMesh&);

}  // namespace clothbench::assets
