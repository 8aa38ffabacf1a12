// One frame of each method against the same method in double on the CPU, written from the papers, not from the shaders.
#include <algorithm>
#include <cmath>

#include "gpu_fixture.hpp"
#include "line_model.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// A scene that starts deformed: the sheet is stretched by 7 % and 3 % by giving it smaller rest lengths than it has.
Scene deformed(Scene s) {
  s.cloth.axis_u = {1.07, 0, 0};
  s.cloth.axis_v = {0, 0.3, 1.0};
  s.cloth.initial_velocity_m_per_s = {0.3, -0.2, 0.1};
  return s;
}

Model start(const Scene& s) {
  Model m;
  const std::vector<double> x = initial_positions(s), mass = vertex_masses(s);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    m.x.push_back({x[3 * i], x[3 * i + 1], x[3 * i + 2]});
    m.v.push_back(s.cloth.initial_velocity_m_per_s);
    m.w.push_back(1 / mass[i]);
  }
  for (std::uint32_t p : s.pins.vertices) {
    m.w[p] = 0;
    m.v[p] = {};
  }
  return m;
}

/// Müller et al. 2007 with averaged Jacobi iterations; damping after the forces.
void paper_frame(const Scene& s, Model& m, int iterations, double k) {
  const double h = s.time.dt(), keep = s.needs.has(Feature::Damping) ? 1 - s.material.damping_per_s * h : 1;
  std::vector<V> q = m.x;
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (m.w[i] > 0) m.v[i] = keep * (m.v[i] + h * s.gravity_m_per_s2);
    q[i] = m.x[i] + h * m.v[i];
  }
  std::vector<Edge> all = edges(s.cloth, EdgeKind::Structural);
  for (EdgeKind kind : {EdgeKind::Shear, EdgeKind::SkipOne})
    if (s.needs.has(kind == EdgeKind::Shear ? Feature::Shear : Feature::Bend))
      for (const Edge& e : edges(s.cloth, kind)) all.push_back(e);
  for (int it = 0; it < iterations; ++it) {
    std::vector<V> sum(q.size(), V{});
    std::vector<int> count(q.size(), 0);
    for (const Edge& e : all) {
      const V d = q[e.b] - q[e.a];
      const double l = length(d), w = m.w[e.a] + m.w[e.b];
      if (w == 0) continue;
      const V c = (k * (l - e.rest_m) / (l * w)) * d;
      sum[e.a] = sum[e.a] + m.w[e.a] * c;
      sum[e.b] = sum[e.b] - m.w[e.b] * c;
      ++count[e.a];
      ++count[e.b];
    }
    for (std::size_t i = 0; i < q.size(); ++i)
      if (m.w[i] > 0) q[i] = q[i] + (1.0 / count[i]) * sum[i];
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    m.v[i] = (1 / h) * (q[i] - m.x[i]);
    m.x[i] = q[i];
  }
}

/// 3e-5 for lines: a system of 32 rows takes some digits of single precision, most if the line is pulled taut.
void expect_close(const Model& m, const ClothState& state, double speed_scale, const std::string& what,
                  double tolerance = 1e-5) {
  for (std::size_t i = 0; i < m.x.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(state.position[3 * i + k], m.x[i][k], tolerance) << what << " vertex " << i;
      EXPECT_NEAR(state.velocity[3 * i + k], m.v[i][k], tolerance * speed_scale) << what << " vertex " << i;
    }
}

/// Lines within a subgroup of this device and across several.
std::vector<nlohmann::json> variants() {
  return {nlohmann::json::object(),
          {{"tuning", {{"vertices_a_thread", 2}}}},
          {{"tuning", {{"vertices_a_thread", 2}, {"lines_beside", 2}}}},
          {{"tuning", {{"vertices_a_thread", 8}}}},
          {{"tuning", {{"vertices_a_thread", 2}, {"lines_beside", 4}, {"threads_a_group", 128}}}}};
}

nlohmann::json chosen(const Method& m) {
  const auto always = [](bool on) { return on ? "always" : "never"; };
  return {{"time_order", m.uses_bdf2 ? 2 : 1},
          {"tuning",
           {{"bdf2", m.uses_bdf2 ? "always" : "auto"},
            {"tension", always(m.tension)},
            {"splitting_correction", always(m.corrects_splitting)}}}};
}

