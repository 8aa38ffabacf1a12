// Static triangles (given in the scene, of a prism or of a room) and the skin of a hand.
#include <fmt/format.h>

#include "scenario/collider_kinds.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/moving_hand.hpp"
#include "scenario/recorded_hand.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

void read_cylinder(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Mesh;
  const Vec3 axis = reader.unit(j, "axis");
  c.mesh = collider_mesh(assets::prism(assets::Vector(axis[0], axis[1], axis[2]),
                                       assets::Vector::Map(vec3(j["center_m"]).data()), j["radius_m"].get<double>(),
                                       j["length_m"].get<double>(), j["sides"].get<std::uint32_t>()));
}

void read_mesh(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Mesh;
  assets::TriangleMesh m;
  for (const json& p : j["positions_m"]) m.add_vertex({p[0].get<double>(), p[1].get<double>(), p[2].get<double>()});
  for (std::size_t t = 0; t < j["triangles"].size(); ++t) {
    const json& corners = j["triangles"][t];
    for (std::size_t k = 0; k < 3; ++k)
      if (corners[k].get<std::size_t>() >= m.vertex_count())
        reader.refuse(fmt::format("/triangles/{}/{}", t, k),
                      fmt::format("vertex {} of {} (the first is 0)", corners[k].get<std::size_t>(), m.vertex_count()));
    m.triangles.push_back(
        {corners[0].get<std::uint32_t>(), corners[1].get<std::uint32_t>(), corners[2].get<std::uint32_t>()});
  }
  c.mesh = collider_mesh(m);
}

/// A user's capture is read as a file: it is not an asset, and no stand-in may replace it.
assets::Room room_of(const std::string& name, ColliderReader& reader) {
  if (!name.ends_with(".json")) return assets::open_room(reader.assets(), name);
  return assets::load_room(file_of_scene(name, reader.source()).value_or(name));
}

void read_room(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Mesh;
  c.name = j["room"].get<std::string>();
  const assets::Room room = room_of(c.name, reader);
  const auto cut = j["cut"].get<std::string>();
  std::optional<assets::Table> table;
  assets::TriangleMesh round_table;
  if (j.contains("table")) {
    table = assets::find_table(room, j["table"].get<std::string>());
    c.name += "/" + j["table"].get<std::string>();
    const assets::Box box = assets::box_around(*table, j["below_m"].get<double>(), j["above_m"].get<double>());
    round_table = assets::cut(room.mesh, box);
    if (round_table.triangles.empty()) reader.refuse("", "expected at least one triangle of the room in the box");
  } else if (cut != "none") {
    reader.refuse("", fmt::format("\"table\" is missing; cut \"{}\" goes round one", cut));
  }
  c.mesh = collider_mesh(cut == "none" ? room.mesh : round_table);
  // The cloth is placed over the cut mesh even if the collider is the whole room, whose ceiling is above the cloth.
  if (table) reader.table = {*table, *collider_mesh(round_table)};
}

void read_hand_mesh(const json& j, ColliderReader& reader, Collider& c) { read_hand(j, reader, c, true); }

ColliderSurface surface_of_mesh(const Collider& c, const ColliderPose& pose, const Extent&) {
  return {posed_positions(*c.mesh, pose), c.mesh->triangles};
}

}  // namespace

ColliderKind mesh_kind() {
  ColliderKind k{Collider::Shape::Mesh, "mesh", Feature::StaticMesh, Feature::MovingMesh};
  k.types = {{"cylinder", read_cylinder}, {"mesh", read_mesh}, {"room", read_room}, {"hand_mesh", read_hand_mesh}};
  k.holds = ColliderKind::Holds::Mesh;
  k.surface = surface_of_mesh;
  return k;
}

}  // namespace clothbench
