#include "scenario/cloth_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/collider_reader.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 256u << 20;
// Minimum area of a triangle over the square of its longest side. Below it rounding errors dominate the normal.
constexpr double kLeastArea = 1e-9;

using Triangle = std::array<std::uint32_t, 3>;

double edge_length(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

double area_of(const std::array<Vec3, 3>& x) { return 0.5 * edge_length(cross(minus(x[1], x[0]), minus(x[2], x[0]))); }

bool has_area(const std::array<Vec3, 3>& x) {
  const double longest =
      std::max({edge_length(minus(x[1], x[0])), edge_length(minus(x[2], x[1])), edge_length(minus(x[0], x[2]))});
  return area_of(x) > kLeastArea * longest * longest;
}

/// "<source>: line 7": place of a vertex or triangle in a file; only the source if the file has no lines.
std::string place(const std::string& source, const std::vector<std::uint32_t>& lines, std::size_t k) {
  return lines.empty() ? source : fmt::format("{}: line {}", source, lines[k]);
}

void check_triangles(const ClothMesh& m, const assets::MeshFile& file, const std::string& source) {
  if (m.triangles.empty()) throw Error(source + ": expected at least one triangle");
  for (std::size_t v = 0; v < m.vertices.size(); ++v)
    if (!std::isfinite(edge_length(m.vertices[v]))) throw Error(fmt::format("{}: vertex {} is not finite", source, v));
  std::vector<std::uint8_t> used(m.vertices.size(), 0);
  std::vector<std::pair<Triangle, std::size_t>> sorted;
  for (std::size_t k = 0; k < m.triangles.size(); ++k) {
    const Triangle& t = m.triangles[k];
    for (const std::uint32_t v : t) {
      if (v >= m.vertices.size())
        throw Error(fmt::format("{}: triangle {}: vertex {} of {} (the first is 0)", source, k, v, m.vertices.size()));
      used[v] = 1;
    }
    const auto no_area = [&](const char* in) {
      throw Error(fmt::format("{}: triangle {} (vertices {}, {}, {}) has no area{}",
                              place(source, file.triangle_lines, k), k, t[0], t[1], t[2], in));
    };
    if (!has_area({m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]]})) no_area("");
    if (!m.pattern_m.empty() && !has_area(rest_corners(m, k))) no_area(" at rest");
    sorted.emplace_back(t, k);
    std::sort(sorted.back().first.begin(), sorted.back().first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (sorted[k - 1].first == sorted[k].first)
      throw Error(fmt::format("{}: triangles {} and {} have the same vertices",
                              place(source, file.triangle_lines, sorted[k].second), sorted[k - 1].second,
                              sorted[k].second));
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] == 0)
      throw Error(fmt::format("{}: vertex {} (the first is 0) is in no triangle and would have no mass",
                              place(source, file.vertex_lines, v), v));
}

/// An edge of one triangle, its ends in ascending order.
struct Side {
  std::uint32_t a, b, triangle, corner;
  bool forward;  ///< the triangle's winding runs from a to b
};

std::vector<Side> sides_of(const ClothMesh& m) {
  std::vector<Side> out;
  out.reserve(3 * m.triangles.size());
  for (std::uint32_t k = 0; k < m.triangles.size(); ++k)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t from = m.triangles[k][c], to = m.triangles[k][(c + 1) % 3];
      out.push_back({std::min(from, to), std::max(from, to), k, c, from < to});
    }
  std::sort(out.begin(), out.end(), [](const Side& p, const Side& q) {
    return std::tie(p.a, p.b, p.triangle) < std::tie(q.a, q.b, q.triangle);
  });
  return out;
}

