// Second order in time (BDF2): errors against `reference` in double precision (bending: against many substeps), the
// frames at which it restarts, and the scenes in which it is off.
#include <algorithm>
#include <cmath>

#include "contact_scenes.hpp"
#include "gpu_fixture.hpp"
#include "mesh_scene.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Settings of a solver with BDF2.
nlohmann::json predicting(nlohmann::json given = nlohmann::json::object()) {
  given["time_order"] = 2;
  return given;
}
nlohmann::json by_euler(nlohmann::json given) {
  given["time_order"] = 1;
  return given;
}

class Bdf2 : public Gpu {
 protected:
  static std::vector<ClothState> motion(const Scene& s, const std::string& solver, nlohmann::json given) {
    const SolverEntry& e = find_solver(solver);
    const auto made = e.make(complete_settings(e.info, given), {});
    made->load(s);
    std::vector<ClothState> out;
    for (int f = 0; f < s.time.frames(); ++f) out.push_back(after_frame(*made, s, f));
    return out;
  }
  /// RMS distance over all vertices and frames, divided by the longer side; NaN if any distance is NaN.
  static double rms(const Scene& s, const std::vector<ClothState>& a, const std::vector<ClothState>& b) {
    double sum = 0, n = 0;
    for (std::size_t f = 0; f < a.size(); ++f)
      for (std::size_t k = 0; k < a[f].position.size(); ++k) {
        sum += std::pow(a[f].position[k] - b[f].position[k], 2);
        n += 1.0 / 3;
      }
    return std::sqrt(sum / n) / std::max(s.cloth.width_m, s.cloth.height_m);
  }
};

/// A sheet or strip that hangs by one edge and swings in its own plane and out of it.
Scene swing(Scene s) {
  s.pins.vertices = edge_vertices(s.cloth, "u0");
  s.needs.add(Feature::Pins);
  s.time = {60, 0.4};
  return s;
}

TEST_F(Bdf2, StripsAndSheetsOfSecondOrderInTime) {
  Scene strip = swing(sheet(33, 2, 1, 1.0 / 32)), elastic = swing(sheet(9, 9)),
        bends = swing(sheet(34, 2, 33.0 / 32, 1.0 / 32));
  strip.needs = strip.needs - FeatureSet{Feature::Shear};
  strip.material.membrane_stiffness_N_per_m.reset();
  bends.needs = strip.needs;
  bends.needs.add(Feature::Bend);
  bends.material.membrane_stiffness_N_per_m.reset();
  bends.material.bending_rigidity_N_m = 0.2 * 9.81 / 10;
  bends.pins.vertices = clamp_vertices(bends.cloth, "u0");
  struct Row {
    const char* what;
    const Scene& scene;
    int substeps;
    double error, order;
  };
  for (const Row& row : {Row{"strip", strip, 5, 8e-5, 1.8},
                         {"elastic sheet", elastic, 4, 1.5e-4, 1.3},
                         {"bending strip", bends, 5, 8e-5, 1.3}}) {
    const auto right = row.scene.needs.has(Feature::Bend) ? motion(row.scene, "xpbd", predicting({{"substeps", 128}}))
                                                          : motion(row.scene, "reference", {{"substeps", 64}});
    double error[3];
    for (int k = 0; k < 3; ++k)
      error[k] = rms(row.scene, motion(row.scene, "xpbd", predicting({{"substeps", row.substeps << k}})), right);
    const double euler = rms(row.scene, motion(row.scene, "xpbd", by_euler({{"substeps", 2 * row.substeps}})), right);
    EXPECT_LE(error[1], row.error) << row.what;
    EXPECT_LE(error[1], 0.2 * euler) << row.what << ": otherwise this compares nothing";
    EXPECT_GE(std::log2(error[0] / error[2]) / 2, row.order) << row.what;
  }
}

