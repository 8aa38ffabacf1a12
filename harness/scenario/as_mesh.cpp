#include "scenario/as_mesh.hpp"

#include "clothbench/vector.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

/// Whether the cell in column i and row j is cut along its other diagonal: scattered, but the same in every run.
bool turned(int i, int j) { return (7 * i + 5 * j + i * j) % 3 == 0; }

}  // namespace

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
