// The paper's solver, kernel for kernel: Kim, Ma & Hong, Appl. Sci. 2025, 15(12), 6611, Algorithm 1 and section 3.2.3.
#include <algorithm>

#include "common/gpu_solver.hpp"

namespace clothbench::pbd_gpu {
namespace {

FeatureSet with_friction(Feature kind, bool friction) {
  FeatureSet serves = {kind};
  if (friction) serves.add(Feature::Friction);
  return serves;
}

class Paper final : public GpuSolver {
 public:
  using GpuSolver::GpuSolver;

 private:
  void build() override {
    refuse_mesh_bending(scene());
    layers_ = scene().needs.has(Feature::DuplicatedLayer) ? 2 : 1;
    add_state(initial_positions(scene()), inverse_masses(scene()), {}, layers_);
    q_ = &add_buffer(BIND_PREDICTED, "predicted positions", position_buffer().bytes());
    add_buffer(BIND_DELTAS, "constraint deltas", q_->bytes());
    build_constraints();
    add_colliders({}, false);
    add_grips({}, static_cast<std::uint32_t>(layers_));
    build_stages();
  }

  std::uint32_t particles() const { return static_cast<std::uint32_t>(layers_ * scene().cloth.vertex_count()); }

  void build_constraints() {
    const auto n = static_cast<std::uint32_t>(scene().cloth.vertex_count());
    std::vector<EdgeKind> kinds = {EdgeKind::Structural};
    if (scene().needs.has(Feature::Shear)) kinds.push_back(EdgeKind::Shear);
    if (scene().needs.has(Feature::Bend)) kinds.push_back(EdgeKind::SkipOne);
    std::vector<DistanceConstraint> all;
    for (std::uint32_t layer = 0; layer < static_cast<std::uint32_t>(layers_); ++layer)
      for (EdgeKind kind : kinds)
        for (const Edge& e : edges(scene().cloth, kind))
          all.push_back({layer * n + e.a, layer * n + e.b, static_cast<float>(e.rest_m), static_cast<uint>(kind)});
    for (std::uint32_t i = 0; layers_ == 2 && i < n; ++i) all.push_back({i, n + i, 0, 3});
    constraint_count_ = all.size();
    add_buffer(BIND_CONSTRAINTS, "constraints", all);
  }

  bool setting_is(const char* name, const char* value) const { return settings()[name] == value; }

  std::vector<std::uint32_t> contact_constants(bool friction) const {
    PaperSpecialization s;
    s.FRICTION = !friction ? 0 : setting_is("friction_on", "position") ? 1 : 2;
    s.PROJECT_PREVIOUS = setting_is("projection", "previous");
    s.OPPOSITE_NORMALS = setting_is("second_layer", "opposite");
    return s.by_number();
  }

  /// Collisions as published (Kim, Ma & Hong 2025, 3.2.3 to 3.2.6, Algorithms 3 and 4): every particle against every
  /// sphere, box, capsule and triangle, one stage and kernel per kind. Settings choose what the text leaves open.
  void build_contact() {
    const ColliderBuffers& c = *colliders();
    add_shapes("SatisfySphereCollisions", c.spheres, Feature::Sphere, "satisfy_sphere_collisions");
    add_shapes("SatisfyCubeCollisions", c.boxes, Feature::Box, "satisfy_cube_collisions");
    add_meshes("SatisfyMeshCollisions", c.static_meshes, Feature::StaticMesh, settings()["mesh_depth_m"].get<float>());
    add_meshes("SatisfyHandMeshCollisions", c.kinematic_meshes, Feature::MovingMesh,
               settings()["hand_depth_m"].get<float>());
    add_shapes("SatisfyCapsuleCollisions", c.capsules, Feature::Capsules, "satisfy_capsule_collisions");
  }

  void add_shapes(const char* stage_name, const ShapeBuffer& shapes, Feature kind, const char* name) {
    if (shapes.count == 0) return;
    const int stage = add_stage(stage_name, with_friction(kind, shapes.friction));
    const FrameKernel* kernel =
        add_kernel(stage, name, sizeof(PaperContactConstants), contact_constants(shapes.friction));
    contact_.emplace_back(kernel, PaperContactConstants{particles(), 0, shapes.count, 0, 0, 0, 0});
  }

