#include "truth/reference_case.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "clothbench/error.hpp"
#include "truth/strip.hpp"

namespace clothbench::truth {
namespace {

constexpr int kSide = MaterialLattice::kSide;

/// Lattice indices within [low, high], widened for rounding.
std::array<int, 2> covered(double low, double high, double side) {
  const double cell = side / (kSide - 1);
  const auto clamp = [](double i) { return static_cast<int>(std::clamp(i, -1.0, 1.0 * kSide)); };
  return {std::max(0, clamp(std::floor(low / cell - 1e-6))), std::min(kSide - 1, clamp(std::ceil(high / cell + 1e-6)))};
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Infinity becomes NaN, because a mean with an infinite term means nothing.
double finite_or_nan(double value) { return std::isfinite(value) ? value : kNan; }

double square_distance(std::span<const double> a, std::span<const double> b, std::size_t point) {
  double sum = 0;
  for (std::size_t k = 3 * point; k < 3 * point + 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

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
      // The last vertex is placed exactly on the border, whatever the rounding.
      out.push_back(i + 1 == c.columns ? c.width_m : i * c.du());
      out.push_back(j + 1 == c.rows ? c.height_m : j * c.dv());
    }
  return out;
}

/// Adapts a case to a flat rectangle of triangles. `vertices` becomes the continuum's solution at the mesh's vertices.
/// `columns` becomes its column means over the material points, as for a run, so that interpolation is no error.
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

/// An exact solution, its name, and whether it also holds for a flat rectangle of triangles.
struct Solution {
  const char* name;
  ReferenceCase (*of)(const Strip&);
  bool on_mesh = false;
};
constexpr Solution kSolutions[] = {{"free-fall", free_fall},
                                   {"pendulum", pendulum},
                                   {"swing-strip", swing_strip, true},
                                   {"heavy-strip", heavy_strip, true},
                                   {"cantilever", cantilever, true},
                                   {"two-hand-pull", two_hand_pull},
                                   {"incline", incline},
                                   {"capstan", capstan}};

void need_flat_mesh(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  const bool flat = std::all_of(c.mesh->vertices.begin(), c.mesh->vertices.end(), [&](const Vec3& x) {
    return std::abs(x[2]) <= Strip::kFlat * c.width_m && std::abs(x[0]) <= (0.5 + Strip::kFlat) * c.width_m &&
           std::abs(x[1]) <= (0.5 + Strip::kFlat) * c.height_m;
  });
  s.need(flat && c.mesh->pattern_m.empty(),
         "a mesh that is a flat rectangle around the middle of its frame, its longer side along x");
}

// Twice the 1 % error for which work-precision diagrams show the time: runs with larger errors are not accurate.
constexpr double kOfMotion = 0.02;
// A strip bends around a cylinder row by row. With 9 rows on the cylinder, the minimum in random scenes, a row that
// enters or leaves contact can lose (pi / 18)^2 = 3 % of its kinetic energy.
constexpr double kOnCylinder = 0.03;

}  // namespace

MaterialLattice::MaterialLattice(double width, double height) : longer_side_m(std::max(width, height)) {
  const double cell = width / (kSide - 1) * height / (kSide - 1);
  const auto share = [](int i) { return i == 0 || i == kSide - 1 ? 0.5 : 1.0; };
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      points_m.push_back({width * i / (kSide - 1), height * j / (kSide - 1)});
      areas_m2.push_back(cell * share(i) * share(j));
    }
}

LatticeSampler::LatticeSampler(const MaterialLattice& lattice, std::span<const double> rest,
                               std::span<const std::uint32_t> triangles)
    : points_(lattice.size()) {
  const double width = lattice.points_m.back()[0], height = lattice.points_m.back()[1];
  // For each lattice point the best triangle so far, rated by the point's smallest barycentric weight.
  std::vector<double> inside(lattice.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    std::array<std::array<double, 2>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = triangles[t + k];
      p[k] = {rest[2 * v], rest[2 * v + 1]};
    }
    const auto cross = [](const auto& a, const auto& b, const auto& c) {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    };
    const double area = cross(p[0], p[1], p[2]);
    if (!(area != 0)) continue;
    const auto [u0, u1] = std::minmax({p[0][0], p[1][0], p[2][0]});
    const auto [v0, v1] = std::minmax({p[0][1], p[1][1], p[2][1]});
    const auto columns = covered(u0, u1, width), rows = covered(v0, v1, height);
    for (int j = rows[0]; j <= rows[1]; ++j)
      for (int i = columns[0]; i <= columns[1]; ++i) {
        const auto at = static_cast<std::size_t>(j * kSide + i);
        const auto& x = lattice.points_m[at];
        const std::array<double, 3> w{cross(x, p[1], p[2]) / area, cross(p[0], x, p[2]) / area,
                                      cross(p[0], p[1], x) / area};
        const double least = std::min({w[0], w[1], w[2]});
        if (inside[at] >= 0 || !(least > inside[at])) continue;
        inside[at] = least;
        points_[at] = {{triangles[t], triangles[t + 1], triangles[t + 2]}, w};
      }
  }
  // A weight of -1e-9 means a distance of at most 1e-9 of the triangle's height, which is at most the longer side.
  for (std::size_t s = 0; s < inside.size(); ++s)
    if (!(inside[s] >= -1e-9))
      throw Error("argument triangles: expected to cover the rest rectangle; the point (" +
                  std::to_string(lattice.points_m[s][0]) + ", " + std::to_string(lattice.points_m[s][1]) +
                  ") m is in none");
}

