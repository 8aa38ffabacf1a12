/// Shared by the adapters of external engines: the sheet at rest, its springs, its stages. Header only, so that an
/// adapter needs only clothbench_plugin.h and its engine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "clothbench_plugin.h"

namespace clothbench::peer {

struct Point : std::array<double, 3> {};

inline Point point(const double* x, std::size_t k) { return {x[3 * k], x[3 * k + 1], x[3 * k + 2]}; }
inline Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const Point& a) { return std::sqrt(dot(a, a)); }
inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline bool needs(const ClothbenchScene& s, std::uint32_t features) { return (s.needs & features) != 0; }

/// The sheet at rest [m], one point per vertex.
inline std::vector<Point> rest_points(const ClothbenchScene& s) {
  std::vector<Point> out;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) out.push_back(point(s.rest_position_m, v));
  return out;
}

/// Inverse masses of vertices [1/kg]; 0 if pinned.
inline std::vector<double> inverse_masses(const ClothbenchScene& s) {
  std::vector<double> out;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) out.push_back(1 / s.mass_kg[v]);
  for (std::uint32_t k = 0; k < s.pin_count; ++k) out[s.pins[k]] = 0;
  return out;
}

/// A key for two vertices, whatever their order.
using Pair = std::pair<std::uint32_t, std::uint32_t>;
inline Pair pair(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

enum class Kind { Structural, Shear, Bend };

struct Spring {
  std::uint32_t a, b;
  double rest_m, stiffness_N_per_m;  ///< infinity: inextensible
  Kind kind;
};

/// The sheet as springs: for stretch and shear, the springs of clothbench_plugin.h; for bending, skip edges with
/// stiffness B across / along^3, which have no rigidity while the sheet is nearly flat.
inline std::vector<Spring> springs(const ClothbenchScene& s) {
  std::vector<Spring> out;
  for (std::uint32_t k = 0; k < s.structural_count; ++k) {
    const ClothbenchEdge& e = s.structural_edges[k];
    out.push_back({e.a, e.b, e.rest_m, e.spring_N_per_m, Kind::Structural});
  }
  for (std::uint32_t k = 0; k < s.shear_count; ++k) {
    const ClothbenchEdge& e = s.shear_edges[k];
    out.push_back({e.a, e.b, e.rest_m, e.spring_N_per_m, Kind::Shear});
  }
  for (std::uint32_t k = 0; needs(s, CLOTHBENCH_BEND) && k < s.skip_count; ++k) {
    const ClothbenchEdge& e = s.skip_edges[k];
    const double a = e.along_m;
    out.push_back({e.a, e.b, e.rest_m, s.bending_rigidity_N_m * e.across_m / (a * a * a), Kind::Bend});
  }
  return out;
}

/// Centre of the cloth's bounds [m]: origin of the engines' float32 coordinates, so that distant cloth loses no digits.
inline Point centre(const ClothbenchScene& s) {
  Point low = point(s.position_m, 0), high = low;
  for (std::uint32_t v = 1; v < s.vertex_count; ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], s.position_m[3 * v + k]);
      high[k] = std::max(high[k], s.position_m[3 * v + k]);
    }
  return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
}

/// Unit normal of each vertex of a mesh: mean of its triangles' normals, weighted by area; 0 if the mean is 0.
inline std::vector<Point> vertex_normals(const ClothbenchCollider& c, const double* vertices_m) {
  std::vector<Point> out(c.vertex_count, Point{});
  for (std::uint32_t t = 0; t < c.triangle_count; ++t) {
    const std::uint32_t* v = c.triangles + 3 * t;
    const Point n =
        cross(point(vertices_m, v[1]) - point(vertices_m, v[0]), point(vertices_m, v[2]) - point(vertices_m, v[0]));
    for (int corner = 0; corner < 3; ++corner)
      for (std::size_t k = 0; k < 3; ++k) out[v[corner]][k] += n[k];
  }
  for (Point& n : out) {
    const double l = length(n);
    for (double& x : n) x = l > 0 ? x / l : 0;
  }
  return out;
}

constexpr std::uint32_t kColliders = CLOTHBENCH_SPHERE | CLOTHBENCH_BOX | CLOTHBENCH_PLANE | CLOTHBENCH_CAPSULES |
                                     CLOTHBENCH_STATIC_MESH | CLOTHBENCH_MOVING_MESH;

/// All features except self-collision and a duplicated layer, unless an adapter declares its own `kSupports`. An
/// engine's function `obstacle` refuses more scenes.
constexpr std::uint32_t kSupports = CLOTHBENCH_STRETCH | CLOTHBENCH_SHEAR | CLOTHBENCH_BEND | CLOTHBENCH_DAMPING |
                                    CLOTHBENCH_PINS | CLOTHBENCH_MOVING_PINS | kColliders | CLOTHBENCH_FRICTION |
                                    CLOTHBENCH_DOUBLE_SIDED | CLOTHBENCH_UNEVEN_GRID | CLOTHBENCH_REGIONS |
                                    CLOTHBENCH_SPIN | CLOTHBENCH_CLOTH_MESH;

