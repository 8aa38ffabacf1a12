#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "base/json_text.hpp"
#include "scenario/cloth_mesh.hpp"

namespace clothbench {
namespace {

using Point = std::array<double, 2>;
using Triangle = std::array<std::uint32_t, 3>;

double twice_area(const std::vector<Point>& p, const Triangle& t) {
  return (p[t[1]][0] - p[t[0]][0]) * (p[t[2]][1] - p[t[0]][1]) - (p[t[1]][1] - p[t[0]][1]) * (p[t[2]][0] - p[t[0]][0]);
}

/// Integer coordinates make the test below exact. This matters, because four lattice points often lie on one circle.
using Exact = __int128;
using Place = std::array<std::int64_t, 2>;

/// Whether the circumcircle of a triangle contains point v. Coordinates below 2^29 do not overflow.
bool circle_holds(const std::vector<Place>& p, const Triangle& t, std::uint32_t v) {
  Exact m[3][3];
  for (std::size_t k = 0; k < 3; ++k) {
    m[k][0] = p[t[k]][0] - p[v][0];
    m[k][1] = p[t[k]][1] - p[v][1];
    m[k][2] = m[k][0] * m[k][0] + m[k][1] * m[k][1];
  }
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) >
         0;
}

/// Delaunay triangles of points that are not collinear, consistently wound. Omits triangles with less than a thousandth
/// of the area of a square of side `cell`: slivers along straight borders.
std::vector<Triangle> delaunay(const std::vector<Point>& p, double cell) {
  const auto n = static_cast<std::uint32_t>(p.size());
  constexpr std::int64_t kLongest = 1 << 22, kFar = 64 * kLongest;
  double longest = 0;
  for (const Point& at : p) longest = std::max({longest, at[0], at[1]});
  const auto place = [&](double x) { return std::llround(x / longest * kLongest); };
  std::vector<Place> places;
  for (const auto& [x, y] : p) places.push_back({place(x), place(y)});
  for (const auto& corner : {Place{-kFar, -kFar}, {kFar, -kFar}, {0, kFar}}) places.push_back(corner);
  std::vector<Triangle> all = {{n, n + 1, n + 2}};
  for (std::uint32_t v = 0; v < n; ++v) {
    std::vector<std::array<std::uint32_t, 2>> rim;  // directed edges of the hole
    std::vector<Triangle> left;
    for (const Triangle& t : all) {
      if (!circle_holds(places, t, v)) {
        left.push_back(t);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<std::uint32_t, 2> edge = {t[k], t[(k + 1) % 3]}, back = {edge[1], edge[0]};
        if (const auto twin = std::find(rim.begin(), rim.end(), back); twin != rim.end())
          rim.erase(twin);
        else
          rim.push_back(edge);
      }
    }
    for (const auto& [a, b] : rim) left.push_back({a, b, v});
    all = std::move(left);
  }
  std::erase_if(all, [&](const Triangle& t) {
    return *std::max_element(t.begin(), t.end()) >= n || twice_area(p, t) < 2e-3 * cell * cell;
  });
  return all;
}

int rows_of(const DrawnSheet& d) {
  return std::max(1, static_cast<int>(std::lround(d.height_m / (d.width_m / d.cells))));
}

std::vector<Point> drawn_points(const DrawnSheet& d) {
  std::mt19937 random(d.seed);
  // Not std::uniform_real_distribution, which differs between libraries.
  const auto draw = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
  const double cell = d.width_m / d.cells;
  const int rows = rows_of(d);
  std::vector<Point> p;
  for (int i = 0; i <= d.cells; ++i)
    for (int j = 0; j <= rows; ++j)
      if (i == 0 || j == 0 || i == d.cells || j == rows)
        p.push_back({i == d.cells ? d.width_m : i * cell, d.height_m * j / rows});
  for (int j = 0; d.clamp && j < rows; ++j) p.push_back({cell, d.height_m * (j + 0.5) / rows});
  const double first = d.clamp ? cell : 0;
  const int far = 2 * std::max(d.cells, rows);
  const double c = std::cos(d.angle_rad), s = std::sin(d.angle_rad);
  for (int i = -far; i <= far; ++i)
    for (int j = -far; j <= far; ++j) {
      const double u = (i + 0.3) * cell, v = (j + 0.4) * cell;
      const double x = d.width_m / 2 + c * u - s * v + d.share * cell * draw(),
                   y = d.height_m / 2 + s * u + c * v + d.share * cell * draw();
      if (std::min({x - first, y, d.width_m - x, d.height_m - y}) > 0.45 * cell) p.push_back({x, y});
    }
  return p;
}

}  // namespace

