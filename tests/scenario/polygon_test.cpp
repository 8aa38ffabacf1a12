// Polygons cut into triangles: drawn from seeds, and those that are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "clothbench/error.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scratch_folder.hpp"

namespace clothbench {
namespace {

using Polygon = std::vector<Vec3>;

/// Half the sum of cross products: the area of whatever surface the polygon bounds, seen along its normal.
Vec3 area_vector(const Polygon& p) {
  Vec3 sum{};
  for (std::size_t k = 0; k < p.size(); ++k)
    sum = plus(sum, cross(minus(p[k], p[0]), minus(p[(k + 1) % p.size()], p[0])));
  return scaled(0.5, sum);
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  std::size_t below(std::size_t n) { return random_() % n; }

  /// A star-shaped polygon, mostly concave, in the plane z = 0.
  Polygon star(std::size_t corners) {
    Polygon p;
    for (std::size_t k = 0; k < corners; ++k) {
      const double angle =
          2 * std::numbers::pi * (static_cast<double>(k) + between(0, 0.9)) / static_cast<double>(corners);
      const double r = between(0.1, 1);
      p.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
    return p;
  }

  /// The outline of a row of columns: right angles, and corners in the middle of straight sides.
  Polygon skyline(std::size_t columns) {
    Polygon p = {{0, 0, 0}};
    for (std::size_t k = 0; k < columns; ++k) p.push_back({static_cast<double>(k + 1), 0, 0});
    for (std::size_t k = columns; k > 0; --k) {
      const double height = static_cast<double>(1 + below(4));
      p.push_back({static_cast<double>(k), height, 0});
      p.push_back({static_cast<double>(k) - 0.5, height, 0});
      p.push_back({static_cast<double>(k - 1), height, 0});
    }
    return p;
  }

  /// Turned, moved, scaled, and begun at another corner.
  Polygon anywhere(Polygon p) {
    std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(below(p.size())), p.end());
    const double a = between(0, 6), b = between(0, 6), size = std::pow(10, between(-3, 3));
    for (Vec3& x : p) {
      x = {std::cos(a) * x[0] - std::sin(a) * x[1], std::sin(a) * x[0] + std::cos(a) * x[1], x[2]};
      x = {x[0], std::cos(b) * x[1] - std::sin(b) * x[2], std::sin(b) * x[1] + std::cos(b) * x[2]};
      x = plus(scaled(size, x), {size, -2 * size, 0.5 * size});
    }
    return p;
  }

  /// Some corners once more, right after themselves.
  Polygon repeated(const Polygon& p) {
    Polygon out;
    for (const Vec3& x : p)
      for (std::size_t n = 1 + below(2); n > 0; --n) out.push_back(x);
    return out;
  }

 private:
  std::mt19937 random_;
};

/// That triangles are two fewer than the different corners and wound as the polygon is. Together they have its area,
/// seen along the same axis: as none has a negative one, none is outside and none lies on another.
void expect_cut(const Polygon& p) {
  constexpr double kRounding = 1e-12;
  std::size_t different = 0;
  for (std::size_t k = 0; k < p.size(); ++k) different += p[k] != p[(k + 1) % p.size()] ? 1 : 0;
  const Vec3 normal = area_vector(p);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  const auto triangles = triangulated(p, "a polygon");
  EXPECT_EQ(triangles.size(), different - 2);
  std::set<std::uint32_t> used;
  double sum = 0;
  for (const auto& t : triangles) {
    const Vec3 &a = p.at(t[0]), &b = p.at(t[1]), &c = p.at(t[2]), area = area_vector({a, b, c});
    const double share = area[axis] / normal[axis];
    EXPECT_GT(share, 0);
    EXPECT_GT(length(area) / std::pow(std::max({length(minus(a, b)), length(minus(b, c)), length(minus(c, a))}), 2),
              1e-9)
        << "a cloth would be refused for it";
    sum += share;
    used.insert(t.begin(), t.end());
  }
  EXPECT_EQ(used.size(), different);
  if (!(std::abs(sum - 1) <= kRounding)) ADD_FAILURE() << sum << " of the polygon's area";
}

TEST(Polygon, IsCutInside) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const std::size_t corners = 4 + draw.below(40);
    expect_cut(draw.anywhere(draw.star(corners)));
    const std::size_t columns = 1 + draw.below(8);
    expect_cut(draw.skyline(columns));
    expect_cut(draw.anywhere(draw.skyline(columns)));
    Polygon twice = draw.anywhere(draw.star(corners));
    expect_cut(draw.repeated(twice));
    std::reverse(twice.begin(), twice.end());
    expect_cut(twice);
  }
}

TEST(Polygon, NeedNotBeFlat) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    Polygon p = draw.star(4 + draw.below(12));
    for (Vec3& x : p) x[2] = draw.between(-0.05, 0.05);
    expect_cut(p);
  }
}

TEST(Polygon, ADartHasItsOwnArea) { expect_cut({{0, -3, 0}, {0.5, 1, 0}, {0, 0.5, 0}, {-0.5, 1, 0}}); }

TEST(Polygon, ThatIsNoneIsRefused) {
  const auto why = [](const Polygon& p) { return refusal([&] { triangulated(p, "m.obj: line 3"); }); };
  EXPECT_EQ(why({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), "m.obj: line 3: a face that has no area");
  EXPECT_EQ(why({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}), "m.obj: line 3: a face that has no area");
  EXPECT_EQ(why(Polygon(5, {1, 2, 3})), "m.obj: line 3: a face that has no area");
  const char* crosses = "m.obj: line 3: the outline of the face crosses or touches itself";
  EXPECT_EQ(why({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}}).find(crosses), 0u) << "a bow tie";
  EXPECT_EQ(why({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}).find(crosses), 0u) << "a corner on a side";
  EXPECT_EQ(why({{0, 0, 0}, {2, 0, 0}, {3, 0, 0}, {2, 0, 0}, {2, 2, 0}}).find(crosses), 0u) << "a spike";
  EXPECT_EQ(why({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}}).find(crosses), 0u);
  Draw draw(1);
  EXPECT_PRED2(mentions, why(draw.star(kMostCorners + 1)), "1001 corners; expected at most 1000");
  for (unsigned seed = 1; seed <= 300; ++seed) {
    // Two neighbouring corners on a circle change places: the sides before and after them cross.
    Draw other(seed);
    Polygon p = other.star(5 + other.below(20));
    for (Vec3& x : p) x = scaled(1 / length(x), x);
    std::swap(p[2], p[3]);
    EXPECT_EQ(why(other.anywhere(p)).find(crosses), 0u) << seed;
  }
}

}  // namespace
}  // namespace clothbench
