#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clothbench/vector.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/mesh/matrices.hpp"
#include "xpbd/time/integrator.hpp"
#include "xpbd/time/rules.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// The kernel limits the trace of a deformed triangle's matrix to kMaxTrace times the trace at rest. kRoom times the
/// bound of eigenvalues at rest covers such a triangle with the transverse stiffness of its tension (up to kMaxTurn).
constexpr double kMaxTrace = 1.25, kRoom = 1.75;

/// Unit vectors along the edges of a triangle at rest, in its plane.
std::array<std::array<double, 2>, 3> directions(const std::array<Vec3, 3>& p) {
  const Vec3 e = minus(p[1], p[0]), f = minus(p[2], p[0]);
  const double l = norm(e), x = dot(e, f) / l, y = norm(cross(e, f)) / l;
  const double second = std::hypot(x - l, y), third = std::hypot(x, y);
  return {{{1, 0}, {(x - l) / second, y / second}, {-x / third, -y / third}}};
}

/// Norms of the 2 x 2 blocks that couple the corners of a triangle at rest.
std::array<std::array<double, 3>, 3> block_norms(const TriangleStiffness& k, const std::array<Vec3, 3>& rest) {
  const auto g = directions(rest);
  // The edges at corner c: number c leaves it, and number c + 2 arrives.
  const auto stiffness = [&](std::size_t i, std::size_t j) {
    return i == j ? k.along_N_m[i] : k.cross_N_m[(i + 1) % 3 == j ? i : j];
  };
  std::array<std::array<double, 3>, 3> out{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) {
      double block[2][2] = {};
      for (const auto& [i, sign_i] : {std::pair{a, -1}, {(a + 2) % 3, 1}})
        for (const auto& [j, sign_j] : {std::pair{b, -1}, {(b + 2) % 3, 1}})
          for (std::size_t r = 0; r < 2; ++r)
            for (std::size_t c = 0; c < 2; ++c) block[r][c] += sign_i * sign_j * stiffness(i, j) * g[i][r] * g[j][c];
      const double sum = block[0][0] * block[0][0] + block[0][1] * block[0][1] + block[1][0] * block[1][0] +
                         block[1][1] * block[1][1],
                   det = block[0][0] * block[1][1] - block[0][1] * block[1][0];
      out[a][b] = std::sqrt((sum + std::sqrt(std::max(0.0, sum * sum - 4 * det * det))) / 2);
    }
  return out;
}

/// Trace of a triangle's matrix at rest. The kernel limits the deformed triangle's trace to kMaxTrace times as much.
double trace(const TriangleStiffness& k, const std::array<Vec3, 3>& rest) {
  const auto g = directions(rest);
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    sum += 2 * k.along_N_m[i] - 2 * k.cross_N_m[i] * (g[i][0] * g[j][0] + g[i][1] * g[j][1]);
  }
  return sum;
}

}  // namespace

TriangleStiffness triangle_stiffness(const ClothMesh& mesh, std::size_t triangle, double Y_N_per_m) {
  const std::array<Vec3, 3> p = rest_corners(mesh, triangle);
  const double twice_area = norm(cross(minus(p[1], p[0]), minus(p[2], p[0])));
  const double scale = 3.0 / 16 * Y_N_per_m / twice_area;
  TriangleStiffness out{};
  double cotangent[3];  // of the angle opposite the edge
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &from = p[(k + 2) % 3], a = minus(p[k], from), b = minus(p[(k + 1) % 3], from);
    cotangent[k] = dot(a, b) / twice_area;
    out.rest_m[k] = norm(minus(p[(k + 1) % 3], p[k]));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    out.along_N_m[k] = scale * out.rest_m[k] * out.rest_m[k] * (3 * cotangent[k] * cotangent[k] + 1);
    out.cross_N_m[k] = scale * out.rest_m[k] * out.rest_m[next] * (3 * cotangent[k] * cotangent[next] - 1);
  }
  return out;
}

