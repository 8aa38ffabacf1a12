// NvCloth on a CPU core, or on a GPU by CUDA, behind clothbench_plugin.h.
#include <NvCloth/Solver.h>

#include <deque>

#include "nvcloth/sheet.hpp"

namespace clothbench::nvcloth {
namespace {

struct Settings {
  double frequency_hz, substeps, tethers, margin_m, frictionless_triangles;
  explicit Settings(const double* v)
      : frequency_hz(v[0]), substeps(v[1]), tethers(v[2]), margin_m(v[3]), frictionless_triangles(v[4]) {}
  /// Solver iterations in a frame of `dt_s` seconds, rounded like the engine does.
  int iterations(double dt_s) const {
    const double n = substeps > 0 ? substeps : std::floor(dt_s * frequency_hz + 0.5);
    return static_cast<int>(std::max(1.0, n));
  }
};

std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
  if (!device().obstacle.empty()) return device().obstacle;
  for (const Part& p : parts_of(s)) {
    const std::vector<double> w = peer::inverse_masses(p.scene);
    if (std::all_of(w.begin(), w.end(), [](double x) { return x == 0; }))
      return "NvCloth's cooker makes no fabric where every vertex is pinned";
    if (w.size() > 65000) return "NvCloth numbers particles with 16 bits, so a cloth has at most 65000 vertices";
  }
  std::uint32_t triangles = 0;
  for (std::uint32_t k = 0; k < s.collider_count; ++k) {
    triangles += s.colliders[k].triangle_count;
    if (s.colliders[k].shape == CLOTHBENCH_SHAPE_MESH && s.colliders[k].friction > 0 &&
        !(settings.frictionless_triangles > 0))
      return "NvCloth's collision with triangles has no friction (solver.frictionless_triangles=1 runs it without)";
  }
  if (kOnGpu && triangles > 500)
    return "NvCloth on CUDA collides with at most 500 triangles; the scene has " + std::to_string(triangles);
  return Colliders(s, {}, 0).obstacle();
}

class Solver : public peer::Adapter {
 public:
  static constexpr bool kOnGpu = nvcloth::kOnGpu;

  /// Throws std::runtime_error with the reason if the engine cannot run the scene.
  Solver(const Settings& settings, const ClothbenchScene& s)
      : Adapter("simulate", s),
        settings_(settings),
        iteration_s_(1 / s.frame_rate_hz / settings.iterations(1 / s.frame_rate_hz)) {
    for (Part& part : parts_of(s)) {
      std::shared_ptr<const Cooked> cooked;
      if (!sheets_.empty() && are_copies(sheets_.back().part(), part))
        cooked = sheets_.back().cooked();
      else
        cooked = cook(*device().factory, part.scene, settings.tethers > 0, iteration_s_);
      sheets_.emplace_back(std::move(part), settings.margin_m, cooked);
    }
    solver_ = require(device().factory->createSolver(), "Factory::createSolver");
    restart(peer::start_of(s));
  }
  ~Solver() {
    for (Sheet& sheet : sheets_) solver_->removeCloth(sheet.cloth);
    sheets_.clear();
    NV_CLOTH_DELETE(solver_);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  void restart(const ClothbenchRestart& start) {
    for (Sheet& sheet : sheets_) {
      if (sheet.cloth != nullptr) solver_->removeCloth(sheet.cloth);
      sheet.restart(start, iteration_s_);
      solver_->addCloth(sheet.cloth);
      sheet.attach(start.grip_position_m, start.grip_held);
    }
    if (!kOnGpu || scene.grip_count == 0) return;
    // The kernel interpolates attachments only from targets that an earlier launch has read.
    for (Sheet& sheet : sheets_) sheet.cloth->setSolverFrequency(static_cast<float>(1 / iteration_s_));
    simulate(iteration_s_);
    for (Sheet& sheet : sheets_) sheet.put(start, iteration_s_);
  }

  std::int32_t step(const ClothbenchFrame& frame) {
    iteration_s_ = frame.dt_s / settings_.iterations(frame.dt_s);
    const double frequency_hz = settings_.substeps > 0 ? settings_.substeps / frame.dt_s : settings_.frequency_hz;
    for (Sheet& sheet : sheets_) {
      sheet.move(frame);
      sheet.cloth->setSolverFrequency(static_cast<float>(frequency_hz));
    }
    if (!simulate(frame.dt_s)) return CLOTHBENCH_DEVICE_LOST;
    const auto finite = [](const Sheet& sheet) { return sheet.is_finite(); };
    return std::all_of(sheets_.begin(), sheets_.end(), finite) ? CLOTHBENCH_OK : CLOTHBENCH_NOT_FINITE;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    for (const Sheet& sheet : sheets_) sheet.read(position_m, velocity_m_per_s, iteration_s_);
  }

  double device_s() const { return device().frame_s; }
  const ClothbenchDevice& device_info() const { return device().info; }
  double margin_m(std::uint32_t collider) const { return peer::margin(settings_.margin_m, scene.colliders[collider]); }

 private:
  bool simulate(double dt_s) {
    solver_->beginSimulation(static_cast<float>(dt_s));
    device().time([&] {
      for (int chunk = 0; chunk < solver_->getSimulationChunkCount(); ++chunk) solver_->simulateChunk(chunk);
    });
    solver_->endSimulation();
    return device().finish() && !solver_->hasError();
  }

  Settings settings_;
  double iteration_s_;
  std::deque<Sheet> sheets_;
  nv::cloth::Solver* solver_ = nullptr;
};

/// The engine's integrator: v += (v e^(-c h) - v) + g h, x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const int n = Settings(values).iterations(dt_s);
  const double h = dt_s / n, kept = std::exp(-damping * h);
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity, [=](double v) { return kept * v + h * gravity; });
}

const ClothbenchSetting kSettings[] = {
    {"solver_frequency_hz", "solver iterations per second (setSolverFrequency)", 300, 0},
    {"substeps", "solver iterations per frame, instead of the solver frequency; 0: by the frequency", 0, 1},
    {"tethers", "1: geodesic tethers to the pins", 1, 1},
    {"collision_margin_m", "contact offset of all colliders; 0: the scene's margins", 0, 0},
    {"frictionless_triangles", "1: run scenes whose meshes have friction, but without friction; 0: refuse them", 0, 1}};

}  // namespace
}  // namespace clothbench::nvcloth

CLOTHBENCH_PEER(clothbench::nvcloth, clothbench::nvcloth::kName, "NvCloth", "float32", clothbench::nvcloth::kSummary)
