#include "assets/room.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "assets/base64.hpp"
#include "assets/mesh.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

constexpr char kRoomSchema[] =
#include "room_capture.schema.inc"
    ;

using nlohmann::json;

Vector point_of(const json& j) { return {j.value("x", 0.0), j.value("y", 0.0), j.value("z", 0.0)}; }

Frame pose_of(const json& entity, const std::string& source, const std::string& pointer) {
  const json &located = entity["locatable_META"], &turned = located["orientation"];
  const Eigen::Quaterniond q(turned.value("w", 0.0), turned.value("x", 0.0), turned.value("y", 0.0),
                             turned.value("z", 0.0));
  // Captures have unit quaternions to 1e-6; a large deviation means that the data is something else.
  if (!(std::abs(q.norm() - 1) <= 1e-3))
    refuse(source, pointer + "/locatable_META/orientation",
           fmt::format("expected a unit quaternion, not of norm {}", q.norm()));
  Frame frame = Frame::Identity();
  frame.linear() = q.normalized().toRotationMatrix();
  frame.translation() = point_of(located.value("position", json::object()));
  return frame;
}

Table table_of(const json& entity, const Frame& frame) {
  Table table;
  table.uuid = entity["uuid"].get<std::string>();
  table.frame = frame;
  const json &bounded = entity["bounded3D_META"], &extent = bounded["extent"];
  const Vector low = point_of(bounded.value("offset", json::object()));
  table.box = Box(
      low, low + Vector(extent["width"].get<double>(), extent["height"].get<double>(), extent["depth"].get<double>()));
  return table;
}

TriangleMesh mesh_of(const json& stored, const Frame& frame, const std::string& source, const std::string& pointer) {
  const auto text = [&](const char* key) { return stored[key].get_ref<const std::string&>(); };
  TriangleMesh mesh;
  for (const auto& [x, y, z] : decode_items<std::array<float, 3>>(text("vertices"), source, pointer + "/vertices")) {
    const Vector p(x, y, z);
    if (!p.allFinite())
      refuse(source, pointer + "/vertices", fmt::format("vertex {} is not finite", mesh.vertex_count()));
    mesh.add_vertex(frame * p);
  }
  mesh.triangles = decode_items<std::array<std::uint32_t, 3>>(text("indices"), source, pointer + "/indices");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (!(v < mesh.vertex_count()))
        refuse(source, pointer + "/indices",
               fmt::format("triangle {} names vertex {}, but there are {}", t, v, mesh.vertex_count()));
  return mesh;
}

}  // namespace

std::array<Vector, 4> Table::top_corners() const {
  const Vector low = box.min(), high = box.max();
  return {frame * Vector(low.x(), low.y(), high.z()), frame * Vector(high.x(), low.y(), high.z()),
          frame * Vector(high.x(), high.y(), high.z()), frame * Vector(low.x(), high.y(), high.z())};
}

double Table::top_height() const {
  const auto corners = top_corners();
  return (corners[0].y() + corners[1].y() + corners[2].y() + corners[3].y()) / 4;
}

Room parse_room(const std::string& text, const std::string& source, const std::string& name) {
  const json document = parse_json(text, source);
  validate_json(document, kRoomSchema, source);
  const json& entities = document["spatialEntities"];
  Room room;
  room.name = name;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const std::string pointer = fmt::format("/spatialEntities/{}", i), mesh = pointer + "/triangleMesh_META";
    const json& entity = entities[i];
    if (entity.contains("triangleMesh_META")) {
      if (!room.mesh.triangles.empty()) refuse(source, mesh, "a second mesh; expected one");
      room.mesh = mesh_of(entity["triangleMesh_META"], pose_of(entity, source, pointer), source, mesh);
    }
    if (entity.value("semanticLabel_META", "") == "TABLE" && entity.contains("bounded3D_META"))
      room.tables.push_back(table_of(entity, pose_of(entity, source, pointer)));
  }
  if (room.mesh.triangles.empty())
    refuse(source, "/spatialEntities", "expected an entity with triangleMesh_META, the scanned mesh");
  return room;
}

Room load_room(const std::filesystem::path& path) {
  return parse_room(read_text(path), path.string(), path.stem().string());
}

