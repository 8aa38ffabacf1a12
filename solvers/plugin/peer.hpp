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
#include <iterator>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
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

/// The point at the share `share` of the way from a to b, three numbers each.
inline Point between(const double* a, const double* b, double share) {
  return point(a, 0) + share * (point(b, 0) - point(a, 0));
}

inline bool needs(const ClothbenchScene& s, std::uint32_t features) { return (s.needs & features) != 0; }

/// `count` points with three numbers each.
inline std::vector<Point> points(const double* x, std::uint32_t count) {
  std::vector<Point> out;
  for (std::uint32_t v = 0; v < count; ++v) out.push_back(point(x, v));
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

/// The springs of the sheet: for stretch and shear, the springs of clothbench_plugin.h; for bending, skip edges with
/// stiffness B across / along^3, which have no rigidity while the sheet is nearly flat.
inline std::map<Pair, ClothbenchEdge> springs(const ClothbenchScene& s, bool bending) {
  std::map<Pair, ClothbenchEdge> out;
  const auto add = [&](const ClothbenchEdge* edges, std::uint32_t count) {
    for (std::uint32_t k = 0; k < count; ++k)
      if (edges[k].spring_N_per_m > 0) out[pair(edges[k].a, edges[k].b)] = edges[k];
  };
  add(s.structural_edges, s.structural_count);
  add(s.shear_edges, s.shear_count);
  for (std::uint32_t k = 0; bending && k < s.skip_count; ++k) {
    ClothbenchEdge e = s.skip_edges[k];
    e.spring_N_per_m = s.bending_rigidity_N_m * e.across_m / (e.along_m * e.along_m * e.along_m);
    out[pair(e.a, e.b)] = e;
  }
  return out;
}

/// Centre of the points' bounds: origin of an engine's float32 coordinates, so that distant cloth loses no digits.
inline Point centre(const std::vector<Point>& all) {
  Point low = all.front(), high = low;
  for (const Point& p : all)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  return 0.5 * (low + high);
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

/// All features except self-collision and a duplicated layer; CLOTHBENCH_CLOTH_MESH is the last. An adapter's function
/// `obstacle` refuses more scenes.
constexpr std::uint32_t kSupports =
    (2 * CLOTHBENCH_CLOTH_MESH - 1) & ~(CLOTHBENCH_DUPLICATED_LAYER | CLOTHBENCH_SELF_COLLISION);

/// Contact offset of a collider [m]: the setting or, if that is 0, the scene's margin.
inline double margin(double setting_m, const ClothbenchCollider& c) { return setting_m > 0 ? setting_m : c.margin_m; }

/// The largest contact offset of all colliders [m]; 0 without any.
inline double largest_margin(double setting_m, const ClothbenchScene& s) {
  double largest = 0;
  for (std::uint32_t k = 0; k < s.collider_count; ++k) largest = std::max(largest, margin(setting_m, s.colliders[k]));
  return largest;
}

/// Whether collider or grip `k` teleports, by the marks of a frame.
inline bool teleports(const std::uint8_t* marks, std::uint32_t k) { return marks != nullptr && marks[k] != 0; }

/// Base of an adapter's solver. `Values`: the settings as a struct of doubles, with a function steps(dt_s): time steps
/// in a frame.
template <typename Values, std::uint32_t kFeatures = kSupports>
struct Adapter {
  using Settings = Values;
  static constexpr std::uint32_t kFeatureBits = kFeatures;
  /// True in a solver on a GPU, which then has the functions device_s() and device_info().
  static constexpr bool kOnGpu = false;

  Adapter(const char* step, const Settings& given, const ClothbenchScene& s)
      : settings(given), scene(s), stage{step, s.needs & kFeatures, 0, std::nan(""), std::nan("")} {}

  /// Why the engine cannot run the scene, or empty.
  static std::string obstacle(const Settings&, const ClothbenchScene&) { return ""; }

  const Settings settings;
  const ClothbenchScene& scene;
  ClothbenchStage stage;  ///< only one, because an engine's step cannot be divided from outside
};

/// The scene's start as a restart before frame 0.
inline ClothbenchRestart start_of(const ClothbenchScene& s) {
  return {-1, 0, s.position_m, s.velocity_m_per_s, s.poses, nullptr, nullptr};
}

/// Copies a text, valid until the next call; all calls come from one thread.
inline const char* kept(const std::string& text) {
  static std::string last;
  last = text;
  return last.c_str();
}

/// Why a value is refused, or empty. The least value is 0, or 1 if the default is 1 or more.
inline std::string wrong_value(const ClothbenchSetting& s, double value) {
  const double least = std::min(1.0, s.default_value);
  if (value >= least) return "";
  return "setting " + std::string(s.name) + ": expected at least " + std::to_string(static_cast<int>(least)) +
         "; found " + std::to_string(value);
}

/// Makes the C interface of an adapter from `Solver`, an Adapter, and its settings.
template <typename Solver, const auto& kSettings>
ClothbenchPlugin plugin(const char* name, const char* engine, const char* precision, const char* summary) {
  using Settings = typename Solver::Settings;
  static_assert(sizeof(Settings) == std::size(kSettings) * sizeof(double));
  static const auto values = [](const double* from) {
    Settings out{};
    std::memcpy(&out, from, sizeof out);
    return out;
  };
  ClothbenchPlugin p{};
  const std::uint32_t header[] = {CLOTHBENCH_PLUGIN_HEADER};
  std::memcpy(&p, header, sizeof header);
  p.name = name;
  p.engine = engine;
  p.summary = summary;
  p.solver_version = "1";
  p.precision = precision;
  p.time_order = 1;
  p.supports = Solver::kFeatureBits;
  p.setting_count = static_cast<std::uint32_t>(std::size(kSettings));
  p.settings = kSettings;
  // All engines update velocity before position.
  p.free_fall_m = [](const double* settings, double dt_s, double gravity, double velocity, double damping,
                     std::int32_t frames) {
    const int steps = values(settings).steps(dt_s);
    const double h = dt_s / steps;
    double fallen = 0;
    for (std::int64_t k = 0; k < std::int64_t{frames} * steps; ++k) {
      velocity = Solver::next_velocity(velocity, h, gravity, damping);
      fallen += h * velocity;
    }
    return fallen;
  };
  p.create = [](const double* settings, const ClothbenchScene* scene, const char** why) -> void* {
    try {
      return new Solver(values(settings), *scene);
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
  p.restart = [](void* self, const ClothbenchRestart* at) -> std::int32_t {
    auto* solver = static_cast<Solver*>(self);
    solver->restart(at->index < 0 ? start_of(solver->scene) : *at);
    return 1;
  };
  p.contact_margin_m = [](void* self, std::uint32_t collider) {
    return static_cast<Solver*>(self)->margin_m(collider);
  };
  p.unsupported = [](const double* settings, const ClothbenchScene* scene) -> const char* {
    std::string why;
    for (std::size_t k = 0; k < std::size(kSettings) && why.empty(); ++k) why = wrong_value(kSettings[k], settings[k]);
    if (why.empty()) why = Solver::obstacle(values(settings), *scene);
    return why.empty() ? nullptr : kept(why);
  };
  if constexpr (Solver::kOnGpu) {
    p.device_s = [](void* self) { return static_cast<Solver*>(self)->device_s(); };
    p.device_info = [](void* self, ClothbenchDevice* out) { *out = static_cast<Solver*>(self)->device_info(); };
  }
  return p;
}

}  // namespace clothbench::peer

/// Defines the library's function for the adapter in `space`, which has Solver and kSettings.
#define CLOTHBENCH_PEER(space, name, engine, precision, summary)                                     \
  extern "C" const ClothbenchPlugin* clothbench_plugin(void) {                                       \
    static const ClothbenchPlugin plugin =                                                           \
        clothbench::peer::plugin<space::Solver, space::kSettings>(name, engine, precision, summary); \
    return &plugin;                                                                                  \
  }