double membrane_bound(const Scene& scene) {
  const ClothMesh& mesh = *scene.cloth.mesh;
  std::vector<std::array<std::array<double, 3>, 3>> norms;
  const std::vector<std::optional<double>> Y = triangle_stiffnesses(scene);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    norms.push_back(block_norms(triangle_stiffness(mesh, t, Y[t].value()), rest_corners(mesh, t)));
  return kRoom * eigenvalue_bound(vertex_masses(scene), [&](const auto& v, auto& to) {
           std::fill(to.begin(), to.end(), 0.0);
           for (std::size_t t = 0; t < norms.size(); ++t)
             for (std::size_t a = 0; a < 3; ++a)
               for (std::size_t b = 0; b < 3; ++b) to[mesh.triangles[t][a]] += norms[t][a][b] * v[mesh.triangles[t][b]];
         });
}

namespace {

/// Whether a scene may be solved with triangles, whatever the number of substeps.
FeatureDecision may_use_membrane(const Scene& scene) {
  if (!scene.cloth.mesh) return {false, "the cloth is a grid"};
  if (!scene.material.membrane_stiffness_N_per_m) return {false, "the cloth is inextensible"};
  if (!is_contact_free(scene)) return {false, "the scene has contact"};
  if (std::any_of(scene.material.regions.begin(), scene.material.regions.end(),
                  [](const StiffnessRegion& r) { return !r.membrane_stiffness_N_per_m; }))
    return {false, "a region of the cloth is inextensible"};
  if (!chain_cloth(scene).welded.empty()) return {false, "edges are so short that they are welded"};
  return {true, ""};
}

std::uint32_t iterations(const Scene& scene, double bound, int substeps) {
  const double h = scene.time.dt() / substeps;
  return bending_iterations(h * h * bound);
}

}  // namespace

int substeps_for_membrane(const Scene& scene, int substeps) {
  if (!may_use_membrane(scene).enabled) return substeps;
  const double bound = membrane_bound(scene);
  for (int more = substeps; more <= rules::kMaxForMembrane * substeps; ++more)
    if (iterations(scene, bound, more) <= rules::kMaxMembraneIterations) return more;
  return substeps;
}

FeatureDecision membrane_decision(const Scene& scene, const nlohmann::json& settings) {
  if (FeatureDecision may = may_use_membrane(scene); !may.enabled) return may;
  const std::uint32_t wants = iterations(scene, membrane_bound(scene), xpbd_substeps(scene, settings));
  if (wants > rules::kMaxMembraneIterations)
    return {false, "a substep would take " + std::to_string(wants) + " iterations; at most " +
                       std::to_string(rules::kMaxMembraneIterations) + " are taken"};
  return {true, ""};
}

SlicedRows<MembraneCorner> membrane_table(const Scene& scene) {
  const ClothMesh& mesh = *scene.cloth.mesh;
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::vector<std::optional<double>> Y = triangle_stiffnesses(scene);
  std::vector<std::vector<MembraneCorner>> at(n);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriangleStiffness k = triangle_stiffness(mesh, t, Y[t].value());
    const auto largest = static_cast<float>(kMaxTrace * trace(k, rest_corners(mesh, t)));
    for (std::size_t r = 0; r < 3; ++r) {
      const auto of = [r](const double(&values)[3], std::size_t i) { return static_cast<float>(values[(r + i) % 3]); };
      at[mesh.triangles[t][r]].push_back({mesh.triangles[t][(r + 1) % 3], mesh.triangles[t][(r + 2) % 3],
                                          of(k.rest_m, 0), of(k.rest_m, 1), of(k.rest_m, 2), of(k.along_N_m, 0),
                                          of(k.along_N_m, 1), of(k.along_N_m, 2), of(k.cross_N_m, 0),
                                          of(k.cross_N_m, 1), of(k.cross_N_m, 2), largest});
    }
  }
  return sliced<MembraneCorner>(
      n, [&](std::uint32_t i) { return at[i].size(); },
      [&](std::uint32_t i, std::uint32_t j) {
        return i < n && j < at[i].size() ? at[i][j] : MembraneCorner{CHAIN_NO_VERTEX, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
      });
}

}  // namespace clothbench::pbd_gpu