TEST_F(Gpu, OneFrameAgreesWithDoublePrecision) {
  std::size_t number = 0;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 5}, {7, 5}, {33, 17}})
    for (int features : {0, 1, 2, 3, 4, 5, 6, 7, 8, 15, 18, 26, 31}) {  // bits, as below
      std::size_t turn = 2 * number;
      if (!in_turn(number++)) continue;
      Scene s = deformed(sheet(columns, rows, (columns - 1) / 32.0, (rows - 1) / 32.0));
      if ((features & 1) != 0) s = with_pins(s);
      if ((features & 2) != 0) s = with_bending(s);
      if ((features & 4) != 0) s = with_damping(s);
      if ((features & 8) != 0) s.needs = s.needs - FeatureSet{Feature::Shear};
      if ((features & 16) != 0) {
        s.pins.vertices = clamp_vertices(s.cloth, "u0");
        s.needs.add(Feature::Pins);
      }
      const std::string what =
          std::to_string(columns) + "x" + std::to_string(rows) + " features " + std::to_string(features);
      // Speeds come from corrections over the step: 1e-5 of a metre over it.
      Model m = start(s);
      paper_frame(s, m, 5, 0.8);
      const auto paper = make("paper");
      paper->load(s);
      expect_close(m, after(*paper, s, 1), 1 / s.time.dt(), "paper " + what);
      // The sheet, let go from 7 % of stretch, may be back and buckling by the end of the frame. How far a last bit of
      // single precision at the start then moves it in double is the smallest error that can be demanded.
      for (const int substeps : {10, 4}) {
        m = start(s);
        Model nudged = m;
        for (std::size_t i = 0; i < m.x.size(); ++i)
          for (std::size_t k = 0; k < 3; ++k)
            if (m.w[i] > 0) nudged.x[i][k] += ((i + k) % 2 == 0 ? 6e-8 : -6e-8) * std::abs(nudged.x[i][k]);
        const Method method{false, turn % 2 == 1, number % 2 == 0, (features & 8) == 0 && number % 3 != 0};
        LineModel(s, m, method).frame(substeps);
        LineModel(s, nudged, method).frame(substeps);
        double moved = 0;
        for (std::size_t i = 0; i < m.x.size(); ++i) moved = std::max(moved, length(m.x[i] - nudged.x[i]));
        ASSERT_LE(moved, 1e-3) << what << ": nothing would be tested";
        // In turns: a pipeline takes a CPU device a good part of a second to make.
        nlohmann::json settings = {{"substeps", substeps}};
        settings.update(variants()[turn / 2 % variants().size()]);
        settings.update(chosen(method), true);
        ++turn;
        const auto xpbd = make("xpbd", settings);
        xpbd->load(s);
        expect_close(m, after(*xpbd, s, 1), substeps / s.time.dt(), "xpbd " + what + settings.dump(),
                     std::max(3e-5, 10 * moved));
      }
    }
}

/// Filters and creep gather over many substeps, so that a frame shows little of them.
TEST_F(Gpu, CoupledFamiliesAgreeWithDoublePrecision) {
  std::size_t turn = 0;
  std::size_t number = 0;
  for (const auto& [columns, rows] : {std::pair{5, 5}, {9, 7}, {12, 33}})
    for (const bool tension : {false, true}) {
      if (!in_turn(number++)) continue;
      Scene s = with_damping(with_pins(sheet(columns, rows, (columns - 1) / 32.0, (rows - 1) / 32.0)));
      s.pins.vertices = edge_vertices(s.cloth, "v0");
      s.material.membrane_stiffness_N_per_m = 50;
      Model m = start(s), without = m;
      const Method method{false, true, tension, true}, plain{false, true, tension};
      LineModel model(s, m, method), uncoupled(s, without, plain);
      constexpr int kFrames = 12, kSubsteps = 4;
      for (int f = 0; f < kFrames; ++f) {
        model.frame(kSubsteps);
        uncoupled.frame(kSubsteps);
      }
      double changed = 0;
      for (std::size_t i = 0; i < m.x.size(); ++i) changed = std::max(changed, length(m.x[i] - without.x[i]));
      ASSERT_GE(changed, 1e-4) << "nothing would be tested";
      nlohmann::json settings = {{"substeps", kSubsteps}, {"tethers", false}};
      settings.update(variants()[turn++ % variants().size()]);
      settings.update(chosen(method), true);
      const auto xpbd = make("xpbd", settings);
      xpbd->load(s);
      expect_close(m, after(*xpbd, s, kFrames), kSubsteps / s.time.dt(),
                   std::to_string(columns) + "x" + std::to_string(rows) + settings.dump(), 0.02 * changed);
    }
}

TEST_F(Gpu, PlanStatesSubsteps) {
  const auto planned = [](const Scene& s, const nlohmann::json& settings) {
    const auto solver = make("xpbd", settings);
    solver->load(s);
    return solver->plan().substeps;
  };
  const Scene falling = sheet(9, 9, 1, 1);
  EXPECT_EQ(planned(falling, nlohmann::json::object()), 5);
  EXPECT_EQ(planned(falling, {{"quality", "accurate"}}), 20);
  EXPECT_EQ(planned(falling, {{"substeps", 7}}), 7);
}

TEST_F(Gpu, TethersAgreeWithDoublePrecision) {
  std::size_t turn = 0;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {9, 7}, {5, 20}, {33, 17}})
    for (const bool shear : {true, false})
      for (const bool edge : {false, true}) {
        Scene s = with_damping(with_pins(sheet(columns, rows)));
        s.material.membrane_stiffness_N_per_m.reset();
        if (!shear) s.needs = s.needs - FeatureSet{Feature::Shear};
        if (edge) s.pins.vertices = edge_vertices(s.cloth, "v0");
        ASSERT_FALSE(tethers_of(s).to.empty());
        Model m = start(s);
        const Method method{true, turn % 2 == 0, turn % 3 == 0};
        LineModel(s, m, method).frame(4);
        nlohmann::json settings = {{"substeps", 4}};
        settings.update(variants()[turn++ % variants().size()]);
        settings.update(chosen(method), true);
        const auto xpbd = make("xpbd", settings);
        xpbd->load(s);
        expect_close(m, after(*xpbd, s, 1), 4 / s.time.dt(),
                     std::to_string(columns) + "x" + std::to_string(rows) + settings.dump());
      }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
