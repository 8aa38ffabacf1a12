#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"

namespace clothbench::contact {
namespace {

/// Vertical cloth of side 1 in the plane z = `z`, its middle at height `y`.
Mesh curtain(int cells, double y, double z) { return sheet(cells, cells, {-0.5, y - 0.5, z}, {1, 0, 0}, {0, 1, 0}); }

/// A cloth that moves past a static mesh from pose to pose.
class Watched {
 public:
  Watched(const Mesh& object, const Mesh& cloth)
      : object_(object), tree_(object_.view()), links_(edges_of(cloth.triangles)), cloth_(cloth) {
    counts_.assign(cloth.positions.size() / 3, 0);
  }

  /// Fraction of vertices that are on a different side than at the start.
  double move(const Mesh& to) {
    contour_m_ = contour(to.view(), tree_).length_m;
    const auto step = proven_crossings(cloth_.positions, to.positions, object_.view(), tree_, links_);
    for (std::size_t i = 0; i < step.size(); ++i) counts_[i] += step[i];
    cloth_ = to;
    const auto through = std::count_if(counts_.begin(), counts_.end(), [](int n) { return n != 0; });
    return static_cast<double>(through) / static_cast<double>(counts_.size());
  }
  double contour_m() const { return contour_m_; }
  const std::vector<int>& counts() const { return counts_; }

