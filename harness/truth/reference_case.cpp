#include "truth/reference_case.hpp"

#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"
#include "truth/strip.hpp"

namespace clothbench::truth {
namespace {

/// u and v of every vertex [m].
std::vector<double> rest_uv(const Cloth& c) {
  std::vector<double> out;
  if (c.mesh) {
    for (const Vec3& x : c.mesh->vertices) {
      out.push_back(x[0] + c.width_m / 2);
      out.push_back(x[1] + c.height_m / 2);
    }
    return out;
  }
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) {
      // Puts the border exactly on the border, regardless of rounding.
      out.push_back(i + 1 == c.columns ? c.width_m : i * c.du());
      out.push_back(j + 1 == c.rows ? c.height_m : j * c.dv());
    }
  return out;
}

/// The case of a flat rectangle of triangles: the continuum at its vertices. Its columns are means over the rows of the
/// material lattice, as for a run, so that interpolation in triangles is no error.
ReferenceCase on_mesh(const Strip& s, ReferenceCase known) {
  known.vertices = [s, continuum = known.continuum](int frame) {
    const Cloth& c = s.scene.cloth;
    std::vector<double> out;
    for (const Vec3& at : c.mesh->vertices) {
      const Vec3 x = continuum(at[0] / c.width_m + 0.5, frame);
      for (std::size_t k = 0; k < 3; ++k) out.push_back(x[k] + at[1] * c.axis_v[k]);
    }
    return out;
  };
  known.columns = [s, vertices = known.vertices](int frame) { return column_means(s.scene.cloth, vertices(frame)); };
  return known;
}

ReferenceCase mesh_case(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  const bool flat = std::all_of(c.mesh->vertices.begin(), c.mesh->vertices.end(), [&](const Vec3& x) {
    return std::abs(x[2]) <= Strip::kFlat * c.width_m && std::abs(x[0]) <= (0.5 + Strip::kFlat) * c.width_m &&
           std::abs(x[1]) <= (0.5 + Strip::kFlat) * c.height_m;
  });
  s.need(flat && c.mesh->pattern_m.empty(),
         "a mesh that is a flat rectangle round the middle of its frame, its longer side along x");
  if (s.scene.reference_case == "swing-strip") return on_mesh(s, swing_strip(s));
  if (s.scene.reference_case == "heavy-strip") return on_mesh(s, heavy_strip(s));
  s.need(s.scene.reference_case == "cantilever", "a cloth that is a grid");
  return on_mesh(s, cantilever(s));
}

// Twice the 1 % at which work-precision diagrams read off a time: a run that is farther off is of no stated accuracy.
constexpr double kOfMotion = 0.02;
// A strip turns on a cylinder row by row. At 9 rows on it, the fewest that are drawn, a row that comes onto it or
// leaves it can lose (pi / 18)^2 = 3 % of its kinetic energy to the contact.
constexpr double kOnCylinder = 0.03;

}  // namespace

const std::vector<Tolerance>& tolerances() {
  const char *const moving = "RMS distance over space and time / L", *const at_rest = "RMS distance at rest / L";
  static const std::vector<Tolerance> all = {
      {"free-fall", kOfMotion, 0, "Newton's law: no parameter of the cloth enters", moving},
      {"pendulum", kOfMotion, 0, "one degree of freedom, half a swing at most", moving},
      {"swing-strip", kOfMotion, 0, "the chain is not chaotic until the end of the scene", moving},
      {"heavy-strip", kOfMotion, 1e-3, "statics; 10^-3 of the length is what stability class F3 takes for no stretch",
       "stretch of the strip at rest / exact stretch"},
      {"cantilever", kOfMotion, 0, "statics", at_rest},
      {"two-hand-pull", kOfMotion, 0, "waves that the ramp makes longer than a cell",
       "maximum strain, RMS over time / (v0/c)"},
      {"incline", kOfMotion, 1e-4, "Coulomb's law; at rest 25 um of a sheet of 0.25 m",
       "displacement along the slope, RMS over time / displacement at the end (at rest: L)"},
      {"capstan", kOnCylinder, 5e-3, "a polygon on a cylinder; at rest a fifth of a cell",
       "displacement over the cylinder, RMS over time / displacement at the end (at rest: L)"}};
  return all;
}

const Tolerance& tolerance_of(const std::string& reference_case) {
  for (const Tolerance& t : tolerances())
    if (t.reference_case == reference_case) return t;
  throw Error("reference case \"" + reference_case + "\": unknown; see tolerances() in truth/reference_case.cpp");
}

std::optional<ReferenceCase> reference_case_of(const Scene& scene) {
  if (scene.reference_case.empty()) return std::nullopt;
  const Strip s(scene);
  if (scene.reference_case == "incline") return incline(s);
  s.need_rows(scene.reference_case == "heavy-strip");
  if (scene.reference_case == "capstan") return capstan(s);
  s.need((scene.needs & kColliderFeatures).empty(), "no collider");
  if (scene.cloth.mesh) return mesh_case(s);
  if (scene.reference_case == "free-fall") return free_fall(s);
  if (scene.reference_case == "pendulum") return pendulum(s);
  if (scene.reference_case == "swing-strip") return swing_strip(s);
  if (scene.reference_case == "heavy-strip") return heavy_strip(s);
  if (scene.reference_case == "cantilever") return cantilever(s);
  if (scene.reference_case == "two-hand-pull") return two_hand_pull(s);
  throw Error(scene.source + ": /truth/case: no reference case \"" + scene.reference_case + "\"");
}

LatticeSampler sampler_of(const Cloth& c) {
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangles(c)) corners.insert(corners.end(), t.begin(), t.end());
  return {MaterialLattice(c.width_m, c.height_m), rest_uv(c), corners};
}

std::vector<Vec3> column_means(const Cloth& c, const std::vector<double>& values) {
  if (values.size() != 3 * c.vertex_count()) throw Error("argument values: expected 3 for each vertex");
  const std::vector<double> on_lattice = c.mesh ? sampler_of(c).sample(values) : std::vector<double>();
  const std::vector<double>& of = c.mesh ? on_lattice : values;
  Columns out(static_cast<std::size_t>(c.mesh ? MaterialLattice::kSide : c.columns));
  const double rows = c.mesh ? MaterialLattice::kSide : c.rows;
  for (std::size_t v = 0; v < of.size() / 3; ++v)
    for (std::size_t k = 0; k < 3; ++k) out[v % out.size()][k] += of[3 * v + k] / rows;
  return out;
}

std::vector<double> vertex_positions(const Cloth& c, const ReferenceCase& known, int frame) {
  return known.vertices ? known.vertices(frame) : vertex_values(c, known.columns(frame));
}

std::vector<double> vertex_values(const Cloth& c, const std::vector<Vec3>& columns) {
  if (columns.size() != static_cast<std::size_t>(c.columns))
    throw Error("argument columns: expected one for each column of the grid");
  std::vector<double> out;
  for (int j = 0; j < c.rows; ++j)
    for (const Vec3& x : columns)
      for (std::size_t k = 0; k < 3; ++k) out.push_back(x[k] + (j * c.dv() - c.height_m / 2) * c.axis_v[k]);
  return out;
}

}  // namespace clothbench::truth