std::vector<double> LatticeSampler::sample(std::span<const double> values) const {
  std::vector<double> out(3 * points_.size());
  for (std::size_t s = 0; s < points_.size(); ++s)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t corner = 0; corner < 3; ++corner)
        out[3 * s + k] += points_[s].weight[corner] * values[3 * points_[s].vertex[corner] + k];
  return out;
}

double lattice_rms_error(const MaterialLattice& lattice, std::span<const double> values, std::span<const double> truth,
                         double scale) {
  double sum = 0, area = 0;
  for (std::size_t s = 0; s < lattice.size(); ++s) {
    sum += lattice.areas_m2[s] * square_distance(values, truth, s);
    area += lattice.areas_m2[s];
  }
  return finite_or_nan(std::sqrt(sum / area) / scale);
}

double time_rms(std::span<const double> times, std::span<const double> errors) {
  double sum = 0;
  for (std::size_t i = 1; i < times.size(); ++i)
    sum += 0.5 * (times[i] - times[i - 1]) * (errors[i] * errors[i] + errors[i - 1] * errors[i - 1]);
  return finite_or_nan(std::sqrt(sum / (times.back() - times.front())));
}

double quantity_error(double value, double truth, double scale) {
  return finite_or_nan(std::abs(value - truth) / scale);
}

std::array<double, 2> stretch_error(std::span<const double> strains, std::span<const double> truth) {
  std::vector<double> excess(strains.size());
  for (std::size_t i = 0; i < excess.size(); ++i) {
    excess[i] = strains[i] - truth[i];
    if (!std::isfinite(excess[i])) return {kNan, kNan};
  }
  std::sort(excess.begin(), excess.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(excess.size())));
  return {excess[rank - 1], excess.back()};
}

const std::vector<Tolerance>& tolerances() {
  const char *const moving = "RMS distance over space and time / L", *const at_rest = "RMS distance at rest / L";
  static const std::vector<Tolerance> all = {
      {"free-fall", kOfMotion, 0, "Newton's law: no parameter of the cloth enters", moving},
      {"pendulum", kOfMotion, 0, "one degree of freedom, half a swing at most", moving},
      {"swing-strip", kOfMotion, 0, "the chain is not chaotic until the end of the scene", moving},
      {"heavy-strip", kOfMotion, 1e-3, "statics; stability class F2 treats 10^-3 of the length as no stretch",
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
  const std::string& name = scene.reference_case;
  const auto found =
      std::find_if(std::begin(kSolutions), std::end(kSolutions), [&](auto& s) { return s.name == name; });
  if (found == std::end(kSolutions)) throw Error(scene.source + ": /truth/case: no reference case \"" + name + "\"");
  const Strip s(scene);
  if (name != "incline") s.need_rows(name == "heavy-strip");
  if (name != "incline" && name != "capstan")
    s.need((scene.needs & kColliderFeatures).empty(), "a scene without colliders");
  if (!scene.cloth.mesh) return found->of(s);
  need_flat_mesh(s);
  s.need(found->on_mesh, "a grid cloth");
  return on_mesh(s, found->of(s));
}

LatticeSampler sampler_of(const Cloth& c) {
  const auto all = triangles(c);
  return {MaterialLattice(c.width_m, c.height_m), rest_uv(c), {all.front().data(), 3 * all.size()}};
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