ClothMesh drawn_mesh(const DrawnSheet& d) {
  const std::vector<Point> p = drawn_points(d);
  const double cell = d.width_m / d.cells;
  const std::vector<Triangle> sheet = delaunay(p, cell);
  std::vector<Vec3> at;
  std::vector<Triangle> triangles;
  for (int i = 0; i < d.copies[0]; ++i)
    for (int j = 0; j < d.copies[1]; ++j) {
      const auto first = static_cast<std::uint32_t>(at.size());
      const double right = (i - 0.5 * (d.copies[0] - 1)) * d.apart_m[0],
                   forward = (j - 0.5 * (d.copies[1] - 1)) * d.apart_m[1];
      for (const auto& [x, y] : p) at.push_back({x + right, y, forward});
      for (const auto& [a, b, c] : sheet) triangles.push_back({first + a, first + b, first + c});
    }
  const auto vertices = static_cast<std::uint32_t>(at.size());
  ClothMesh mesh = cloth_mesh({std::move(at), std::move(triangles)}, "a drawn sheet");
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const auto& [x, y] = p[v % p.size()];
    if (d.clamp && x <= cell) mesh.groups["clamp"].push_back(v);
    if (x == 0) mesh.groups["u0"].push_back(v);
    if (x == d.width_m) mesh.groups["u1"].push_back(v);
    if (y == 0) mesh.groups["v0"].push_back(v);
    if (y == d.height_m) mesh.groups["v1"].push_back(v);
  }
  return mesh;
}

ClothMesh read_drawn_mesh(const nlohmann::json& j, const std::string& source) {
  constexpr double kMost = 20000, kMostOfAll = 1.1e7;
  DrawnSheet d;
  d.width_m = j["size_m"][0].get<double>();
  d.height_m = j["size_m"][1].get<double>();
  d.cells = j["cells"].get<int>();
  d.angle_rad = j.value("turned_deg", 0.0) * std::numbers::pi / 180;
  d.share = j.value("share", 0.0);
  d.seed = j.value("seed", 1u);
  d.clamp = j.value("clamp", false);
  d.copies = j.value("copies", d.copies);
  d.apart_m = j.value("apart_m", d.apart_m);
  if ((d.copies[0] > 1 && !(d.apart_m[0] > d.width_m)) || (d.copies[1] > 1 && !(d.apart_m[1] > 0)))
    refuse(source, "/cloth/mesh/drawn/apart_m",
           fmt::format("expected more than the width ({} m) between copies along u, and more than 0 along the normal",
                       d.width_m));
  const double vertices = (d.cells + 1.0) * (d.height_m / d.width_m * d.cells + 1);
  if (!(vertices <= kMost))
    refuse(source, "/cloth/mesh/drawn/cells",
           fmt::format("expected a sheet of at most {:.0f} vertices; it would have {:.0f}", kMost, vertices));
  if (const double all = vertices * d.copies[0] * d.copies[1]; !(all <= kMostOfAll))
    refuse(source, "/cloth/mesh/drawn/copies",
           fmt::format("expected at most {:.0f} vertices in all copies; there would be {:.0f}", kMostOfAll, all));
  ClothMesh mesh = drawn_mesh(d);
  for (Vec3& at : mesh.vertices) {
    at[0] -= d.width_m / 2;
    at[1] -= d.height_m / 2;
  }
  return mesh;
}

}  // namespace clothbench