/// Contact offset of a collider [m]: the setting or, if that is 0, the scene's margin.
inline double margin(double setting_m, const ClothbenchCollider& c) { return setting_m > 0 ? setting_m : c.margin_m; }

/// Base of an adapter's solver.
struct Adapter {
  Adapter(const char* step, const ClothbenchScene& s, std::uint32_t supports = kSupports)
      : scene(s), origin(centre(s)), stage{step, s.needs & supports, 0, std::nan(""), std::nan("")} {}

  /// True in a solver on a GPU, which then has the functions device_s() and device_info().
  static constexpr bool kOnGpu = false;

  const ClothbenchScene& scene;
  Point origin;           ///< origin of the engine's coordinates [m]
  ClothbenchStage stage;  ///< only one, because an engine's step cannot be divided from outside
  std::vector<ClothbenchCount> counts;
};

/// The scene's start as a restart before frame 0.
inline ClothbenchRestart start_of(const ClothbenchScene& s) {
  return {-1, 0, s.position_m, s.velocity_m_per_s, s.poses, nullptr, nullptr};
}

/// Free fall [m] by an integrator that updates velocity [m/s] before position: `steps` times v = next(v), x += h v.
template <typename Next>
double fallen_m(std::int64_t steps, double h, double velocity, Next next) {
  double out = 0;
  for (std::int64_t k = 0; k < steps; ++k) {
    velocity = next(velocity);
    out += h * velocity;
  }
  return out;
}

/// Copies a text, valid until the next call; all calls come from one thread.
inline const char* kept(const std::string& text) {
  static std::string last;
  last = text;
  return last.c_str();
}

/// Description of an adapter.
struct About {
  const char *name, *engine, *precision, *summary, *version;
  double (*free_fall_m)(const double*, double, double, double, double, std::int32_t);
  std::uint32_t supports = kSupports;
};

/// Makes the C interface of an adapter from three parts: `Settings`, made from an array of values in the order of
/// `settings`; `Solver`, an Adapter; and `obstacle(settings, scene)`: why the engine cannot run the scene, or empty.
template <typename Solver, typename Settings, std::uint32_t kCount>
ClothbenchPlugin plugin(const About& about, const ClothbenchSetting (&settings)[kCount]) {
  ClothbenchPlugin p{};
  const std::uint32_t header[] = {CLOTHBENCH_PLUGIN_HEADER};
  std::memcpy(&p, header, sizeof header);
  p.name = about.name;
  p.engine = about.engine;
  p.summary = about.summary;
  p.solver_version = about.version;
  p.precision = about.precision;
  p.time_order = 1;
  p.supports = about.supports;
  p.setting_count = kCount;
  p.settings = settings;
  p.free_fall_m = about.free_fall_m;
  p.create = [](const double* settings, const ClothbenchScene* scene, const char** why) -> void* {
    try {
      return new Solver(Settings(settings), *scene);
    } catch (const std::exception& e) {
      *why = kept(e.what());
      return nullptr;
    }
  };
  p.destroy = [](void* self) { delete static_cast<Solver*>(self); };
  p.step = [](void* self, const ClothbenchFrame* frame) { return static_cast<Solver*>(self)->step(*frame); };
  p.read_state = [](void* self, double* x, double* v) { static_cast<Solver*>(self)->read(x, v); };
  p.stages = [](void* self, std::uint32_t* count) -> const ClothbenchStage* {
    *count = 1;
    return &static_cast<Solver*>(self)->stage;
  };
  p.counts = [](void* self, std::uint32_t* count) -> const ClothbenchCount* {
    const std::vector<ClothbenchCount>& all = static_cast<Solver*>(self)->counts;
    *count = static_cast<std::uint32_t>(all.size());
    return all.data();
  };
  p.restart = [](void* self, const ClothbenchRestart* at) -> std::int32_t {
    auto* solver = static_cast<Solver*>(self);
    solver->restart(at->index < 0 ? start_of(solver->scene) : *at);
    return 1;
  };
  p.contact_margin_m = [](void* self, std::uint32_t collider) {
    return static_cast<Solver*>(self)->margin_m(collider);
  };
  p.unsupported = [](const double* settings, const ClothbenchScene* scene) -> const char* {
    const std::string why = obstacle(Settings(settings), *scene);
    return why.empty() ? nullptr : kept(why);
  };
  if constexpr (Solver::kOnGpu) {
    p.device_s = [](void* self) { return static_cast<Solver*>(self)->device_s(); };
    p.device_info = [](void* self, ClothbenchDevice* out) { *out = static_cast<Solver*>(self)->device_info(); };
  }
  return p;
}

}  // namespace clothbench::peer

/// Defines the library's function for the adapter in `space`, which has Solver, Settings, kSettings, free_fall_m and
/// kSupports.
#define CLOTHBENCH_PEER(space, name, engine, precision, summary)                                          \
  extern "C" const ClothbenchPlugin* clothbench_plugin(void) {                                            \
    static const ClothbenchPlugin plugin = clothbench::peer::plugin<space::Solver, space::Settings>(      \
        {name, engine, precision, summary, "1", space::free_fall_m, space::kSupports}, space::kSettings); \
    return &plugin;                                                                                       \
  }
