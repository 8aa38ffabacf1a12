// The paper's solver, kernel for kernel: Kim, Ma & Hong, Appl. Sci. 2025, 15(12), 6611, Algorithm 1 and section 3.2.3.
#include <algorithm>
#include <cmath>

#include "gpu_solver.hpp"
#include "paper_contact.hpp"

namespace clothbench::pbd_gpu {
namespace {

using vulkan::Access;

class Paper final : public GpuSolver {
 public:
  using GpuSolver::GpuSolver;

 private:
  void build() override {
    if (native() && !vulkan_device().has_float_atomics())
      throw Error(
          "solver paper: setting atomics=native: this device has no float atomics (VK_EXT_shader_atomic_float)");
    layers_ = scene().needs.has(Feature::DuplicatedLayer) ? 2 : 1;
    build_particles();
    build_constraints();
    add_colliders({}, false);
    add_grips({}, static_cast<std::uint32_t>(layers_));
    build_stages();
  }

  bool native() const { return settings()["atomics"] == "native"; }
  std::uint64_t particles() const { return layers_ * scene().cloth.vertex_count(); }

  void build_particles() {
    const std::vector<double> start = initial_positions(scene());
    const std::vector<float> w = inverse_masses(scene());
    const std::vector<double> start_velocity = initial_velocities(scene());
    vec4s position, velocity;
    for (int layer = 0; layer < layers_; ++layer)
      for (std::size_t i = 0; i < w.size(); ++i) {
        const auto at = [&](std::size_t k) { return static_cast<float>(start[3 * i + k]); };
        const auto speed = [&](std::size_t k) {
          return w[i] > 0 ? static_cast<float>(start_velocity[3 * i + k]) : 0.0f;
        };
        position.push_back({at(0), at(1), at(2), w[i]});
        velocity.push_back({speed(0), speed(1), speed(2), w[i]});
      }
    x_ = &add_vec4_buffer("positions", position);
    v_ = &add_vec4_buffer("velocities", velocity);
    q_ = &add_buffer("predicted positions", position.size() * sizeof(vec4));
    d_ = &add_buffer("constraint deltas", position.size() * sizeof(vec4));
    set_state(*x_, *v_, {});
  }

  /// fn(a, b, rest length, kind), in the order of the buffer.
  template <class Fn>
  void for_each_constraint(Fn fn) const {
    const auto n = static_cast<std::uint32_t>(scene().cloth.vertex_count());
    std::vector<EdgeKind> kinds = {EdgeKind::Structural};
    if (scene().needs.has(Feature::Shear)) kinds.push_back(EdgeKind::Shear);
    if (scene().needs.has(Feature::Bend)) kinds.push_back(EdgeKind::SkipOne);
    for (std::uint32_t layer = 0; layer < static_cast<std::uint32_t>(layers_); ++layer)
      for (EdgeKind kind : kinds)
        for (const Edge& e : edges(scene().cloth, kind))
          fn(layer * n + e.a, layer * n + e.b, e.rest_m, static_cast<std::uint32_t>(kind));
    if (layers_ == 2)
      for (std::uint32_t i = 0; i < n; ++i) fn(i, n + i, 0.0, 3u);
  }

  void build_constraints() {
    std::vector<DistanceConstraint> all;
    for_each_constraint([&](std::uint32_t a, std::uint32_t b, double rest, std::uint32_t kind) {
      all.push_back({a, b, static_cast<float>(rest), kind});
    });
    constraint_count_ = all.size();
    std::vector<std::uint8_t> bytes(all.size() * sizeof all[0]);
    std::memcpy(bytes.data(), all.data(), bytes.size());
    c_ = &add_buffer("constraints", bytes.size(), bytes);
  }

  /// What one ProjectConstraintDeltas reads and writes, and how many particles are free.
  void count_traffic() {
    const std::vector<float>& w = inverse_mass_now();
    const auto n = static_cast<std::uint32_t>(w.size());
    free_ = layers_ * std::count_if(w.begin(), w.end(), [](float v) { return v > 0; });
    traffic_ = {};
    for_each_constraint([&](std::uint32_t a, std::uint32_t b, double, std::uint32_t) {
      const int ends = (w[a % n] > 0 ? 1 : 0) + (w[b % n] > 0 ? 1 : 0);
      // Constraint and both ends; per free end 3 sums and a count.
      traffic_.read_B += 16 + 32 + ends * (native() ? 16.0 : 28.0);
      traffic_.write_B += ends * 16.0;
    });
  }