/// A new frame length, a reset, a restart or a released vertex begins with a substep of backward Euler, or of BDF2 with
/// a different step ratio; the frame after it is ordinary again.
TEST_F(Bdf2, BeginsAnewWhereThereIsNoLastSubstep) {
  const Scene s = with_bending(with_pins(sheet(9, 7)));
  const auto solver = make("xpbd", predicting({{"substeps", 5}}));
  solver->load(s);
  const ClothState once = after(*solver, s, 9);
  solver->reset();
  EXPECT_EQ(after(*solver, s, 9).position, once.position);
  ASSERT_TRUE(solver->restart(once));
  const ClothState again = after(*solver, s, 9);
  solver->reset();
  const ClothState straight = after(*solver, s, 18);
  double most = 0;
  for (std::size_t k = 0; k < again.position.size(); ++k)
    most = std::max(most, std::abs(again.position[k] - straight.position[k]));
  EXPECT_LE(most, 2e-3) << "one substep of first order";
  // After release, the attached vertices fly on at the hand's speed and fall.
  constexpr int kRelease = 4, kFlight = 12;
  Scene flies = sheet(5, 4);
  std::vector<std::uint32_t> all(20);
  for (std::uint32_t v = 0; v < 20; ++v) all[v] = v;
  flies = moving(flies, all, kRelease);
  const auto thrown = make("xpbd", predicting({{"substeps", 3}}));
  thrown->load(flies);
  const std::vector<double> rest = initial_positions(flies);
  const ClothState end = after(*thrown, flies, kRelease + kFlight);
  const double fall = xpbd_free_fall_m(sheet(5, 4), predicting({{"substeps", 3}}), kFlight);
  for (std::size_t v = 0; v < 20; ++v) {
    EXPECT_NEAR(end.position[3 * v], rest[3 * v] + 0.02 * (kRelease + kFlight), 1e-4);
    EXPECT_NEAR(end.position[3 * v + 1], rest[3 * v + 1] + 0.03 * (kRelease + kFlight) + fall, 1e-4);
  }
}

/// Strain of a strip of 33 x 2 vertices along its grid lines at the end; NaN if any position is NaN.
double strain(const Scene& s, const ClothState& state) {
  double most = 0;
  for (std::size_t i = 1; i < 33; ++i) {
    const Vec3 link = minus(vertex_at(state.position, i), vertex_at(state.position, i - 1));
    const double here = std::abs(length(link) / s.cloth.du() - 1);
    if (!(here <= most)) most = here;
  }
  return most;
}

TEST_F(Bdf2, IsOffInSheetsTautAlongNoLineOfLinks) {
  const nlohmann::json settings = complete_settings(find_solver("xpbd").info, nlohmann::json::object());
  Scene s = swing(sheet(9, 9));
  for (const auto& [pins, is_on] : {std::pair<std::vector<std::uint32_t>, bool>{{4}, true},
                                    {{0, 8}, true},    // a row
                                    {{0, 80}, true},   // a diagonal
                                    {{0, 28}, false},  // one column and three rows apart
                                    {{0, 8, 75}, false}}) {
    s.pins.vertices = pins;
    EXPECT_EQ(bdf2_decision(s, settings).enabled, is_on) << pins.size() << " pins, the last " << pins.back();
  }
}

TEST_F(Bdf2, TensionHoldsLoadsAndWhatIsPulledTooFar) {
  Scene loaded = swing(sheet(33, 2, 1, 1.0 / 32));
  loaded.needs = loaded.needs - FeatureSet{Feature::Shear};
  loaded.material.membrane_stiffness_N_per_m.reset();
  loaded.cloth.axis_u = {0, -1, 0};
  loaded.cloth.mass_factors.assign(66, 1);
  loaded.cloth.mass_factors[32] = loaded.cloth.mass_factors[65] = 300;
  loaded.cloth.start.noise_m = 1e-5;
  loaded.time = {60, 0.5};
  Scene pulled = loaded;
  pulled.cloth.mass_factors.clear();
  pulled.cloth.start.moved.push_back({edge_vertices(pulled.cloth, "u1"), {0, -0.5, 0}});
  for (const std::uint32_t v : edge_vertices(pulled.cloth, "u1")) pulled.pins.vertices.push_back(v);
  Scene uneven = pulled;
  uneven.cloth.column_factors.assign(32, 1);
  uneven.needs.add(Feature::UnevenGrid);
  struct Row {
    const char* what;
    const Scene& scene;
    double low, high;
  };
  for (const Row& row : {Row{"an edge of 300 times the mass", loaded, 0, 1e-3},
                         {"pins pulled apart", pulled, 0.495, 0.505},
                         {"pins pulled apart, solved as a chain", uneven, 0.495, 0.505}}) {
    nlohmann::json given = {{"substeps", 4}};
    const double with = strain(row.scene, motion(row.scene, "xpbd", given).back());
    given["tuning"]["tension"] = "never";
    const double without = strain(row.scene, motion(row.scene, "xpbd", given).back());
    EXPECT_TRUE(with >= row.low && with <= row.high) << row.what << ": strain " << with;
    EXPECT_FALSE(without >= row.low && without <= row.high) << row.what << ": otherwise this tests nothing";
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
