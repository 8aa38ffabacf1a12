// Elastic drawn meshes against the continuum: a heavy sheet that hangs, a catenary, a strip that swings.
#include <array>
#include <cmath>
#include <functional>

#include "drawn_sheet.hpp"
#include "truth/solutions.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr int kCoarse = 8, kFine = 24;

class MeshTruth : public Gpu, public ::testing::WithParamInterface<const char*> {
 protected:
  static std::vector<double> end_of(const Scene& s, const nlohmann::json& settings) {
    const SolverEntry& e = find_solver(GetParam());
    const auto made = e.make(complete_settings(e.info, settings), e.info.on_gpu ? options() : DeviceOptions{});
    made->load(s);
    return after(*made, s, s.time.frames()).position;
  }

  /// Root mean square, over drawn meshes, of an error; and the order at which it falls with the size of cells.
  struct Falls {
    double fine, order;
  };
  static Falls falls(const std::function<double(int cells, unsigned seed)>& error) {
    const auto mean = [&](int cells) {
      double sum = 0;
      for (unsigned seed = 1; seed <= 3; ++seed) sum += std::pow(error(cells, seed), 2) / 3;
      return std::sqrt(sum);
    };
    const double coarse = mean(kCoarse), fine = mean(kFine);
    RecordProperty("coarse", std::to_string(coarse));
    RecordProperty("fine", std::to_string(fine));
    return {fine, std::log(coarse / fine) / std::log(1.0 * kFine / kCoarse)};
  }
  static Scene strip(int cells, unsigned seed) {
    Scene s = with_damping(drawn_sheet(1, 0.25, cells, 0.3 * seed, 0.25, seed));
    s.time = {30, 1.2};
    s.material.damping_per_s = 20;
    return s;
  }
};

/// Along x (p/Y) (L x - x^2/2 - nu y^2/2), across -nu (p/Y) (L - x) y, in the half that is far from the held edge, but
/// for a motion as a whole, which depends on how that edge holds the sheet.
double hanging_error(const Scene& s, const std::vector<double>& end) {
  const std::vector<double> start = initial_positions(s);
  const double L = s.cloth.width_m, nu = 1.0 / 3;
  const double p = s.cloth.areal_density_kg_per_m2 * s.gravity_m_per_s2[0] / *s.material.membrane_stiffness_N_per_m;
  double sum[2] = {}, squares = 0, count = 0;
  for (std::size_t v = 0; v < s.cloth.vertex_count(); ++v) {
    const double x = s.cloth.mesh->vertices[v][0], y = s.cloth.mesh->vertices[v][1] - s.cloth.height_m / 2;
    if (x < L / 2) continue;
    const double u = end[3 * v] - start[3 * v] - p * (L * x - x * x / 2 - nu * y * y / 2),
                 w = end[3 * v + 2] - start[3 * v + 2] + nu * p * (L - x) * y;
    sum[0] += u;
    sum[1] += w;
    squares += u * u + w * w;
    count += 1;
  }
  return std::sqrt(squares / count - std::pow(sum[0] / count, 2) - std::pow(sum[1] / count, 2)) / (p * L * L / 2);
}

TEST_P(MeshTruth, AHeavySheetHangs) {
  const Falls f = falls([](int cells, unsigned seed) {
    Scene s = strip(cells, seed);
    s.gravity_m_per_s2 = {5, 0, 0};
    return hanging_error(s, end_of(s, {{"substeps", std::string(GetParam()) == "xpbd" ? 5 : 1}}));
  });
  EXPECT_GE(f.order, 1.8);
  EXPECT_LE(f.fine, 2e-3) << "over the greatest displacement";
}

/// The strip starts as an arc; its shape at rest is flat.
Scene arched(Scene s, double span) {
  ClothMesh mesh = *s.cloth.mesh;
  for (const auto& t : mesh.triangles)
    mesh.pattern_m.push_back({{{mesh.vertices[t[0]][0], mesh.vertices[t[0]][1]},
                               {mesh.vertices[t[1]][0], mesh.vertices[t[1]][1]},
                               {mesh.vertices[t[2]][0], mesh.vertices[t[2]][1]}}});
  double low = 1e-3, high = 3;  // half the angle of the arc: sin(a)/a = span
  for (int k = 0; k < 60; ++k) {
    const double a = (low + high) / 2;
    (std::sin(a) / a > span ? low : high) = a;
  }
  s.pins.vertices.clear();
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    Vec3& at = mesh.vertices[v];
    if (at[0] == 0 || at[0] == 1) s.pins.vertices.push_back(v);
    const double angle = (2 * at[0] - 1) * low, r = 0.5 / low;
    at = {span / 2 + r * std::sin(angle), at[1], r * (std::cos(angle) - std::cos(low))};
  }
  s.cloth.mesh = std::make_shared<const ClothMesh>(std::move(mesh));
  return s;
}

