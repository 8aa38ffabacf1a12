// Cloths whose links differ: how chains are laid out, and their motion against a reference in double precision.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "gpu_fixture.hpp"
#include "mesh_scene.hpp"
#include "scenario/load.hpp"
#include "xpbd/constraints.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Ends = std::pair<std::uint32_t, std::uint32_t>;

std::vector<ChainColour> plan_of(const Scene& s, const ChainCloth& cloth, std::uint32_t block) {
  return colours_of(edge_paths(s, cloth), s.cloth.vertex_count(), block);
}

/// Links of every chain; also checks that no vertex is on two chains of a colour.
std::multiset<Ends> links_of(const std::vector<ChainColour>& colours, std::size_t vertices, std::uint32_t block) {
  std::multiset<Ends> out;
  for (const ChainColour& f : colours) {
    std::vector<int> seen(vertices, 0);
    for (const auto& [chain, colour, share] : f.chains) {
      EXPECT_GE(chain.size(), 2u);
      EXPECT_LE(chain.size(), block);
      for (const std::uint32_t v : chain) EXPECT_EQ(++seen[v], 1) << v;
      for (std::size_t k = 1; k < chain.size(); ++k) out.insert(std::minmax(chain[k - 1], chain[k]));
    }
  }
  return out;
}

TEST(ChainPlan, HasEveryLinkOnceAndNoVertexTwiceInAFamily) {
  for (const Scene& s :
       {mesh_sheet(9), mesh_sheet(20), mesh_tube(12, 7), uneven(sheet(17, 9), 4, 0.3), uneven(sheet(40, 3), 4, 0.3)})
    for (const std::uint32_t block : {4u, 16u, 256u}) {
      const ChainCloth cloth = chain_cloth(s);
      std::multiset<Ends> wanted;
      for (const ChainCloth::Link& l : cloth.links) wanted.insert({l.a, l.b});
      EXPECT_EQ(links_of(plan_of(s, cloth, block), s.cloth.vertex_count(), block), wanted)
          << s.cloth.columns << " " << block;
    }
}

TEST(ChainPlan, WeldsSliversAndAddsUpWhatBecomesParallel) {
  const Scene wide = uneven(sheet(17, 9), 4, 0.3), thin = uneven(sheet(17, 9), 4, 1e-3);
  EXPECT_TRUE(chain_cloth(wide).welded.empty());
  const ChainCloth cloth = chain_cloth(thin);
  EXPECT_EQ(cloth.welded.size(), 9u) << "one vertex per row";
  EXPECT_EQ(cloth.particle[5], 4u);
  const auto whole = [](const Scene& s) {
    std::map<std::uint32_t, double> stiffness;  // of the links that leave row 0, by column
    for (const ChainCloth::Link& l : chain_cloth(s).links)
      if (l.a < 17 && l.b >= 17) stiffness[0] += 1 / static_cast<double>(l.compliance_m_per_N);
    return stiffness[0];
  };
  EXPECT_GT(whole(thin), whole(uneven(sheet(17, 9), 4, 1)))
      << "diagonals of a sliver are stiff, and so are the links that they become";
  for (const ChainColour& f : plan_of(thin, cloth, 256))
    for (const EdgePath& chain : f.chains)
      for (const std::uint32_t v : chain.vertices) EXPECT_EQ(cloth.particle[v], v);
}

TEST(TetherTable, ReachesAsFarAsTheClothIsWide) {
  Scene s = mesh_sheet(9);
  s.material.membrane_stiffness_N_per_m.reset();
  const TetherTable t = tether_table(s);
  ASSERT_EQ(t.a_vertex, 2u) << "two corners: " << t.reason;
  for (std::uint32_t v = 0; v < s.cloth.vertex_count(); ++v)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const TetherEnd& e = t.ends[2 * v + k];
      const Vec3 &a = s.cloth.mesh->vertices[v], &b = s.cloth.mesh->vertices[e.to];
      EXPECT_NEAR(e.reach, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 1e-6) << "straight in a convex sheet";
    }
  Scene tube = mesh_tube(16, 8);
  tube.material.membrane_stiffness_N_per_m.reset();
  tube.pins.vertices = {0};
  tube.needs.add(Feature::Pins);
  const TetherTable round = tether_table(tube);
  ASSERT_EQ(round.a_vertex, 1u);
  const double half_way = std::numbers::pi * 0.2;  // the radius is 0.2 m
  EXPECT_GT(round.ends[8].reach, 0.98 * half_way) << "around the tube, not through it";
  EXPECT_LT(round.ends[8].reach, 1.01 * half_way);
}

