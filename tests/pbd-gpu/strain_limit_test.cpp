// material.strain_limit: links of a heavy elastic cloth stretch up to it and no further.
#include <algorithm>
#include <cmath>

#include "drawn_sheet.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr double kLimit = 0.05;

struct Strains {
  double mean = 0;  ///< of the way of the lower border, over the cloth's length
  double most = -1;
};

class StrainLimit : public Gpu {
 protected:
  /// Hangs along x from what is pinned at its upper border; without a limit it would be a fifth longer.
  static Scene heavy(Scene s, std::optional<double> limit) {
    s = with_damping(std::move(s));
    s.material.damping_per_s = 5;
    s.material.membrane_stiffness_N_per_m = 5;
    s.material.strain_limit = limit;
    if (limit) s.needs.add(Feature::StrainLimit);
    s.gravity_m_per_s2 = {9.81, 0, 0};
    s.time = {60, 1.5};
    return s;
  }
  static Scene heavy_grid(int columns, int rows, std::optional<double> limit) {
    Scene s = sheet(columns, rows, 1, 0.5);
    s.pins.vertices = edge_vertices(s.cloth, "u0");
    s.needs.add(Feature::Pins);
    return heavy(std::move(s), limit);
  }

  /// Of the last half of the scene.
  static Strains strains(const Scene& s, const nlohmann::json& settings = nlohmann::json::object()) {
    const auto solver = make("xpbd", settings);
    solver->load(s);
    const std::vector<double> start = initial_positions(s);
    double far = -1;
    for (std::size_t k = 0; k < start.size(); k += 3) far = std::max(far, start[k]);
    Strains out;
    for (int f = 0; f < s.time.frames(); ++f) {
      const std::vector<double> x = after_frame(*solver, s, f).position;
      if (2 * f < s.time.frames()) continue;
      for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
        const double* a = &x[3 * std::size_t{e.a}];
        const double* b = &x[3 * std::size_t{e.b}];
        const double strain = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / e.rest_m - 1;
        if (!(strain <= out.most)) out.most = strain;
      }
      double way = 0, count = 0;
      for (std::size_t k = 0; k < start.size(); k += 3)
        if (start[k] > far - 1e-6) {
          way += x[k] - start[k];
          count += 1;
        }
      out.mean = way / count;
    }
    return out;
  }
};

// Exact: strain rises with the weight below, 0.392 a metre, up to the limit.
constexpr double kTop = 0.2 * 9.81 / 5, kSoft_m = kLimit / kTop;
constexpr double kMean = kLimit * (1 - kSoft_m) + kTop * kSoft_m * kSoft_m / 2;

void expect_held(const Strains& found, const std::string& what, double share = 1.04) {
  EXPECT_LE(found.most, share * kLimit) << what;
  EXPECT_GE(found.most, 0.99 * kLimit) << what;
  EXPECT_NEAR(found.mean / kMean, 1, 0.03) << what;
}

TEST_F(StrainLimit, HoldsOnGrids) {
  EXPECT_GE(strains(heavy_grid(17, 9, {})).mean, 0.17) << "the cloth is not heavy";
  for (const int n : {17, 33}) expect_held(strains(heavy_grid(n, n / 2 + 1, kLimit)), std::to_string(n) + " columns");
}

TEST_F(StrainLimit, HoldsOnDrawnMeshes) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Scene s = heavy(drawn_sheet(1, 0.5, 12, 0.4 * seed, 0.3, seed), kLimit);
    expect_held(strains(s), "triangles, seed " + std::to_string(seed));
    // Springs along edges, as of cloth that touches, which takes more substeps.
    expect_held(strains(s, {{"substeps", 16}, {"tuning", {{"membrane", "never"}}}}),
                "springs, seed " + std::to_string(seed));
  }
}

/// Links hold by themselves, without tethers. Where the border of a mesh then hangs is not exact (CHAINS.md).
TEST_F(StrainLimit, HoldsWithoutTethers) {
  const nlohmann::json settings = {{"tethers", false}, {"substeps", 16}};
  expect_held(strains(heavy_grid(17, 9, kLimit), settings), "a grid", 1.06);
  const Strains mesh = strains(heavy(drawn_sheet(1, 0.5, 12, 0.4, 0.3, 4), kLimit), settings);
  EXPECT_LE(mesh.most, 1.06 * kLimit);
  EXPECT_NEAR(mesh.mean / kMean, 1, 0.12);
}

TEST_F(StrainLimit, PlansSayWhatItCosts) {
  const Scene without = heavy(drawn_sheet(1, 0.5, 8, 0.4, 0.3, 4), {});
  const Scene with = heavy(drawn_sheet(1, 0.5, 8, 0.4, 0.3, 4), kLimit);
  const auto dispatches = [](const Scene& s) {
    const auto solver = make("xpbd", {{"substeps", 4}, {"tuning", {{"device_barrier", "never"}}}});
    solver->load(s);
    for (const StagePlan& stage : solver->plan().stages)
      if (stage.serves.has(Feature::Stretch)) {
        EXPECT_EQ(stage.serves.has(Feature::StrainLimit), s.material.strain_limit.has_value());
        return stage.dispatches;
      }
    return -1;
  };
  EXPECT_GT(dispatches(with), dispatches(without)) << "families of links come after the triangles";
}

TEST_F(StrainLimit, IsRefusedWhereItCannotBe) {
  const auto solver = make("xpbd");
  try {
    solver->load(with_bending(heavy_grid(9, 5, kLimit)));
    ADD_FAILURE() << "grids that bend have no limit";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("strain_limit"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
