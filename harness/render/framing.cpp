#include "render/framing.hpp"

#include <algorithm>
#include <cmath>

#include "clothbench/vector.hpp"

namespace clothbench::render {
namespace {

constexpr double kSeenBeside = 0.12;  // of the sheet's size: so near the cloth colliders are in the picture,
constexpr double kDrawnBeside = 0.5;  // and so far are drawn

double largest(const Vec3& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

void append(std::vector<double>& points, const Vec3& p) { points.insert(points.end(), p.begin(), p.end()); }

Bounds bounds_of(std::span<const double> x) {
  Bounds b = Bounds::none();
  for (std::size_t v = 0; v < x.size() / 3; ++v)
    if (const Vec3 p = vertex_at(x, v); std::isfinite(p[0] + p[1] + p[2])) b.add(p);
  return b;
}

/// All corners of a box, so that a flat one counts as it lies.
void append(std::vector<double>& points, const Bounds& b) {
  for (unsigned k = 0; k < 8; ++k)
    append(points, Vec3{k & 1u ? b.high[0] : b.low[0], k & 2u ? b.high[1] : b.low[1], k & 4u ? b.high[2] : b.low[2]});
}

}  // namespace

Framing framing_of(const Motion& m, std::span<const std::size_t> frames) {
  Framing f;
  const Cloth& cloth = m.scene.cloth;
  const double size = std::max({cloth.width_m, cloth.height_m, 1e-9});
  const std::vector<double> start = m.at(0);
  Bounds place = bounds_of(start);
  if (place.empty()) place.add({0, 0, 0});
  Bounds zone = place;
  zone.grow(size);
  const auto middle = static_cast<std::uint32_t>((cloth.rows / 2) * cloth.columns + cloth.columns / 2);
  if (!m.held)
    for (const std::size_t k : frames)
      if (largest(minus(vertex_at(m.at(k), middle), vertex_at(start, middle))) > size) f.followed = middle;

  Bounds seen = Bounds::none();
  for (const std::size_t k : frames) {
    const std::vector<double> x = m.at(k);
    const Vec3 moved = f.followed ? minus(vertex_at(x, middle), vertex_at(start, middle)) : Vec3{};
    for (std::size_t v = 0; v < cloth.vertex_count(); ++v) {
      const Vec3 p = minus(vertex_at(x, v), moved);
      if (!zone.holds(p)) continue;
      append(f.points, p);
      seen.add(p);
    }
  }
  if (seen.empty()) {
    seen = place;
    append(f.points, place);
  }
  f.near = seen;
  f.near.grow(kDrawnBeside * size);
  f.origin_m = scaled(0.5, plus(seen.low, seen.high));
  Bounds beside = seen;
  beside.grow(kSeenBeside * size);
  // Static objects are the same in every frame.
  const bool moves = !m.scene.motion.empty();
  for (std::size_t i = 0; i < (moves ? frames.size() : std::min<std::size_t>(1, frames.size())); ++i)
    for (const Vec3& p : surfaces(m.scene, static_cast<int>(frames[i]), f.near).position_m)
      if (beside.holds(p)) append(f.points, p);
  f.turn_deg = best_turn(m, frames, f.near);
  return f;
}

std::vector<std::size_t> framed_by(const Motion& m, std::span<const std::size_t> wanted) {
  constexpr std::size_t kSome = 48;
  std::vector<std::size_t> out(wanted.begin(), wanted.end());
  if (!m.held) return out;
  for (std::size_t k = 0; k < kSome; ++k) out.push_back(k * (m.frames() - 1) / (kSome - 1));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace clothbench::render
