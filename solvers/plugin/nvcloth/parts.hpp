/// The connected parts of the cloth. Each becomes a cloth of the engine, which simulates many at once on a GPU.
#pragma once

#include <numeric>

#include "peer.hpp"

namespace clothbench::nvcloth {

/// The scene of one part, with the colliders of the whole scene.
struct Part {
  ClothbenchScene scene;
  std::vector<std::uint32_t> vertices, grips;  ///< of each vertex and grip of the part: its index in the whole scene
  // Memory of `scene`:
  std::vector<std::uint32_t> triangles, pins, gripped;
  std::vector<double> position, rest, mass;
  std::vector<ClothbenchEdge> edges;
};

/// Points the scene of a part to the part's memory. Only grids have shear and skip edges, and a grid is one part.
inline void connect(Part& p, const ClothbenchScene& whole) {
  const auto size = [](const auto& v) { return static_cast<std::uint32_t>(v.size()); };
  p.scene = whole;
  if (whole.rows == 1) p.scene.columns = size(p.vertices);
  p.scene.vertex_count = size(p.vertices);
  p.scene.position_m = p.position.data(), p.scene.rest_position_m = p.rest.data(), p.scene.mass_kg = p.mass.data();
  p.scene.triangle_count = size(p.triangles) / 3, p.scene.triangles = p.triangles.data();
  p.scene.structural_count = size(p.edges), p.scene.structural_edges = p.edges.data();
  p.scene.pin_count = size(p.pins), p.scene.pins = p.pins.data();
  p.scene.grip_count = size(p.gripped), p.scene.grips = p.gripped.data();
}

/// Divides the cloth into its connected parts, in the order of their first vertices.
inline std::vector<Part> parts_of(const ClothbenchScene& s) {
  std::vector<std::uint32_t> before(s.vertex_count), part(s.vertex_count), local(s.vertex_count);
  std::iota(before.begin(), before.end(), 0U);
  const auto first = [&](std::uint32_t v) {
    while (before[v] != v) v = before[v] = before[before[v]];
    return v;
  };
  for (std::uint32_t k = 0; k < s.structural_count; ++k) {
    const std::uint32_t a = first(s.structural_edges[k].a), b = first(s.structural_edges[k].b);
    before[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Part> out;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) {
    part[v] = first(v) == v ? static_cast<std::uint32_t>(out.size()) : part[first(v)];
    if (first(v) == v) out.emplace_back();
    Part& p = out[part[v]];
    local[v] = static_cast<std::uint32_t>(p.vertices.size());
    p.vertices.push_back(v);
    p.mass.push_back(s.mass_kg[v]);
    p.position.insert(p.position.end(), s.position_m + 3 * v, s.position_m + 3 * v + 3);
    p.rest.insert(p.rest.end(), s.rest_position_m + 3 * v, s.rest_position_m + 3 * v + 3);
  }
  for (std::uint32_t n = 0; n < 3 * s.triangle_count; ++n)
    out[part[s.triangles[n]]].triangles.push_back(local[s.triangles[n]]);
  for (std::uint32_t k = 0; k < s.structural_count; ++k) {
    ClothbenchEdge e = s.structural_edges[k];
    std::vector<ClothbenchEdge>& edges = out[part[e.a]].edges;
    e.a = local[e.a], e.b = local[e.b];
    edges.push_back(e);
  }
  for (std::uint32_t k = 0; k < s.pin_count; ++k) out[part[s.pins[k]]].pins.push_back(local[s.pins[k]]);
  for (std::uint32_t k = 0; k < s.grip_count; ++k) {
    out[part[s.grips[k]]].gripped.push_back(local[s.grips[k]]);
    out[part[s.grips[k]]].grips.push_back(k);
  }
  for (Part& p : out) {
    // Rest positions count from the first vertex, so that parts far from the origin lose no digits in float32.
    for (std::size_t k = p.rest.size(); out.size() > 1 && k-- > 0;) p.rest[k] -= p.rest[k % 3];
    connect(p, s);
  }
  return out;
}

/// Whether two parts are copies of one sheet, so that one fabric serves both.
inline bool are_copies(const Part& a, const Part& b) {
  const auto near = [](double x, double y) { return x == y || std::abs(x - y) <= 1e-12 + 1e-9 * std::abs(x); };
  const auto alike = [&](const auto& e, const auto& f) { return near(e.spring_N_per_m, f.spring_N_per_m); };
  return a.triangles == b.triangles && a.pins == b.pins &&
         std::equal(a.mass.begin(), a.mass.end(), b.mass.begin(), b.mass.end(), near) &&
         std::equal(a.rest.begin(), a.rest.end(), b.rest.begin(), b.rest.end(), near) &&
         std::equal(a.edges.begin(), a.edges.end(), b.edges.begin(), b.edges.end(), alike);
}

}  // namespace clothbench::nvcloth