  void build_stages() {
    const FeatureSet needs = scene().needs;
    const auto push = static_cast<std::uint32_t>(sizeof(PaperConstants));
    const FeatureSet pins = needs & FeatureSet{Feature::Pins};
    stage_forces_ = add_stage("ApplyExternalForces", {});
    forces_ = &add_kernel(stage_forces_, shaders::kApplyExternalForces, {{v_, Access::ReadWrite}}, push);
    if (needs.has(Feature::Damping)) {
      stage_damp_ = add_stage("DampVelocities", {Feature::Damping});
      damp_ = &add_kernel(stage_damp_, shaders::kDampVelocities, {{v_, Access::ReadWrite}}, push);
    } else {
      leave_out("DampVelocities", "the scene has no damping");
    }
    stage_euler_ = add_stage("ApplyExplicitEuler", pins);
    euler_ = &add_kernel(stage_euler_, shaders::kApplyExplicitEuler,
                         {{x_, Access::Read}, {v_, Access::Read}, {q_, Access::Write}}, push);
    stage_project_ = add_stage("ProjectConstraintDeltas", needs & FeatureSet{Feature::Stretch, Feature::Shear,
                                                                             Feature::Bend, Feature::DuplicatedLayer});
    project_ = &add_kernel(stage_project_,
                           native() ? shaders::kProjectConstraintDeltasNative : shaders::kProjectConstraintDeltas,
                           {{c_, Access::Read}, {q_, Access::Read}, {d_, Access::ReadWrite}}, push);
    stage_average_ = add_stage("AverageConstraintDeltas", {});
    average_ = &add_kernel(stage_average_, shaders::kAverageConstraintDeltas,
                           {{d_, Access::ReadWrite}, {q_, Access::ReadWrite}}, push, {native() ? 1u : 0u});
    if (grips() != nullptr) {
      hold_ = &grips()->add_kernel(*x_, *v_);
      aim_ = &grips()->add_kernel(*q_, *v_);
    }
    if (colliders() != nullptr)
      contact_ = std::make_unique<PaperContact>(*this, *colliders(), *q_, *x_, settings()["mesh_depth_m"].get<float>(),
                                                settings()["hand_depth_m"].get<float>());
    stage_update_ = add_stage("UpdatePositions", {});
    update_ = &add_kernel(stage_update_, shaders::kUpdatePositions,
                          {{x_, Access::ReadWrite}, {v_, Access::Write}, {q_, Access::Read}}, push);
    if (settings()["readback"] == "blocking") {
      stage_readback_ = add_stage("Readback", {});
      host_x_ = &add_host_buffer("positions on the host", x_->bytes());
      host_v_ = &add_host_buffer("velocities on the host", v_->bytes());
    } else {
      leave_out("Readback", "setting readback=none");
    }
    if (!needs.has(Feature::Shear)) leave_out("diagonal distance constraints", "the scene has no shear stiffness");
    if (!needs.has(Feature::Bend)) leave_out("skip-one distance constraints", "the scene has no bending");
    if ((needs & kColliderFeatures).empty()) leave_out("SatisfyCollisions", "the scene has no collider");
    if (!needs.has(Feature::DuplicatedLayer)) leave_out("second layer", "the cloth is not double-duplicated");
  }

  void record_frame(double dt_s) override {
    const Vec3 g = scene().gravity_m_per_s2;
    PaperConstants c{};
    c.gravity = {static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2]), 0};
    c.particles = static_cast<std::uint32_t>(particles());
    c.constraints = static_cast<std::uint32_t>(constraint_count_);
    count_traffic();
    if (colliders() != nullptr) colliders()->record();
    if (grips() != nullptr) grips()->record_upload();
    const int substeps = settings()["substeps"].get<int>();
    const double h = dt_s / substeps;
    c.h = static_cast<float>(h);
    c.stiffness = settings()["stiffness"].get<float>();
    c.keep = static_cast<float>(std::max(0.0, 1 - scene().material.damping_per_s * h));
    for (int s = 0; s < substeps; ++s) record_step(c, s, substeps, dt_s);
    if (stage_readback_ >= 0) {
      copy(stage_readback_, *x_, *host_x_);
      copy(stage_readback_, *v_, *host_v_);
    }
  }