/// Hooke's law between two ends at equal height, w = rho g (Irvine, Cable Structures, 1981), L = 1: the horizontal
/// tension H from d = H/Y + (2H/w) asinh(w/2H), and the point at rest length s from the left end.
class ElasticCatenary {
 public:
  ElasticCatenary(double span, double w, double Y) : span_(span), w_(w), Y_(Y) {
    double high = Y;
    for (int k = 0; k < 200; ++k) {
      tension_ = (low_ + high) / 2;
      (tension_ / Y + 2 * tension_ / w * std::asinh(w / (2 * tension_)) < span ? low_ : high) = tension_;
    }
  }
  std::array<double, 2> position_m(double s) const {
    const double a = tension_ / w_, from_middle = s - 0.5, below = s * (1 - s);
    return {span_ / 2 + from_middle * tension_ / Y_ + a * std::asinh(from_middle / a),
            -below * (w_ / (2 * Y_) + 1 / (std::hypot(a, from_middle) + std::hypot(a, 0.5)))};
  }

 private:
  double span_, w_, Y_, low_ = 0, tension_ = 0;
};

TEST_P(MeshTruth, ACatenaryHangs) {
  const double span = 0.8;
  const Falls f = falls([&](int cells, unsigned seed) {
    Scene s = arched(strip(cells, seed), span);
    s.time.duration_s = 2.5;
    s.material.damping_per_s = 10;
    const ElasticCatenary right(span, 9.81 * s.cloth.areal_density_kg_per_m2, *s.material.membrane_stiffness_N_per_m);
    const Scene flat = strip(cells, seed);
    const std::vector<double> end = end_of(s, {{"substeps", std::string(GetParam()) == "xpbd" ? 8 : 1}});
    double squares = 0;
    for (std::size_t v = 0; v < s.cloth.vertex_count(); ++v) {
      const auto at = right.position_m(flat.cloth.mesh->vertices[v][0]);
      squares += std::pow(end[3 * v] - at[0], 2) + std::pow(end[3 * v + 1] - at[1], 2);
    }
    return std::sqrt(squares / static_cast<double>(s.cloth.vertex_count()));
  });
  EXPECT_GE(f.order, 1.8);
  EXPECT_LE(f.fine, 5e-4) << "over the length";
}

TEST_P(MeshTruth, AStripSwings) {
  const Falls f = falls([](int cells, unsigned seed) {
    Scene s = strip(cells, seed);
    s.needs = s.needs - FeatureSet{Feature::Damping};
    s.material.damping_per_s = 0;
    s.material.membrane_stiffness_N_per_m = 4000;
    s.time = {60, 0.4};
    truth::SwingingChain chain;
    chain.links = 200;
    const double at_end[] = {0.4};
    const truth::Nodes right = truth::swing(chain, at_end, 1e-10).back();
    const std::vector<double> end = end_of(s, {{"substeps", 16}});
    double squares = 0;
    for (std::size_t v = 0; v < s.cloth.vertex_count(); ++v) {
      const auto at = truth::node_position(right, s.cloth.mesh->vertices[v][0]);
      squares += std::pow(end[3 * v] - at[0], 2) + std::pow(end[3 * v + 1] - at[1], 2);
    }
    return std::sqrt(squares / static_cast<double>(s.cloth.vertex_count()));
  });
  EXPECT_GE(f.order, 1.3) << "flat triangles resist the bends that run through the strip";
  EXPECT_LE(f.fine, 2.5e-3) << "over the length";
}

INSTANTIATE_TEST_SUITE_P(Solvers, MeshTruth, ::testing::Values("reference", "xpbd"));

}  // namespace
}  // namespace clothbench::pbd_gpu