class Chained : public Gpu {
 protected:
  static double distance(const ClothState& a, const ClothState& b) {
    double most = 0;
    for (std::size_t k = 0; k < a.position.size(); ++k) {
      const double d = std::abs(a.position[k] - b.position[k]);
      most = d <= most ? most : d;
    }
    return most;
  }
};

TEST_F(Chained, MeshesAndUnevenGridsEndWhereTheReferenceDoes) {
  Scene mesh = with_damping(mesh_sheet(8)), grid = with_damping(with_pins(uneven(sheet(9, 7), 3, 0.3)));
  for (Scene* s : {&mesh, &grid}) {
    s->time = {60, 0.5};
    s->material.membrane_stiffness_N_per_m = 300;
    const ClothState right = end_of(*s, "reference", {{"substeps", 80}});
    const auto error = [&](int order, int substeps) {
      return distance(end_of(*s, "xpbd", {{"time_order", order}, {"substeps", substeps}, {"tethers", false}}), right);
    };
    const double coarse = error(1, 40), fine = error(1, 160);
    EXPECT_LT(fine, 4e-3) << s->cloth.rows;
    EXPECT_LT(fine, 0.4 * coarse) << "the error is of first order in the substep";
    // At second order, rounding in single precision is as large as the error with 160 substeps.
    EXPECT_LT(error(2, 40), 5e-4) << s->cloth.rows;
    EXPECT_LT(error(2, 160), 5e-4) << s->cloth.rows;
  }
}

TEST_F(Chained, RepeatBitForBitAndFallFreely) {
  Scene s = mesh_sheet(20);
  s.material.membrane_stiffness_N_per_m.reset();  // links only: elastic sheets would use triangles
  EXPECT_EQ(end_of(s, "xpbd", {}).position, end_of(s, "xpbd", {}).position);
  s = uneven(sheet(20, 20), 4, 0.3);
  const std::vector<double> start = initial_positions(s);
  const ClothState fallen = end_of(s, "xpbd", {});
  const double fall = xpbd_free_fall_m(s, complete_settings(xpbd_info(), {}), s.time.frames());
  for (std::size_t k = 0; k < start.size(); ++k)
    EXPECT_NEAR(fallen.position[k], start[k] + (k % 3 == 1 ? fall : 0), 2e-6 * std::abs(fall)) << k;
}

/// Many sheets in one mesh cost what one costs, and do not disturb one another.
TEST_F(Chained, CopiesOfASheetMoveAsItDoes) {
  const auto sheets = [](const char* stiffness, const char* copies) {
    return load_scene("validation/hang-mesh",
                      {std::string("material.membrane_stiffness_N_per_m=") + stiffness,
                       R"(cloth.mesh={"drawn":{"size_m":[1,1],"cells":15,"share":0.2)" + std::string(copies) + "}}",
                       R"(pins=[{"group":"v1"}])", "time.duration_s=0.25"});
  };
  for (const char* stiffness : {"inextensible", "100"}) {
    const Scene one = sheets(stiffness, ""), all = sheets(stiffness, R"(,"copies":[3,2],"apart_m":[1.5,0.25])");
    const nlohmann::json settings = nlohmann::json::object();
    EXPECT_EQ(xpbd_substeps(all, settings), xpbd_substeps(one, settings)) << stiffness;
    const ClothState a = end_of(one, "xpbd", {}), b = end_of(all, "xpbd", {});
    const std::vector<double> from = initial_positions(one), to = initial_positions(all);
    for (std::size_t k = 0; k < b.position.size(); ++k)
      ASSERT_NEAR(b.position[k] - to[k], a.position[k % from.size()] - from[k % from.size()], 5e-3) << stiffness;
  }
}

TEST_F(Chained, SliversDoNotThrowWhatHangsOnThem) {
  for (const double factor : {0.1, 0.03, 1e-3, 1e-6, 0.0}) {
    Scene s = with_pins(uneven(sheet(17, 17), 8, factor));
    s.pins.vertices.clear();
    for (std::uint32_t j = 0; j < 17; ++j) {
      s.pins.vertices.push_back(17 * j);
      s.pins.vertices.push_back(17 * j + 16);
    }
    const ClothState end = end_of(s, "xpbd", {});
    for (std::uint32_t j = 0; j < 17; ++j) {
      const auto at = [&](std::uint32_t i, std::size_t k) { return end.position[3 * (17 * j + i) + k]; };
      const double gap = std::hypot(at(9, 0) - at(8, 0), at(9, 1) - at(8, 1), at(9, 2) - at(8, 2)),
                   rest = s.cloth.line_u_m(9) - s.cloth.line_u_m(8);
      EXPECT_LE(gap, 1.1 * rest + 1e-9) << factor << ", row " << j;
    }
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
