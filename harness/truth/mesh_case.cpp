#include "truth/mesh_case.hpp"

#include <algorithm>
#include <cmath>

#include "truth/case_strip.hpp"

namespace clothbench::truth {
namespace {

constexpr double kFlat = 1e-9;  // of the length

/// u and v of every vertex [m].
std::vector<double> rest_uv(const Cloth& c) {
  std::vector<double> out;
  if (c.mesh) {
    for (const Vec3& x : c.mesh->vertices) {
      out.push_back(x[0] + c.width_m / 2);
      out.push_back(x[1] + c.height_m / 2);
    }
    return out;
  }
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) {
      // Puts the border exactly on the border, regardless of rounding.
      out.push_back(i + 1 == c.columns ? c.width_m : i * c.du());
      out.push_back(j + 1 == c.rows ? c.height_m : j * c.dv());
    }
  return out;
}

}  // namespace

LatticeSampler sampler_of(const Cloth& c) {
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangles(c)) corners.insert(corners.end(), t.begin(), t.end());
  return {MaterialLattice(c.width_m, c.height_m), rest_uv(c), corners};
}

std::vector<std::uint32_t> vertices_up_to(const Cloth& c, double u_m) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < c.vertex_count(); ++v)
    if (c.mesh->vertices[v][0] + c.width_m / 2 <= u_m + kFlat * c.width_m) out.push_back(v);
  return out;
}

void need_rectangle(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  const bool flat = std::all_of(c.mesh->vertices.begin(), c.mesh->vertices.end(), [&](const Vec3& x) {
    return std::abs(x[2]) <= kFlat * c.width_m && std::abs(x[0]) <= (0.5 + kFlat) * c.width_m &&
           std::abs(x[1]) <= (0.5 + kFlat) * c.height_m;
  });
  s.need(flat && c.mesh->pattern_m.empty(),
         "a mesh that is a flat rectangle round the middle of its frame, its longer side along x");
}

double need_mesh_clamp(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  double width_m = 0;
  for (const std::uint32_t v : s.scene.pins.vertices)
    width_m = std::max(width_m, c.mesh->vertices[v][0] + c.width_m / 2);
  s.need(width_m > kFlat * c.width_m && width_m < 0.5 * c.width_m,
         "a clamp: the vertices of edge u0 and those of a line beside it pinned");
  s.need_pins(vertices_up_to(c, width_m),
              "every vertex from edge u0 to the end of the clamp pinned and nothing else held");
  return width_m;
}

ReferenceCase on_mesh(const Strip& s, ReferenceCase known) {
  known.column_speeds = nullptr;
  known.vertices = [s, continuum = known.continuum](int frame) {
    const Cloth& c = s.scene.cloth;
    std::vector<double> out;
    for (const Vec3& at : c.mesh->vertices) {
      const Vec3 x = continuum(at[0] / c.width_m + 0.5, frame);
      for (std::size_t k = 0; k < 3; ++k) out.push_back(x[k] + at[1] * c.axis_v[k]);
    }
    return out;
  };
  // As those of a run, so that interpolation in triangles is no error.
  known.columns = [s, vertices = known.vertices](int frame) { return column_means(s.scene.cloth, vertices(frame)); };
  return known;
}

}  // namespace clothbench::truth