  /// `depth_m`: maximum distance behind a triangle at which a particle still counts as touching it.
  void add_meshes(const char* stage_name, const MeshBuffers& meshes, Feature kind, float depth_m) {
    if (meshes.ranges.empty()) return;
    const bool friction =
        std::any_of(meshes.ranges.begin(), meshes.ranges.end(), [](const MeshRange& r) { return r.friction > 0; });
    const int stage = add_stage(stage_name, with_friction(kind, friction));
    const FrameKernel* kernel =
        add_kernel(stage, "satisfy_mesh_collisions", sizeof(PaperContactConstants), contact_constants(friction),
                   kGroupSize, {{BIND_TRIANGLES, meshes.triangles}, {BIND_MESH_VERTICES, meshes.positions}});
    const auto layer = static_cast<std::uint32_t>(scene().cloth.vertex_count());
    for (const MeshRange& r : meshes.ranges)
      contact_.emplace_back(kernel, PaperContactConstants{particles(), r.first_triangle, r.triangles, r.margin_m,
                                                          depth_m, r.friction, layer});
  }

  void build_stages() {
    const FeatureSet needs = scene().needs;
    const FeatureSet pins = needs & FeatureSet{Feature::Pins};
    const auto add = [&](int stage, const char* name) { return add_kernel(stage, name, sizeof(PaperConstants)); };
    forces_ = add(add_stage("ApplyExternalForces", {}), "apply_external_forces");
    if (needs.has(Feature::Damping)) damp_ = add(add_stage("DampVelocities", {Feature::Damping}), "damp_velocities");
    euler_ = add(add_stage("ApplyExplicitEuler", pins), "apply_explicit_euler");
    const FeatureSet edges{Feature::Stretch, Feature::Shear, Feature::Bend, Feature::DuplicatedLayer};
    project_ = add(add_stage("ProjectConstraintDeltas", needs & edges), "project_constraint_deltas");
    average_ = add(add_stage("AverageConstraintDeltas", {}), "average_constraint_deltas");
    if (grips() != nullptr) {
      hold_ = grips()->add_kernel(position_buffer());
      aim_ = grips()->add_kernel(*q_);
    }
    if (colliders() != nullptr) build_contact();
    PaperSpecialization update;
    if (needs.has(Feature::Friction) && setting_is("friction_on", "velocity")) {
      update.FRICTION = 2;
      add_buffer(BIND_SLIP, "slip", position_buffer().bytes());
    }
    update_ =
        add_kernel(add_stage("UpdatePositions", {}), "update_positions", sizeof(PaperConstants), update.by_number());
    if (settings()["readback"] == "blocking") {
      stage_readback_ = add_stage("Readback", {});
      host_x_ = &add_host_buffer("positions on the host", position_buffer().bytes());
      host_v_ = &add_host_buffer("velocities on the host", velocity_buffer().bytes());
    }
  }

  void record_frame(double dt_s, double) override {
    const Vec3 g = scene().gravity_m_per_s2;
    PaperConstants c{};
    c.gravity = {static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2]), 0};
    c.particles = particles();
    c.constraints = static_cast<std::uint32_t>(constraint_count_);
    if (colliders() != nullptr) colliders()->record();
    if (grips() != nullptr) grips()->record_upload();
    const int substeps = settings()["substeps"].get<int>();
    const double h = dt_s / substeps;
    c.h = static_cast<float>(h);
    c.stiffness = settings()["stiffness"].get<float>();
    c.relaxation = settings()["relaxation"].get<float>();
    c.keep = static_cast<float>(std::max(0.0, 1 - scene().material.damping_per_s * h));
    for (int s = 0; s < substeps; ++s) record_step(c, s, substeps, dt_s);
    if (stage_readback_ >= 0) {
      copy(stage_readback_, position_buffer(), *host_x_);
      copy(stage_readback_, velocity_buffer(), *host_v_);
    }
  }

