// Thread CPU time of a frame and greatest stretch of the last second of scenarios/validation/hang, for a plugin alone.
//   peer_time PLUGIN.so VERTICES_A_SIDE SEED [setting=value…]
// Prints both, in ms and %. The motion is chaotic, so a seed k is a sheet longer by k/1000. For plugins that read only
// what peer.hpp reads of a scene.
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <string>

#include "peer.hpp"

namespace {

using clothbench::peer::length;
using clothbench::peer::point;

constexpr double kDensity_kg_per_m2 = 0.2, kRate_hz = 72, kDuration_s = 5;

/// An inextensible level sheet, held at two corners.
struct Hang {
  std::vector<double> x, v, mass, springs[2];
  std::vector<std::uint32_t> triangles, pins;
  std::vector<ClothbenchEdge> edges[2];  // structural, shear
  ClothbenchScene scene{};

  Hang(std::uint32_t n, double side_m) {
    const double a = side_m / (n - 1), inextensible = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < n * n; ++k) x.insert(x.end(), {k % n * a - side_m / 2, 0, k / n * a - side_m / 2});
    v.assign(x.size(), 0);
    mass.assign(n * n, 0);
    const auto edge = [&](int kind, std::uint32_t p, std::uint32_t q) {
      edges[kind].push_back({p, q, length(point(x.data(), p) - point(x.data(), q)), inextensible, a, a});
      springs[kind].push_back(inextensible);
    };
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t p = j * n + i;
        if (i + 1 < n) edge(0, p, p + 1);
        if (j + 1 < n) edge(0, p, p + n);
        if (i + 1 == n || j + 1 == n) continue;
        edge(1, p, p + 1 + n);
        edge(1, p + 1, p + n);
        triangles.insert(triangles.end(), {p, p + 1, p + 1 + n, p, p + 1 + n, p + n});
        for (const std::uint32_t corner : {p, p + 1, p + n, p + 1 + n}) mass[corner] += kDensity_kg_per_m2 * a * a / 4;
      }
    pins = {0, n - 1};
    fill(n, side_m);
  }

  void fill(std::uint32_t n, double side_m) {
    ClothbenchScene& s = scene;
    s.struct_size = sizeof s;
    s.needs = CLOTHBENCH_STRETCH | CLOTHBENCH_SHEAR | CLOTHBENCH_DAMPING | CLOTHBENCH_PINS;
    s.columns = s.rows = n;
    s.vertex_count = n * n;
    s.width_m = s.height_m = side_m;
    s.areal_density_kg_per_m2 = kDensity_kg_per_m2;
    s.damping_per_s = 0.5;
    s.gravity_m_per_s2[1] = -9.81;
    s.frame_rate_hz = kRate_hz;
    s.frames = static_cast<std::uint32_t>(kDuration_s * kRate_hz);
    s.position_m = s.rest_position_m = x.data();
    s.velocity_m_per_s = v.data();
    s.mass_kg = mass.data();
    s.triangle_count = static_cast<std::uint32_t>(triangles.size() / 3);
    s.triangles = triangles.data();
    s.structural_count = static_cast<std::uint32_t>(edges[0].size());
    s.shear_count = static_cast<std::uint32_t>(edges[1].size());
    s.structural_edges = edges[0].data();
    s.shear_edges = edges[1].data();
    s.structural_spring_N_per_m = springs[0].data();
    s.shear_spring_N_per_m = springs[1].data();
    s.pin_count = static_cast<std::uint32_t>(pins.size());
    s.pins = pins.data();
  }
};

std::vector<double> settings_of(const ClothbenchPlugin& plugin, int count, char** words) {
  std::vector<double> out;
  for (std::uint32_t k = 0; k < plugin.setting_count; ++k) out.push_back(plugin.settings[k].default_value);
  for (int w = 0; w < count; ++w) {
    const std::string word = words[w], name = word.substr(0, word.find('='));
    std::uint32_t k = 0;
    while (k < plugin.setting_count && name != plugin.settings[k].name) ++k;
    if (k == plugin.setting_count) throw std::runtime_error(std::string(plugin.name) + " has no setting " + name);
    out[k] = std::stod(word.substr(name.size() + 1));
  }
  return out;
}

double now_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double greatest_stretch(const Hang& hang, const double* x) {
  double out = 0;
  for (const ClothbenchEdge& e : hang.edges[0])
    out = std::max(out, length(point(x, e.a) - point(x, e.b)) / e.rest_m - 1);
  return out;
}

int measure(const ClothbenchPlugin& plugin, int argc, char** argv) {
  Hang hang(static_cast<std::uint32_t>(std::stoul(argv[2])), 1 + std::stod(argv[3]) / 1000);
  const std::vector<double> settings = settings_of(plugin, argc - 4, argv + 4);
  const char* why = "no reason given";
  void* solver = plugin.create(settings.data(), &hang.scene, &why);
  if (solver == nullptr) throw std::runtime_error(why);
  std::vector<double> times, x(hang.x.size()), v(hang.x.size());
  double stretch = 0;
  for (std::uint32_t f = 0; f < hang.scene.frames; ++f) {
    ClothbenchFrame frame{};
    frame.struct_size = sizeof frame;
    frame.index = static_cast<std::int32_t>(f);
    frame.dt_s = 1 / kRate_hz;
    frame.time_s = (f + 1) / kRate_hz;
    const double start = now_s();
    if (plugin.step(solver, &frame) != CLOTHBENCH_OK) throw std::runtime_error("a step failed");
    times.push_back(now_s() - start);
    if (frame.time_s <= kDuration_s - 1) continue;
    plugin.read_state(solver, x.data(), v.data());
    stretch = std::max(stretch, greatest_stretch(hang, x.data()));
  }
  plugin.destroy(solver);
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  std::printf("%.5g %.5g\n", 1000 * times[times.size() / 2], 100 * stretch);
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) throw std::runtime_error("usage: peer_time PLUGIN.so VERTICES_A_SIDE SEED [setting=value...]");
  void* library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  using Entry = const ClothbenchPlugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library, "clothbench_plugin"));
  if (entry == nullptr) throw std::runtime_error(dlerror());
  return measure(*entry(), argc, argv);
} catch (const std::exception& e) {
  std::fprintf(stderr, "peer_time: %s\n", e.what());
  return 1;
}
