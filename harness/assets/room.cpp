#include "assets/room.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "assets/json_at.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

Vector vector_at(const std::optional<JsonAt>& at) {
  if (!at) return Vector::Zero();
  return {at->number_or("x", 0), at->number_or("y", 0), at->number_or("z", 0)};
}

Frame pose_of(const JsonAt& entity) {
  const JsonAt located = entity.key("locatable_META");
  const JsonAt turned = located.key("orientation");
  const Eigen::Quaterniond q(turned.number_or("w", 0), turned.number_or("x", 0), turned.number_or("y", 0),
                             turned.number_or("z", 0));
  // Captures hold unit quaternions to 1e-6; anything far from that is another kind of data.
  if (!(std::abs(q.norm() - 1) <= 1e-3))
    turned.fail(fmt::format("expected a unit quaternion, not of norm {}", q.norm()));
  Frame frame = Frame::Identity();
  frame.linear() = q.normalized().toRotationMatrix();
  frame.translation() = vector_at(located.maybe("position"));
  return frame;
}

double extent_at(const JsonAt& extent, const char* name) {
  const double v = extent.number_or(name, 0);
  if (!(v > 0)) extent.fail(fmt::format("\"{}\" is {}; expected more than 0 m", name, v));
  return v;
}

Table table_at(const JsonAt& entity, const JsonAt& bounded) {
  Table table;
  table.uuid = entity.key("uuid").text();
  table.frame = pose_of(entity);
  const JsonAt extent = bounded.key("extent");
  const Vector low = vector_at(bounded.maybe("offset"));
  table.box =
      Box(low, low + Vector(extent_at(extent, "width"), extent_at(extent, "height"), extent_at(extent, "depth")));
  return table;
}

TriangleMesh mesh_at(const JsonAt& entity, const JsonAt& stored) {
  const Frame frame = pose_of(entity);
  const JsonAt vertices_at = stored.key("vertices"), indices_at = stored.key("indices");
  TriangleMesh mesh;
  for (const auto& [x, y, z] : vertices_at.items<std::array<float, 3>>()) {
    const Vector p(x, y, z);
    if (!p.allFinite()) vertices_at.fail(fmt::format("vertex {} is not finite", mesh.vertex_count()));
    mesh.add_vertex(frame * p);
  }
  mesh.triangles = indices_at.items<std::array<std::uint32_t, 3>>();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (!(v < mesh.vertex_count()))
        indices_at.fail(fmt::format("triangle {} names vertex {}, but there are {}", t, v, mesh.vertex_count()));
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
  const nlohmann::json document = parse_json(text, source);
  const JsonAt root(document, source);
  const JsonAt type = root.key("type"), version = root.key("version");
  if (type.text() != "scene") type.fail("expected \"scene\", not " + in_quotes(type.text()));
  if (version.number() != 1) version.fail("version " + version.json().dump() + "; 1 is understood");
  Room room;
  room.name = name;
  const JsonAt entities = root.key("spatialEntities");
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const JsonAt entity = entities.item(i);
    if (const auto stored = entity.maybe("triangleMesh_META")) {
      if (!room.mesh.triangles.empty()) stored->fail("a second mesh; expected one entity with triangleMesh_META");
      room.mesh = mesh_at(entity, *stored);
    }
    const auto label = entity.maybe("semanticLabel_META"), box = entity.maybe("bounded3D_META");
    if (label && label->text() == "TABLE" && box) room.tables.push_back(table_at(entity, *box));
  }
  if (room.mesh.triangles.empty()) entities.fail("expected an entity with triangleMesh_META, the scanned mesh");
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
  Vector middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
  const double top = table.top_height();
  for (const double height : {top - below_m, top + above_m}) {
    middle.y() = height;
    box.extend(middle);
  }
  return box;
}

}  // namespace clothbench::assets
