#include <algorithm>
#include <cmath>

#include "clothbench/vector.hpp"
#include "render/framing.hpp"

namespace clothbench::render {
namespace {

using Triangle = std::array<Vec3, 3>;

/// Whether a half-line meets a triangle (Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997).
bool meets(const Vec3& from, const Vec3& along, const Triangle& t) {
  const Vec3 u = minus(t[1], t[0]), v = minus(t[2], t[0]), p = cross(along, v), s = minus(from, t[0]), q = cross(s, u);
  const double area = dot(u, p), a = dot(s, p) / area, b = dot(along, q) / area;
  return a >= 0 && b >= 0 && a + b <= 1 && dot(v, q) / area > 0;  // in its plane: NaN, not met
}

/// A point of the cloth, and the piece of cloth it stands for as a vector across it [m^2].
struct Sample {
  Vec3 at, area;
};

/// Every so many triangles of a mesh, each for as many.
void add_samples(const ClothMesh& mesh, const std::vector<double>& x, const Bounds& near, std::vector<Sample>& out) {
  constexpr std::size_t kSome = 80;
  const std::size_t step = mesh.triangles.size() / kSome + 1;
  for (std::size_t k = 0; k < mesh.triangles.size(); k += step) {
    const auto corner = [&](std::size_t c) {
      const std::size_t v = 3 * std::size_t{mesh.triangles[k][c]};
      return Vec3{x[v], x[v + 1], x[v + 2]};
    };
    const Vec3 a = corner(0), b = corner(1), c = corner(2), area = cross(minus(b, a), minus(c, a));
    Sample s{};
    for (std::size_t i = 0; i < 3; ++i) {
      s.at[i] = (a[i] + b[i] + c[i]) / 3;
      s.area[i] = area[i] / 2 * static_cast<double>(step);
    }
    if (near.holds(s.at) && std::isfinite(dot(s.area, s.area))) out.push_back(s);
  }
}

std::vector<Sample> samples(const Motion& m, std::span<const std::size_t> frames, const Bounds& near) {
  constexpr std::size_t kFrames = 12, kAcross = 9;
  std::vector<Sample> out;
  const std::size_t columns = m.scene.cloth.columns, rows = m.scene.cloth.rows,
                    step = std::max(columns, rows) / kAcross + 1;
  for (std::size_t k = 0; k < std::min(kFrames, frames.size()); ++k) {
    const std::vector<double> x = m.at(frames[k * frames.size() / std::min(kFrames, frames.size())]);
    if (m.scene.cloth.mesh) {
      add_samples(*m.scene.cloth.mesh, x, near, out);
      continue;
    }
    const auto vertex = [&](std::size_t i, std::size_t j) {
      const std::size_t v = 3 * (j * columns + i);
      return Vec3{x[v], x[v + 1], x[v + 2]};
    };
    for (std::size_t j = 0; j + step < rows; j += step)
      for (std::size_t i = 0; i + step < columns; i += step) {
        const Sample s = {vertex(i + step / 2, j + step / 2),
                          cross(minus(vertex(i + step, j), vertex(i, j)), minus(vertex(i, j + step), vertex(i, j)))};
        if (near.holds(s.at) && std::isfinite(dot(s.area, s.area))) out.push_back(s);
      }
  }
  return out;
}

}  // namespace

double best_turn(const Motion& m, std::span<const std::size_t> frames, const Bounds& near) {
  constexpr double kQuarter_deg = 90, kWorthIt = 1.2,
                   kClear = 0.02;  // kClear: of the sheet, what a cloth lies on does not hide it
  if (frames.empty() || !m.scene.motion.empty()) return 0;
  const Surfaces drawn = surfaces(m.scene, static_cast<int>(frames[0]), near);
  if (drawn.triangles.empty()) return 0;
  std::vector<Triangle> hiding;
  for (const auto& t : drawn.triangles)
    hiding.push_back({drawn.position_m[t[0]], drawn.position_m[t[1]], drawn.position_m[t[2]]});
  const std::vector<Sample> cloth = samples(m, frames, near);
  const double clear = kClear * std::max(m.scene.cloth.width_m, m.scene.cloth.height_m);
  double best = 0, most = 0;
  for (double turn = 0; turn < 360; turn += kQuarter_deg) {
    const Vec3 eye = towards_eye(View::Corner, turn);
    double seen = 0;
    for (const Sample& s : cloth) {
      const Vec3 from = {s.at[0] + clear * eye[0], s.at[1] + clear * eye[1], s.at[2] + clear * eye[2]};
      if (std::none_of(hiding.begin(), hiding.end(), [&](const Triangle& t) { return meets(from, eye, t); }))
        seen += std::abs(dot(s.area, eye));
    }
    if (seen > (turn == 0 ? 0 : best == 0 ? kWorthIt * most : most)) best = turn, most = seen;
  }
  return best;
}

}  // namespace clothbench::render