void add_edges(ClothMesh& m, const assets::MeshFile& file, const std::string& source) {
  const std::vector<Side> sides = sides_of(m);
  double all = 0;
  for (std::size_t k = 0; k < sides.size();) {
    const Side& s = sides[k];
    double area = 0, rest = 0;
    std::size_t count = 0;
    for (; k + count < sides.size() && sides[k + count].a == s.a && sides[k + count].b == s.b; ++count) {
      const Side& t = sides[k + count];
      const std::array<Vec3, 3> x = rest_corners(m, t.triangle);
      area += area_of(x);
      rest += edge_length(minus(x[(t.corner + 1) % 3], x[t.corner]));
    }
    if (count > 2)
      throw Error(fmt::format("{}: the edge of vertices {} and {} has more than two triangles",
                              place(source, file.triangle_lines, sides[k + 2].triangle), s.a, s.b));
    if (count == 2 && s.forward == sides[k + 1].forward)
      throw Error(
          fmt::format("{}: triangles {} and {} are wound oppositely: both run from vertex {} to {}; expected the "
                      "triangles of a cloth to be wound alike",
                      place(source, file.triangle_lines, sides[k + 1].triangle), s.triangle, sides[k + 1].triangle,
                      s.forward ? s.a : s.b, s.forward ? s.b : s.a));
    // The two edges of a seam may differ in length; the sewn edge has their mean.
    m.edges.push_back({s.a, s.b, rest / static_cast<double>(count), EdgeKind::Structural});
    m.areas_m2.push_back(area);
    k += count;
  }
  for (const Edge& e : m.edges) all += e.rest_m / static_cast<double>(m.edges.size());
  m.edge_m = all;
}

/// Merges every vertex into the first one at the same position; the others keep their order. Returns the number of
/// vertices removed.
std::size_t weld(assets::MeshFile& file) {
  std::map<Vec3, std::uint32_t> places;
  std::vector<Vec3> kept;
  std::vector<std::uint32_t> to, lines;
  for (std::size_t v = 0; v < file.vertices.size(); ++v) {
    const Vec3& x = file.vertices[v];
    const auto next = static_cast<std::uint32_t>(kept.size());
    // A vertex that is not finite equals no other; the checks of the cloth report it.
    to.push_back(std::isfinite(edge_length(x)) ? places.emplace(x, next).first->second : next);
    if (to.back() != next) continue;
    kept.push_back(x);
    if (!file.vertex_lines.empty()) lines.push_back(file.vertex_lines[v]);
  }
  const std::size_t removed = file.vertices.size() - kept.size();
  for (auto& t : file.triangles)
    for (std::uint32_t& v : t)
      if (v < to.size()) v = to[v];
  file.vertices = std::move(kept);
  file.vertex_lines = std::move(lines);
  return removed;
}

/// Fills the groups: for each, the vertices of its triangles, ascending.
void add_groups(ClothMesh& m, const assets::MeshFile& file) {
  for (const auto& [name, members] : file.groups) {
    std::set<std::uint32_t> vertices;
    for (const std::uint32_t t : members) vertices.insert(m.triangles[t].begin(), m.triangles[t].end());
    m.groups[name].assign(vertices.begin(), vertices.end());
  }
}

void notice_welded(const ClothMesh& m, const std::string& file) {
  static std::mutex mutex;
  static std::set<std::string> noticed;
  const std::lock_guard lock(mutex);
  if (m.welded_vertices == 0 || !noticed.insert(file).second) return;
  fmt::print(stderr, "notice: {}: {} vertices coincide with an earlier one and were welded to it\n", file,
             m.welded_vertices);
}

/// The vertex that "u0v1" etc. names.
std::uint32_t corner(const Cloth& c, const std::string& name) {
  const int i = name[1] == '1' ? c.columns - 1 : 0, j = name[3] == '1' ? c.rows - 1 : 0;
  return static_cast<std::uint32_t>(j * c.columns + i);
}

std::uint32_t nearest_vertex(const ClothMesh& m, const Vec3& point) {
  std::size_t best = 0;
  for (std::size_t v = 1; v < m.vertices.size(); ++v)
    if (edge_length(minus(m.vertices[v], point)) < edge_length(minus(m.vertices[best], point))) best = v;
  return static_cast<std::uint32_t>(best);
}

/// Whether the cell in column i and row j is cut along its other diagonal; the pattern is irregular but reproducible.
bool turned(int i, int j) { return (7 * i + 5 * j + i * j) % 3 == 0; }

}  // namespace