 private:
  Mesh object_;
  TriangleTree tree_;
  std::vector<Link> links_;
  Mesh cloth_;
  std::vector<int> counts_;
  double contour_m_ = 0;
};

// If the curtain has an even number of cells, a row of its vertices lies in the plane of the patch. If the patch has an
// even number of cells, a curtain at z = 0 lies along edges of the patch.
TEST(Tunnel, CurtainLoweredHalfWayThroughAPatch) {
  for (const int cells : {31, 32, 33})
    for (const int patch_cells : {1, 2, 5, 8})
      for (const double z : {0.0, 0.013}) {
        Watched w(patch(patch_cells), curtain(cells, 0.7, z));
        w.move(curtain(cells, 0.2, z));
        // Special positions count as if the cloth were translated by (e, e^2, e^3): the row in the plane still counts
        // as above it, and the last column passes just outside the patch.
        const double rows = (cells + 1) / 2, columns = cells;
        EXPECT_NEAR(w.move(curtain(cells, 0, z)), rows * columns / ((cells + 1) * (cells + 1)), 1e-12);
        EXPECT_NEAR(w.contour_m(), 1, 1e-12) << cells << ' ' << patch_cells << ' ' << z;
        EXPECT_EQ(w.move(curtain(cells, 0.7, z)), 0);
        EXPECT_EQ(w.contour_m(), 0);
      }
}

TEST(Tunnel, RoundTheBorderAndBackCountsNothingButThroughAndRoundDoes) {
  const Mesh cloth = sheet(4, 4, {-0.1, 0, -0.1}, {0.2, 0, 0}, {0, 0, 0.2});
  const auto at = [&](double x, double y) { return cloth.moved({x, y, 0}); };
  Watched w(patch(8), at(0.01, 0.2));
  for (const auto& [x, y] : {std::pair{0.9, 0.2}, {0.9, -0.2}, {0.01, -0.2}}) EXPECT_EQ(w.move(at(x, y)), 0);
  EXPECT_EQ(w.move(at(0.01, 0.2)), 1);  // up through it
  for (const int n : w.counts()) EXPECT_EQ(n, 1);
  w.move(at(0.01, -0.2));
  w.move(at(0.01, -0.3));
  EXPECT_EQ(w.move(at(0.9, -0.3)), 0);
}

/// A cloth that slides off the patch: horizontal above, a quarter circle around its rim at x = 0.5, then vertical.
Mesh sliding_off(double slid) {
  constexpr double kAbove = 0.02;
  return sheet(8, 40, {-0.4, 0, -0.4}, {0, 0, 0.8}, {0.8, 0, 0}).mapped([=](const Point<3>& p) {
    const double beyond = p[0] + slid - 0.5, turn = std::min(beyond / kAbove, std::numbers::pi / 2);
    if (beyond <= 0) return Point<3>(0.5 + beyond, kAbove, p[2]);
    const double down = std::max(0.0, beyond - kAbove * std::numbers::pi / 2);
    return Point<3>(0.5 + kAbove * std::sin(turn), kAbove * std::cos(turn) - down, p[2]);
  });
}

// At 72 Hz and 7 m/s a vertex moves 97 mm per frame, so its straight path cuts through the rim that it moved around.
TEST(Tunnel, ClothThatSlidesOffARimHasNotTunnelled) {
  for (const double step : {0.097, 0.08}) {
    const Mesh object = patch(5);
    const TriangleTree tree(object.view());
    Mesh before = sliding_off(0);
    Watched w(object, before);
    int cuts = 0;
    for (double slid = 0; slid < 1.2; slid += step) {
      const Mesh now = sliding_off(slid);
      EXPECT_EQ(w.move(now), 0) << slid;
      EXPECT_EQ(w.contour_m(), 0) << slid;
      for (std::size_t v = 0; v < now.positions.size() / 3; ++v)
        cuts += signed_crossings(before.view().vertex(v), now.view().vertex(v), tree) != 0;
      before = now;
    }
    EXPECT_GT(cuts, 0) << "the paths do cut the rim";
  }
}

// The cloth is horizontal in every frame, so that no frame has a contour, and it is wider than the patch.
TEST(Tunnel, ALevelClothThatFallsThroughCounts) {
  const Mesh cloth = sheet(12, 12, {-0.8, 0, -0.8}, {0, 0, 1.6}, {1.6, 0, 0});
  Watched w(patch(5), cloth.moved({0, 0.3, 0}));
  double through = 0;
  for (double y = 0.3 - 0.047; y > -0.3; y -= 0.047) {
    through = w.move(cloth.moved({0, y, 0}));
    EXPECT_EQ(w.contour_m(), 0);
  }
  int inside = 0;
  for (std::size_t v = 0; v < cloth.positions.size() / 3; ++v) {
    const Point<3> p = cloth.view().vertex(v);
    inside += std::abs(p[0]) < 0.5 && std::abs(p[2]) < 0.5;
  }
  EXPECT_NEAR(through, inside / 169.0, 1e-12);
}

// The same motion between frames as before, but 10 cm inside the rim, so that the cloth passes through the patch.
TEST(Tunnel, ClothThatIsPulledThroughCounts) {
  Watched w(patch(5), sliding_off(0).moved({-0.1, 0, 0}));
  double last = 0;
  for (double slid = 0; slid < 1.2; slid += 0.097) last = w.move(sliding_off(slid).moved({-0.1, 0, 0}));
  EXPECT_GT(last, 0.9);
}

// All points are on a coarse lattice: paths go through vertices and edges, along triangles, or end on them.
TEST(Tunnel, LatticePathsThroughAClosedMeshKeepTheBalance) {
  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.add(Point<3>(i & 1 ? 2 : -2, i & 2 ? 2 : -2, i & 4 ? 2 : -2));
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const Mesh& object : {cube, unshared(cube)}) {
    const TriangleTree tree(object.view());
    std::mt19937 random(7);
    std::uniform_int_distribution<int> lattice(-3, 3);
    const auto point = [&] { return Point<3>(lattice(random), lattice(random), lattice(random)); };
    // Far outside, so that its side is certain.
    const Point<3> out(9, 5, -7);
    int inside_seen = 0;
    for (int trial = 0; trial < 3000; ++trial) {
      const Point<3> a = point(), b = point();
      const int out_a = signed_crossings(out, a, tree), a_b = signed_crossings(a, b, tree),
                b_out = signed_crossings(b, out, tree);
      ASSERT_EQ(out_a + a_b + b_out, 0) << a.transpose() << " -> " << b.transpose();
      ASSERT_EQ(a_b, -signed_crossings(b, a, tree));
      // Translated a little along +x, then +y, then +z, a lattice point is inside if it is in [-2, 2).
      const bool inside = (a.array() >= -2).all() && (a.array() < 2).all();
      ASSERT_EQ(out_a, inside ? -1 : 0) << a.transpose();
      inside_seen += inside;
    }
    EXPECT_GT(inside_seen, 500);
  }
}

// However a closed mesh rotates, deforms and jumps, a point is inside at the end if and only if it has crossed inwards
// once more than outwards.
TEST(Tunnel, ClosedMeshThatTurnsAndDeforms) {
  const Mesh cloth = sheet(20, 20, {-0.5, -0.5, 0.01}, {1, 0, 0}, {0, 1, 0});
  const Mesh ball = octasphere(8, 0.3);
  for (const Mesh& object : {ball, unshared(ball)}) {
    Mesh before = object.moved({0, 0, 1});
    std::vector<int> counts(cloth.positions.size() / 3, 0);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    int inside_seen = 0;
    for (int step = 0; step < 12; ++step) {
      const Point<3> centre(0.3 * unit(random), 0.3 * unit(random), 0.4 * unit(random));
      const double angle = 3 * unit(random), stretch = 1 + 0.4 * unit(random);
      const Mesh moved = object.mapped([&](const Point<3>& p) {
        return Point<3>(centre + Eigen::AngleAxisd(angle, Point<3>(1, 1, 0).normalized()) *
                                     p.cwiseProduct(Point<3>(stretch, 1, 1)));
      });
      const SweptMesh swept(before.view(), moved.view(), welded_vertices(before.view()));
      const TriangleTree tree(moved.view());
      for (std::size_t i = 0; i < counts.size(); ++i) {
        const Point<3> p = cloth.view().vertex(i);
        counts[i] += swept.signed_crossings(p, p);
        const bool inside = is_inside(p, tree);
        ASSERT_EQ(counts[i], inside ? -1 : 0) << step << ' ' << i;
        inside_seen += inside;
      }
      before = moved;
    }
    EXPECT_GT(inside_seen, 100);
  }
}

// Space-time on a lattice: vertices of the mesh move through the cloth's vertices and end on them.
TEST(Tunnel, MovingLatticeMeshKeepsTheBalance) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> lattice(-3, 3);
  const auto point = [&] { return Point<3>(lattice(random), lattice(random), lattice(random)); };
  const Mesh octahedron = octasphere(1, 2).mapped([](const Point<3>& p) { return Point<3>(p.array().round()); });
  const auto welded = welded_vertices(octahedron.view());
  for (int trial = 0; trial < 800; ++trial) {
    const Mesh from = octahedron.moved(point()), to = octahedron.moved(point());
    const SweptMesh swept(from.view(), to.view(), welded);
    const TriangleTree before(from.view()), after(to.view());
    const Point<3> p = point(), q = point(), out(20, 9, 7);
    const int inside_before = -signed_crossings(out, p, before), inside_after = -signed_crossings(out, q, after);
    // Crossings are signed by the outward normals.
    ASSERT_EQ(-swept.signed_crossings(p, q), inside_after - inside_before) << trial;
  }
}

}  // namespace
}  // namespace clothbench::contact