  void record_step(const PaperConstants& c, int step, int steps, double dt_s) {
    // Attaches or releases vertices at the step's start; the kernels below read an inverse mass of 0 as attached.
    if (hold_ != nullptr) grips()->record_move(*hold_, static_cast<double>(step) / steps, dt_s);
    dispatch(*forces_, particles(), c);
    if (damp_ != nullptr) dispatch(*damp_, particles(), c);
    dispatch(*euler_, particles(), c);
    if (aim_ != nullptr) grips()->record_move(*aim_, static_cast<double>(step + 1) / steps, dt_s);
    for (int i = 0; i < settings()["iterations"].get<int>(); ++i) {
      dispatch(*project_, constraint_count_, c);
      dispatch(*average_, particles(), c);
      if (setting_is("collisions", "inside")) record_contact();
    }
    if (setting_is("collisions", "after")) record_contact();
    dispatch(*update_, particles(), c);
  }

  void record_contact() {
    for (const auto& [kernel, constants] : contact_) dispatch(*kernel, particles(), constants);
  }

  int layers_ = 1;
  std::uint64_t constraint_count_ = 0;
  int stage_readback_ = -1;
  const vulkan::Buffer *q_ = nullptr, *host_x_ = nullptr, *host_v_ = nullptr;
  const FrameKernel *forces_ = nullptr, *damp_ = nullptr, *euler_ = nullptr, *project_ = nullptr, *average_ = nullptr,
                    *update_ = nullptr, *hold_ = nullptr, *aim_ = nullptr;
  std::vector<std::pair<const FrameKernel*, PaperContactConstants>> contact_;
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
                   Feature::DuplicatedLayer, Feature::UnevenGrid, Feature::Spin,
                   Feature::ClothMesh};
  // Table 4 of the article: a single-sided cloth does not touch meshes.
  info.only_with = {{Feature::StaticMesh, Feature::DuplicatedLayer}, {Feature::MovingMesh, Feature::DuplicatedLayer}};
  info.settings = {
      {"iterations", "5", "constraint iterations per substep"},
      {"substeps", "1", "substeps per frame (the paper has one)"},
      {"stiffness", "0.8", "PBD's k, 0 to 1"},
      {"readback", "\"none\"", "none | blocking: copy positions and velocities to the host every frame and wait"},
      {"mesh_depth_m", "0.03", "a particle at most this far behind a triangle of a static mesh touches it"},
      {"hand_depth_m", "0.01", "as mesh_depth_m, for the mesh of a hand"},
      {"relaxation", "1.0", "factor of the averaged corrections; above 1: over-relaxation"},
      {"collisions", "\"after\"", "after | inside: collide after all iterations (Algorithm 1) or in each of them"},
      {"projection", "\"predicted\"", "predicted | previous: positions that are tested against colliders"},
      {"second_layer", "\"same\"", "same | opposite: side of a triangle to which the duplicated layer is pushed"},
      {"friction_on", "\"position\"", "position | velocity: friction reduces tangential displacement or only velocity"},
      {"stage_times", "false", "timestamps around every stage (slower; for profiling)"},
      {"count_bytes", "false", "kernels count the bytes that they load and store (slower)"}};
  return info;
}

std::unique_ptr<GpuSolver> make_paper(const nlohmann::json& settings, const DeviceOptions& device) {
  require_one_of("paper", settings, "readback", {"none", "blocking"});
  require_one_of("paper", settings, "collisions", {"after", "inside"});
  require_one_of("paper", settings, "projection", {"predicted", "previous"});
  require_one_of("paper", settings, "second_layer", {"same", "opposite"});
  require_one_of("paper", settings, "friction_on", {"position", "velocity"});
  require_between("paper", settings, "relaxation", 0.1, 2);
  require_between("paper", settings, "iterations", 1, 100000);
  require_between("paper", settings, "substeps", 1, 4096);
  require_between("paper", settings, "stiffness", 0, 1);
  for (const char* key : {"mesh_depth_m", "hand_depth_m"}) require_between("paper", settings, key, 0, 1000);
  return std::make_unique<Paper>(paper_info(), settings, device);
}

/// Every substep: v <- (v + g h) keep, x <- x + h v; damping comes after the forces.
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
