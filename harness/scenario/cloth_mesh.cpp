#include "scenario/cloth_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/json_text.hpp"
#include "base/sha256.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/load.hpp"
#include "scenario/recorded_hand.hpp"

#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

namespace clothbench {
namespace {

namespace fs = std::filesystem;

// Least area of a triangle over the square of its longest side. Below it rounding errors dominate the normal.
constexpr double kLeastArea = 1e-9;

double edge_length(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

double area_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = minus(b, a), q = minus(c, a);
  return 0.5 * std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]);
}

void check_triangle(const std::vector<Vec3>& x, const std::array<std::uint32_t, 3>& t, std::size_t k,
                    const std::string& source) {
  for (const std::uint32_t v : t)
    if (v >= x.size())
      throw Error(fmt::format("{}: triangle {}: vertex {} of {} (the first is 0)", source, k, v, x.size()));
  const double longest = std::max({edge_length(minus(x[t[1]], x[t[0]])), edge_length(minus(x[t[2]], x[t[1]])),
                                   edge_length(minus(x[t[0]], x[t[2]]))});
  if (!(area_of(x[t[0]], x[t[1]], x[t[2]]) > kLeastArea * longest * longest))
    throw Error(fmt::format("{}: triangle {} (vertices {}, {}, {}) has no area", source, k, t[0], t[1], t[2]));
}

/// The lines that define geometry. A lone carriage return ends a line too, as in the OBJ library. All other content
/// (materials, skin weights, curves) is untrusted and dropped unread.
std::string shape_lines(const std::string& text) {
  std::string lines = text, out, line;
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  std::istringstream in(lines);
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first == "v" || first == "vt" || first == "vn" || first == "f") out += line + "\n";
  }
  return out;
}

fs::path file_of(const std::string& name, const std::string& source) {
  if (const auto found = file_of_scene(name, source)) return *found;
  throw Error(fmt::format("{}: /cloth/mesh/file: \"{}\": no such file beside the scene or in {}", source, name,
                          scenario_root().string()));
}

}  // namespace

ClothMesh cloth_mesh(std::vector<Vec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                     const std::string& source) {
  ClothMesh m{std::move(vertices), std::move(triangles), {}, {}, 0};
  if (m.triangles.empty()) throw Error(source + ": expected at least one triangle");
  for (std::size_t v = 0; v < m.vertices.size(); ++v)
    if (!std::isfinite(edge_length(m.vertices[v]))) throw Error(fmt::format("{}: vertex {} is not finite", source, v));
  struct Seen {
    double areas = 0;
    int triangles = 0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Seen> seen;
  std::vector<std::uint8_t> used(m.vertices.size(), 0);
  std::map<std::array<std::uint32_t, 3>, std::size_t> same;
  for (std::size_t k = 0; k < m.triangles.size(); ++k) {
    const auto& t = m.triangles[k];
    check_triangle(m.vertices, t, k, source);
    std::array<std::uint32_t, 3> sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (const auto [at, fresh] = same.emplace(sorted, k); !fresh)
      throw Error(fmt::format("{}: triangles {} and {} have the same vertices", source, at->second, k));
    const double area = area_of(m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]]);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax(t[c], t[(c + 1) % 3]);
      Seen& edge = seen[{a, b}];
      edge.areas += area;
      if (++edge.triangles > 2)
        throw Error(fmt::format("{}: the edge of vertices {} and {} has more than two triangles", source, a, b));
      used[t[c]] = 1;
    }
  }
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] == 0) throw Error(fmt::format("{}: vertex {} is in no triangle and would have no mass", source, v));
  for (const auto& [ends, edge] : seen) {
    const double rest = edge_length(minus(m.vertices[ends.second], m.vertices[ends.first]));
    m.edges.push_back({ends.first, ends.second, rest, EdgeKind::Structural});
    m.areas_m2.push_back(edge.areas);
    m.edge_m += rest / static_cast<double>(seen.size());
  }
  return m;
}

ClothMesh parse_obj(const std::string& text, const std::string& source) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  std::istringstream in(shape_lines(text));
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &in))
    throw Error(fmt::format("{}: expected an OBJ file: {}", source, error.empty() ? "it cannot be read" : error));
  std::vector<Vec3> vertices;
  for (std::size_t k = 0; k + 2 < attributes.vertices.size(); k += 3)
    vertices.push_back({attributes.vertices[k], attributes.vertices[k + 1], attributes.vertices[k + 2]});
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const tinyobj::shape_t& shape : shapes)
    for (std::size_t k = 0; k + 2 < shape.mesh.indices.size(); k += 3) {
      std::array<std::uint32_t, 3> t{};
      for (std::size_t c = 0; c < 3; ++c) t[c] = static_cast<std::uint32_t>(shape.mesh.indices[k + c].vertex_index);
      triangles.push_back(t);
    }
  return cloth_mesh(std::move(vertices), std::move(triangles), source);
}

std::shared_ptr<const ClothMesh> read_cloth_mesh(nlohmann::json& j, const std::string& source) {
  const fs::path file = file_of(j["file"].get<std::string>(), source);
  const std::string text = read_text(file), hash = sha256(text);
  if (j.contains("sha256") && j["sha256"] != hash)
    throw Error(fmt::format("{}: /cloth/mesh/sha256: {} differs from the file that the scene was made with ({})",
                            source, file.string(), hash));
  j["sha256"] = hash;
  return std::make_shared<const ClothMesh>(parse_obj(text, file.string()));
}

std::pair<double, double> longest_sides(const ClothMesh& m) {
  Vec3 low = m.vertices.front(), high = low;
  for (const Vec3& x : m.vertices)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], x[k]);
      high[k] = std::max(high[k], x[k]);
    }
  Vec3 sides = minus(high, low);
  std::sort(sides.begin(), sides.end());
  return {sides[2], sides[1]};
}

std::uint32_t nearest_vertex(const ClothMesh& m, const Vec3& point) {
  std::size_t best = 0;
  for (std::size_t v = 1; v < m.vertices.size(); ++v)
    if (edge_length(minus(m.vertices[v], point)) < edge_length(minus(m.vertices[best], point))) best = v;
  return static_cast<std::uint32_t>(best);
}

}  // namespace clothbench