  void record_step(const PaperConstants& c, int step, int steps, double dt_s) {
    const auto n = static_cast<double>(particles()), f = static_cast<double>(free_);
    // Held or let go from the step's start on, which the kernels that follow tell from the inverse mass.
    if (hold_ != nullptr) grips()->record_move(*hold_, static_cast<double>(step) / steps, dt_s);
    dispatch(stage_forces_, *forces_, particles(), c, {16 * n, 16 * f});
    if (damp_ != nullptr) dispatch(stage_damp_, *damp_, particles(), c, {16 * n, 16 * n});
    dispatch(stage_euler_, *euler_, particles(), c, {32 * n, 16 * n});
    if (aim_ != nullptr) grips()->record_move(*aim_, static_cast<double>(step + 1) / steps, dt_s);
    for (int i = 0; i < settings()["iterations"].get<int>(); ++i) {
      dispatch(stage_project_, *project_, constraint_count_, c, traffic_);
      dispatch(stage_average_, *average_, particles(), c, {16 * n + 16 * f, 32 * f});
    }
    if (contact_) contact_->record(static_cast<std::uint32_t>(particles()), free_);
    dispatch(stage_update_, *update_, particles(), c, {32 * n, 32 * n});
  }

  int layers_ = 1;
  std::int64_t free_ = 0;
  std::uint64_t constraint_count_ = 0;
  Traffic traffic_;  ///< of one ProjectConstraintDeltas
  int stage_forces_ = -1, stage_damp_ = -1, stage_euler_ = -1, stage_project_ = -1, stage_average_ = -1,
      stage_update_ = -1, stage_readback_ = -1;
  vulkan::Buffer *x_ = nullptr, *v_ = nullptr, *q_ = nullptr, *d_ = nullptr, *c_ = nullptr, *host_x_ = nullptr,
                 *host_v_ = nullptr;
  vulkan::Kernel *forces_ = nullptr, *damp_ = nullptr, *euler_ = nullptr, *project_ = nullptr, *average_ = nullptr,
                 *update_ = nullptr;
  const vulkan::Kernel *hold_ = nullptr, *aim_ = nullptr;
  std::unique_ptr<PaperContact> contact_;
};

}  // namespace

SolverInfo paper_info() {
  SolverInfo info;
  info.name = "paper";
  info.folder = "solvers/pbd-gpu";
  info.summary = "the paper's kernels, one by one: averaged Jacobi PBD with atomic accumulation";
  info.version = "1";
  info.precision = "float32";
  info.on_gpu = true;
  info.supports = {Feature::Stretch,         Feature::Shear,      Feature::Bend,
                   Feature::Damping,         Feature::Pins,       Feature::MovingPins,
                   Feature::Sphere,          Feature::Box,        Feature::Capsules,
                   Feature::StaticMesh,      Feature::MovingMesh, Feature::Friction,
                   Feature::DuplicatedLayer, Feature::UnevenGrid, Feature::Spin};
  // Table 4 of the article: a single-sided cloth does not touch meshes.
  info.only_with = {{Feature::StaticMesh, Feature::DuplicatedLayer}, {Feature::MovingMesh, Feature::DuplicatedLayer}};
  info.settings = {
      {"iterations", "5", "constraint iterations a substep"},
      {"substeps", "1", "substeps a frame (the paper has one)"},
      {"stiffness", "0.8", "PBD's k, 0 to 1"},
      {"readback", "\"none\"", "none | blocking: copy positions and velocities to the host every frame and wait"},
      {"atomics", "\"cas\"", "cas | native: float sums by compare-and-swap, or by VK_EXT_shader_atomic_float"},
      {"mesh_depth_m", "0.03", "a particle at most this far behind a triangle of a mesh that stands still touches it"},
      {"hand_depth_m", "0.01", "the same for the mesh of a hand"},
      {"stage_times", "false", "timestamps around every stage (slower; for profiling)"}};
  return info;
}

std::unique_ptr<GpuSolver> make_paper(const nlohmann::json& settings, const DeviceOptions& device, bool count_bytes) {
  require_one_of("paper", settings, "readback", {"none", "blocking"});
  require_one_of("paper", settings, "atomics", {"cas", "native"});
  require_between("paper", settings, "iterations", 1, 100000);
  require_between("paper", settings, "substeps", 1, 4096);
  require_between("paper", settings, "stiffness", 0, 1);
  for (const char* key : {"mesh_depth_m", "hand_depth_m"}) require_between("paper", settings, key, 0, 1000);
  return std::make_unique<Paper>(paper_info(), settings, device, count_bytes);
}

/// v <- (v + g h) keep, x <- x + h v, every substep; damping comes after the forces.
double paper_free_fall_m(const Scene& scene, const nlohmann::json& settings, int frames) {
  const int substeps = settings["substeps"].get<int>();
  const double h = scene.time.dt() / substeps, g = scene.gravity_m_per_s2[1];
  const double keep = scene.needs.has(Feature::Damping) ? std::max(0.0, 1 - scene.material.damping_per_s * h) : 1;
  double v = scene.cloth.initial_velocity_m_per_s[1], x = 0;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    v = (v + g * h) * keep;
    x += v * h;
  }
  return x;
}

}  // namespace clothbench::pbd_gpu