ClothMesh cloth_mesh(assets::MeshFile file, const std::string& source, std::vector<PatternTriangle> pattern_m) {
  ClothMesh m;
  m.welded_vertices = weld(file);
  m.vertices = std::move(file.vertices);
  m.triangles = std::move(file.triangles);
  m.pattern_m = std::move(pattern_m);
  check_triangles(m, file, source);
  add_edges(m, file, source);
  add_groups(m, file);
  return m;
}

std::shared_ptr<const ClothMesh> read_cloth_mesh(nlohmann::json& j, const std::string& source) {
  if (j.contains("drawn") == j.contains("file")) refuse(source, "/cloth/mesh", "expected either \"file\" or \"drawn\"");
  if (j.contains("drawn")) {
    if (j.contains("sha256")) refuse(source, "/cloth/mesh/sha256", "expected a mesh from a file, not a drawn one");
    return std::make_shared<const ClothMesh>(read_drawn_mesh(j["drawn"], source));
  }
  const fs::path file = needed_file(j["file"].get<std::string>(), source, "/cloth/mesh/file");
  const std::string text = read_text(file, kMostBytes), hash = sha256(text);
  if (j.contains("sha256") && j["sha256"] != hash)
    throw Error(fmt::format("{}: /cloth/mesh/sha256: {} differs from the file that the scene was made with ({})",
                            source, file.string(), hash));
  j["sha256"] = hash;
  const std::string kind = lower_case(file.extension().string());
  if (kind != ".obj" && kind != ".gltf" && kind != ".glb")
    refuse(source, "/cloth/mesh/file", "expected a file whose name ends in .obj, .gltf or .glb");
  auto mesh = std::make_shared<const ClothMesh>(cloth_mesh(
      kind == ".obj" ? read_obj(text, file.string()) : assets::parse_gltf(text, file.string()), file.string()));
  notice_welded(*mesh, file.string());
  return mesh;
}

const std::vector<std::uint32_t>& group_vertices(const Cloth& c, const std::string& name, const std::string& source,
                                                 const std::string& pointer) {
  if (!c.mesh) refuse(source, pointer, "expected a cloth that is a mesh");
  const auto found = c.mesh->groups.find(name);
  if (found != c.mesh->groups.end() && !found->second.empty()) return found->second;
  std::vector<std::string> known;
  for (const auto& [group, vertices] : c.mesh->groups)
    if (!vertices.empty()) known.push_back(group);
  constexpr std::size_t kMost = 20;
  const std::size_t all = known.size();
  known.resize(std::min(all, kMost));
  refuse(source, pointer,
         fmt::format("the mesh has no triangles in a group {}; expected {}", in_quotes(name),
                     known.empty()
                         ? std::string("a mesh with named groups")
                         : fmt::format("one of: {}{}", shortened(joined(known), 400), all > kMost ? ", ..." : "")));
}

std::vector<std::uint32_t> listed_vertices(const Cloth& c, const nlohmann::json& list, const std::string& source,
                                           const std::string& pointer) {
  std::vector<std::uint32_t> out;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto v = list[k].get<std::uint64_t>();
    if (v >= c.vertex_count())
      refuse(source, fmt::format("{}/{}", pointer, k),
             fmt::format("vertex {} of {} (the first is 0)", v, c.vertex_count()));
    out.push_back(static_cast<std::uint32_t>(v));
  }
  return out;
}

std::vector<std::uint32_t> selected_vertices(const Cloth& c, const nlohmann::json& j, const std::string& source,
                                             const std::string& pointer) {
  for (const char* of_grids : {"corners", "edge", "clamp"})
    if (c.mesh && j.contains(of_grids))
      refuse(source, pointer + "/" + of_grids,
             "not available on a mesh; expected \"group\", \"vertices\" or \"nearest_m\"");
  if (!c.mesh && j.contains("nearest_m")) refuse(source, pointer + "/nearest_m", "expected a cloth that is a mesh");
  std::vector<std::uint32_t> out;
  const auto add = [&](const auto& more) { out.insert(out.end(), more.begin(), more.end()); };
  if (j.contains("group")) add(group_vertices(c, j["group"].get<std::string>(), source, pointer + "/group"));
  if (j.contains("nearest_m"))
    for (const auto& point : j["nearest_m"]) out.push_back(nearest_vertex(*c.mesh, vec3(point)));
  if (j.contains("corners"))
    for (const auto& name : j["corners"]) out.push_back(corner(c, name.get<std::string>()));
  if (j.contains("edge")) add(edge_vertices(c, j["edge"].get<std::string>()));
  if (j.contains("clamp")) add(clamp_vertices(c, j["clamp"].get<std::string>()));
  if (j.contains("vertices")) add(listed_vertices(c, j["vertices"], source, pointer + "/vertices"));
  if (out.empty()) refuse(source, pointer, "expected \"edge\", \"group\" or \"vertices\"");
  return out;
}

