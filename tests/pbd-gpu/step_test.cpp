// Compares one frame of `paper` with the method in double on the CPU, written from the paper, not from the shaders.
// Compares `xpbd` in every layout of its lines with the layout that it selects itself.
#include <algorithm>

#include "clothbench/vector.hpp"
#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

void expect_close(const ClothState& found, const ClothState& expected, double tolerance_m, double step_s,
                  const std::string& what) {
  ASSERT_EQ(found.position.size(), expected.position.size()) << what;
  for (std::size_t i = 0; i < expected.position.size(); ++i) {
    ASSERT_NEAR(found.position[i], expected.position[i], tolerance_m) << what << " vertex " << i / 3;
    ASSERT_NEAR(found.velocity[i], expected.velocity[i], tolerance_m / step_s) << what << " vertex " << i / 3;
  }
}

/// Müller et al. 2007 with averaged Jacobi iterations; damping after the forces.
ClothState paper_frame(const Scene& s, int iterations, double stiffness) {
  const double h = s.time.dt(), keep = s.needs.has(Feature::Damping) ? 1 - s.material.damping_per_s * h : 1;
  const std::vector<double> mass = vertex_masses(s), start = initial_positions(s);
  std::vector<double> w;
  std::vector<Vec3> q;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    w.push_back(std::ranges::count(s.pins.vertices, i) > 0 ? 0 : 1 / mass[i]);
    const Vec3 v = scaled(keep, plus(s.cloth.initial_velocity_m_per_s, scaled(h, s.gravity_m_per_s2)));
    q.push_back(plus(vertex_at(start, i), scaled(w[i] > 0 ? h : 0, v)));
  }
  std::vector<Edge> all = edges(s.cloth, EdgeKind::Structural);
  for (EdgeKind kind : {EdgeKind::Shear, EdgeKind::SkipOne})
    if (s.needs.has(kind == EdgeKind::Shear ? Feature::Shear : Feature::Bend))
      for (const Edge& e : edges(s.cloth, kind)) all.push_back(e);
  for (int it = 0; it < iterations; ++it) {
    std::vector<Vec3> sum(q.size(), Vec3{});
    std::vector<int> count(q.size(), 0);
    for (const Edge& e : all) {
      const Vec3 d = minus(q[e.b], q[e.a]);
      const double l = length(d), both = w[e.a] + w[e.b];
      if (both == 0) continue;
      const Vec3 c = scaled(stiffness * (l - e.rest_m) / (l * both), d);
      sum[e.a] = plus(sum[e.a], scaled(w[e.a], c));
      sum[e.b] = minus(sum[e.b], scaled(w[e.b], c));
      ++count[e.a];
      ++count[e.b];
    }
    for (std::size_t i = 0; i < q.size(); ++i)
      if (w[i] > 0) q[i] = plus(q[i], scaled(1.0 / count[i], sum[i]));
  }
  ClothState out;
  for (std::size_t i = 0; i < start.size(); ++i) {
    out.position.push_back(q[i / 3][i % 3]);
    out.velocity.push_back((out.position[i] - start[i]) / h);
  }
  return out;
}

TEST_F(Gpu, PaperFramesAgreeWithDoublePrecision) {
  std::size_t number = 0;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 5}, {7, 5}, {33, 17}})
    for (int features = 0; features < 16; ++features) {  // bits, as below
      if (!in_turn(number++)) continue;
      Scene s = sheet(columns, rows, (columns - 1) / 32.0, (rows - 1) / 32.0);
      if ((features & 1) != 0) s = with_pins(s);
      if ((features & 2) != 0) s = with_bending(s);
      if ((features & 4) != 0) s = with_damping(s);
      if ((features & 8) != 0) s.needs = s.needs - FeatureSet{Feature::Shear};
      s.cloth.axis_u = {1.07, 0, 0};  // stretched by 7 % and 3 %
      s.cloth.axis_v = {0, 0.3, 1.0};
      s.cloth.initial_velocity_m_per_s = {0.3, -0.2, 0.1};
      const auto paper = make("paper");
      paper->load(s);
      expect_close(after(*paper, s, 1), paper_frame(s, 5, 0.8), 1e-5, s.time.dt(),
                   std::to_string(columns) + "x" + std::to_string(rows) + " features " + std::to_string(features));
    }
}

/// Lines within a subgroup of this device, across several subgroups, and side by side.
TEST_F(Gpu, EveryLayoutOfLinesTakesTheSameSteps) {
  const nlohmann::json layouts[] = {
      {{"vertices_a_thread", 2}},
      {{"vertices_a_thread", 2}, {"lines_beside", 2}},
      {{"vertices_a_thread", 8}},
      {{"vertices_a_thread", 2}, {"lines_beside", 4}, {"threads_a_group", 128}},
  };
  const struct {
    int columns, rows;
    bool bends, shears;
    const char *tension, *splitting_correction;
  } rows[] = {{7, 5, true, true, "never", "always"},
              {33, 17, true, true, "always", "always"},
              {9, 40, true, false, "always", "never"}};
  for (const auto& row : rows) {
    Scene s = with_damping(with_pins(sheet(row.columns, row.rows, (row.columns - 1) / 32.0, (row.rows - 1) / 32.0)));
    if (row.bends) s = with_bending(s);
    if (!row.shears) s.needs = s.needs - FeatureSet{Feature::Shear};
    s.cloth.start.noise_m = 1e-3;
    const auto end = [&](nlohmann::json tuning) {
      tuning.update({{"tension", row.tension}, {"splitting_correction", row.splitting_correction}});
      const auto solver = make("xpbd", {{"substeps", 4}, {"tuning", tuning}});
      solver->load(s);
      return after(*solver, s, 2);
    };
    const ClothState expected = end(nlohmann::json::object());
    for (const nlohmann::json& layout : layouts)
      expect_close(end(layout), expected, 1e-5, s.time.dt() / 4, std::to_string(row.columns) + layout.dump());
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