const Table& find_table(const Room& room, const std::string& prefix) {
  const Table* found = nullptr;
  int matches = 0;
  for (const Table& table : room.tables) {
    const bool stands =
        !table.stands_for.empty() && (table.stands_for.starts_with(prefix) || prefix.starts_with(table.stands_for));
    if (prefix.empty() || !(table.uuid.starts_with(prefix) || stands)) continue;
    ++matches;
    found = &table;
  }
  if (matches == 1) return *found;
  throw Error(fmt::format("room {}: {} tables have a uuid that starts with {}; there are: {}", room.name, matches,
                          in_quotes(prefix), room.tables.empty() ? "none" : joined(room.tables, ", ", &Table::uuid)));
}

TriangleMesh cut(const TriangleMesh& mesh, const Box& box) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<bool> inside(mesh.vertex_count());
  for (std::size_t v = 0; v < inside.size(); ++v) inside[v] = box.contains(mesh.vertex(v));
  TriangleMesh out;
  std::vector<std::uint32_t> renumbered(mesh.vertex_count(), kUnused);
  for (const auto& t : mesh.triangles) {
    if (!(inside[t[0]] || inside[t[1]] || inside[t[2]])) continue;
    out.triangles.push_back(t);
    for (const std::uint32_t v : t) renumbered[v] = 0;
  }
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == kUnused) continue;
    renumbered[v] = static_cast<std::uint32_t>(out.vertex_count());
    out.add_vertex(mesh.vertex(v));
  }
  for (auto& t : out.triangles)
    for (std::uint32_t& v : t) v = renumbered[v];
  return out;
}

Box box_around(const Table& table, double below_m, double above_m) {
  const auto corners = table.top_corners();
  Box box;
  for (const Vector& corner : corners) box.extend(corner);
  const Vector middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
  return box.extend(middle - below_m * Vector::UnitY()).extend(middle + above_m * Vector::UnitY());
}

bool is_closed_manifold(const TriangleMesh& mesh) {
  // Corner 3 t + k is the start of edge k of triangle t.
  const auto vertex = [&](std::size_t corner) { return mesh.triangles[corner / 3][corner % 3]; };
  const auto next = [](std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; };
  const auto edge = [](std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; };
  const std::size_t corners = 3 * mesh.triangles.size();
  std::unordered_map<std::uint64_t, std::size_t> starts;
  for (std::size_t c = 0; c < corners; ++c) {
    const std::uint32_t from = vertex(c), to = vertex(next(c));
    if (from == to || !starts.emplace(edge(from, to), c).second) return false;
  }
  std::vector<bool> seen(corners, false), has_fan(mesh.vertex_count(), false);
  for (std::size_t c = 0; c < corners; ++c) {
    if (seen[c]) continue;
    if (has_fan[vertex(c)]) return false;
    has_fan[vertex(c)] = true;
    for (std::size_t at = c; !seen[at];) {
      seen[at] = true;
      const auto opposite = starts.find(edge(vertex(next(at)), vertex(at)));
      if (opposite == starts.end()) return false;
      at = next(opposite->second);
    }
  }
  return true;
}

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  // Volume relative to one of the mesh's points, because digits would be lost far from the origin.
  const Vector origin = mesh.vertex(mesh.triangles[0][0]);
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += (mesh.vertex(t[0]) - origin).dot((mesh.vertex(t[1]) - origin).cross(mesh.vertex(t[2]) - origin));
  return six / 6;
}

TriangleMesh prism(const Vector& axis, const Vector& center, double radius, double length, std::uint32_t sides) {
  const Vector a = axis.unitOrthogonal(), b = axis.cross(a), half = 0.5 * length * axis;
  TriangleMesh mesh;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    const Vector rim = center + radius * (std::cos(angle) * a + std::sin(angle) * b);
    mesh.add_vertex(rim - half);
    mesh.add_vertex(rim + half);
  }
  mesh.add_vertex(center - half);
  mesh.add_vertex(center + half);
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t p = 2 * k, q = 2 * ((k + 1) % sides), low = 2 * sides, high = low + 1;
    mesh.triangles.push_back({p, q, q + 1});
    mesh.triangles.push_back({p, q + 1, p + 1});
    mesh.triangles.push_back({low, q, p});
    mesh.triangles.push_back({high, p + 1, q + 1});
  }
  return mesh;
}

}  // namespace clothbench::assets