std::pair<double, double> longest_sides(const ClothMesh& m) {
  std::vector<std::uint32_t> first(m.vertices.size());  // a vertex of the same piece
  std::iota(first.begin(), first.end(), 0u);
  const auto piece = [&](std::uint32_t v) {
    while (first[v] != v) v = first[v] = first[first[v]];
    return v;
  };
  for (const Edge& e : m.edges) first[piece(e.b)] = piece(e.a);
  struct Box {
    Vec3 low, high;
  };
  std::vector<Box> boxes;
  for (const Vec3& x : m.vertices) boxes.push_back({x, x});
  std::pair<double, double> out{0, 0};
  for (std::uint32_t v = 0; v < m.vertices.size(); ++v) {
    Box& all = boxes[piece(v)];
    for (std::size_t k = 0; k < 3; ++k) {
      all.low[k] = std::min(all.low[k], m.vertices[v][k]);
      all.high[k] = std::max(all.high[k], m.vertices[v][k]);
    }
    Vec3 sides = minus(all.high, all.low);
    std::sort(sides.begin(), sides.end());
    out = std::max(out, std::pair{sides[2], sides[1]});
  }
  return out;
}

Scene as_mesh(Scene s, bool bends) {
  Cloth& c = s.cloth;
  if (c.mesh) return s;
  const bool bent = c.span_m > 0 || c.drape_radius_m > 0;
  const Vec3 normal = cross(c.axis_u, c.axis_v);
  assets::MeshFile file;
  std::vector<std::array<double, 2>> pattern;
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) {
      const Vec3 at = minus(s.rest_position(i, j), c.center_m);
      const std::array<double, 2> flat = {c.line_u_m(i) - c.width_m / 2, j * c.dv() - c.height_m / 2};
      pattern.push_back(flat);
      if (bent)
        file.vertices.push_back({dot(at, c.axis_u), dot(at, c.axis_v), dot(at, normal)});
      else
        file.vertices.push_back({flat[0], flat[1], 0});
    }
  for (int j = 0; j + 1 < c.rows; ++j)
    for (int i = 0; i + 1 < c.columns; ++i) {
      const auto p = static_cast<std::uint32_t>(j * c.columns + i), q = p + 1,
                 r = p + static_cast<std::uint32_t>(c.columns), t = r + 1;
      const std::uint32_t last[2][3] = {{p, t, r}, {q, t, r}};
      const auto& other = last[turned(i, j) ? 1 : 0];
      file.triangles.push_back({p, q, turned(i, j) ? r : t});
      file.triangles.push_back({other[0], other[1], other[2]});
    }
  std::vector<PatternTriangle> at_rest;
  for (const auto& t : file.triangles)
    if (bent) at_rest.push_back({pattern[t[0]], pattern[t[1]], pattern[t[2]]});
  c.mesh = std::make_shared<const ClothMesh>(cloth_mesh(std::move(file), s.source, std::move(at_rest)));
  c.columns = static_cast<int>(c.mesh->vertices.size());
  c.rows = 1;
  std::tie(c.width_m, c.height_m) = longest_sides(*c.mesh);
  c.span_m = c.drape_radius_m = 0;
  c.column_factors.clear();
  s.material.regions.clear();
  if (!bends) s.material.bending_rigidity_N_m = 0;
  s.reference_case.clear();
  s.expect.clear();
  s.needs = derive_needs(s);
  return s;
}

}  // namespace clothbench
