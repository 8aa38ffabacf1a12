// XPBD in small steps: Macklin, Müller & Chentanez 2016; Macklin et al. 2019. Coloured Gauss-Seidel, no atomics.
#include <algorithm>
#include <cmath>

#include "gpu_solver.hpp"
#include "xpbd_contact.hpp"

namespace clothbench::pbd_gpu {
namespace {

using vulkan::Access;

/// Springs whose homogenised sheet is isotropic with uniaxial stiffness Y and Poisson ratio 1/3, the only ratio central
/// springs allow (C12 = C66): for square cells 3/4 Y along the grid and 3/8 Y on each diagonal. On du x dv cells the
/// same conditions give the values below; beyond an aspect of about 1.6 the grid spring would fall under a tenth of
/// its strip's stiffness and is held there, which makes the sheet stiffer than Y. Without shear: strips of stiffness Y.
struct Springs {
  double along_u, along_v, diagonal;  // N/m
};

Springs springs(double Y, double du, double dv, bool shear) {
  if (!shear) return {Y * dv / du, Y * du / dv, 0};
  const double diagonal = 3.0 / 16 * Y * (du * du + dv * dv) / (du * dv);
  const auto along = [Y](double length, double width) {
    return Y * std::max(9.0 / 8 * width / length - 3.0 / 8 * length / width, 0.1 * width / length);
  };
  return {along(du, dv), along(dv, du), diagonal};
}

/// Constraints of one direction and their colours; see XpbdConstants.
struct Family {
  int di, dj;
  std::uint32_t reach, stride;  // how far the last vertex lies; colours
  double rest_m, compliance;    // m/N
};

class Xpbd final : public GpuSolver {
 public:
  using GpuSolver::GpuSolver;

 private:
  void build() override {
    const std::vector<double> start = initial_positions(scene());
    const std::vector<float>& w = inverse_mass_now();
    const Vec3 v0 = scene().cloth.initial_velocity_m_per_s, origin = scene().cloth.center_m;
    vec4s position, velocity;
    for (std::size_t i = 0; i < w.size(); ++i) {
      // Relative to the cloth's first centre: a scene far from the world's origin loses no digits.
      const auto at = [&](std::size_t k) { return static_cast<float>(start[3 * i + k] - origin[k]); };
      const auto speed = [&](std::size_t k) { return w[i] > 0 ? static_cast<float>(v0[k]) : 0.0f; };
      position.push_back({at(0), at(1), at(2), w[i]});
      velocity.push_back({speed(0), speed(1), speed(2), 0});
    }
    x_ = &add_vec4_buffer("positions", position);
    v_ = &add_vec4_buffer("velocities", velocity);
    rx_ = &add_buffer("position rests", x_->bytes());
    rv_ = &add_buffer("velocity rests", v_->bytes());
    set_state(*x_, *v_, origin);
    add_colliders(origin, true);
    build_families();
    build_stages(origin);
  }

  void build_families() {
    const Cloth& c = scene().cloth;
    const double du = c.du(), dv = c.dv();
    Springs k{INFINITY, INFINITY, INFINITY};
    if (const auto Y = scene().material.membrane_stiffness_N_per_m) k = springs(*Y, du, dv, scene().needs.has(Feature::Shear));
    stretch_ = {{1, 0, 1, 2, du, 1 / k.along_u}, {0, 1, 1, 2, dv, 1 / k.along_v}};
    if (scene().needs.has(Feature::Shear))
      shear_ = {{1, 1, 1, 2, std::hypot(du, dv), 1 / k.diagonal}, {-1, 1, 1, 2, std::hypot(du, dv), 1 / k.diagonal}};
    // E = (B w / 2 a^3) |x0 - 2 x1 + x2|^2 on each line, w the strip's width.
    if (const double B = scene().material.bending_rigidity_N_m; scene().needs.has(Feature::Bend))
      bend_ = {{1, 0, 2, 3, 0, du * du * du / (B * dv)}, {0, 1, 2, 3, 0, dv * dv * dv / (B * du)}};
  }

  void build_stages(Vec3 origin) {
    const FeatureSet needs = scene().needs;
    const auto push = static_cast<std::uint32_t>(sizeof(XpbdConstants));
    const bool damped = needs.has(Feature::Damping);
    stage_integrate_ = add_stage("Integrate", needs & FeatureSet{Feature::Damping, Feature::Pins});
    integrate_ = &add_kernel(
        stage_integrate_, shaders::kIntegrate,
        {{x_, Access::ReadWrite}, {v_, Access::ReadWrite}, {rx_, Access::ReadWrite}, {rv_, Access::ReadWrite}}, push,
        {damped ? 1u : 0u});
    add_grips(origin, 1);
    if (grips() != nullptr) move_grips_ = &grips()->add_kernel(*x_, *v_);
    if (!damped) leave_out("damping", "the scene has none");
    const bool keep = settings()["iterations"].get<int>() > 1;
    const Shader& distance = keep ? shaders::kProjectDistanceIterated : shaders::kProjectDistance;
    const auto state = [&](const char* name, std::uint64_t multiplier_bytes) {
      std::vector<vulkan::Binding> b = {{x_, Access::ReadWrite}, {v_, Access::ReadWrite}};
      // Two families each; a constraint is named by its first vertex.
      if (keep) b.push_back({&add_buffer(name, 2 * inverse_mass_now().size() * multiplier_bytes), Access::ReadWrite});
      return b;
    };
    if (!keep) leave_out("multipliers", "setting iterations=1: they would start at 0 and be dropped");
    stage_stretch_ = add_stage("ProjectStretch", {Feature::Stretch});
    distance_ = &add_kernel(stage_stretch_, distance, state("stretch multipliers", 4), push);
    if (needs.has(Feature::Shear)) {
      stage_shear_ = add_stage("ProjectShear", {Feature::Shear});
      shear_distance_ = &add_kernel(stage_shear_, distance, state("shear multipliers", 4), push);
    } else {
      leave_out("ProjectShear", "the scene has no shear stiffness");
    }
    if (needs.has(Feature::Bend)) {
      stage_bend_ = add_stage("ProjectBending", {Feature::Bend});
      bending_ = &add_kernel(stage_bend_, keep ? shaders::kProjectBendingIterated : shaders::kProjectBending,
                             state("bending multipliers", 16), push);
    } else {
      leave_out("ProjectBending", "the scene has no bending");
    }
    if ((needs & kColliderFeatures).empty())
      leave_out("contact", "the scene has no collider");
    else
      contact_ = std::make_unique<XpbdContact>(*this, scene(), origin, *colliders(), *x_, *v_,
                                               settings()["contact_samples"].get<std::uint32_t>());
  }

  /// Bytes of one dispatch: with m = vertices of a constraint, 16 m for positions, and another 16 m read and 32 m
  /// written where one of them is free; kept multipliers are read from the second iteration on and written in each.
  Traffic traffic(const Family& f, std::uint32_t colour, int vertices, std::uint32_t iteration) const {
    Traffic t;
    const double multiplier = settings()["iterations"].get<int>() == 1 ? 0 : vertices == 3 ? 16 : 4;
    for_each(f, colour, [&](std::size_t first, std::size_t step) {
      bool any_free = false;
      for (int k = 0; k < vertices; ++k) any_free |= inverse_mass_now()[first + static_cast<std::size_t>(k) * step] > 0;
      t.read_B += 16.0 * vertices * (any_free ? 2 : 1) + (any_free && iteration > 0 ? multiplier : 0);
      t.write_B += any_free ? 32.0 * vertices + multiplier : 0.0;
    });
    return t;
  }

  template <class Fn>
  void for_each(const Family& f, std::uint32_t colour, Fn fn) const {
    const Cloth& c = scene().cloth;
    const int reach = static_cast<int>(f.reach);
    for (int j = 0; j + f.dj * reach < c.rows; ++j)
      for (int i = std::max(0, -f.di); i + std::max(0, f.di) * reach < c.columns; ++i)
        if (static_cast<std::uint32_t>(f.dj == 0 ? i : j) % f.stride == colour)
          fn(static_cast<std::size_t>(j * c.columns + i), static_cast<std::size_t>(f.dj * c.columns + f.di));
  }

  void project(int stage, const vulkan::Kernel& kernel, const Family& f, XpbdConstants c, int vertices) {
    const std::uint32_t columns = c.columns, rows = c.rows;
    const auto across = f.di == 0 ? columns : columns - f.reach;  // valid i
    const auto down = f.dj == 0 ? rows : rows - f.reach;          // valid j
    if ((f.di != 0 && columns <= f.reach) || (f.dj != 0 && rows <= f.reach)) return;
    const std::uint32_t strided = f.dj == 0 ? across : down;
    c.di = f.di;
    c.dj = f.dj;
    c.stride = f.stride;
    c.along = f.dj == 0 ? down : across;
    c.i_first = f.di < 0 ? 1 : 0;
    c.rest_m = static_cast<float>(f.rest_m);
    const double alpha = f.compliance / (static_cast<double>(c.h) * c.h);
    c.alpha = static_cast<float>(alpha);
    c.alpha_border = static_cast<float>(2 * alpha);
    for (std::uint32_t colour = 0; colour < f.stride && colour < strided; ++colour) {
      c.colour = colour;
      c.count = c.along * ((strided - colour + f.stride - 1) / f.stride);
      dispatch(stage, kernel, c.count, c, traffic(f, colour, vertices, c.iteration));
    }
  }

  void record_frame(double dt_s) override {
    const int substeps = settings()["substeps"].get<int>();
    const double h = dt_s / substeps;
    const Vec3 g = scene().gravity_m_per_s2;
    XpbdConstants c{};
    c.gravity_h = {static_cast<float>(g[0] * h), static_cast<float>(g[1] * h), static_cast<float>(g[2] * h), 0};
    c.columns = static_cast<std::uint32_t>(scene().cloth.columns);
    c.rows = static_cast<std::uint32_t>(scene().cloth.rows);
    c.h = static_cast<float>(h);
    c.loss = static_cast<float>(-std::expm1(-scene().material.damping_per_s * h));
    const std::vector<float>& w = inverse_mass_now();
    const auto n = static_cast<double>(w.size());
    const auto f = static_cast<double>(std::count_if(w.begin(), w.end(), [](float w_i) { return w_i > 0; }));
    struct Constraints {
      int stage;
      const vulkan::Kernel* kernel;
      const std::vector<Family>* families;
      int vertices;
    };
    const Constraints constraints[] = {{stage_stretch_, distance_, &stretch_, 2},
                                       {stage_shear_, shear_distance_, &shear_, 2},
                                       {stage_bend_, bending_, &bend_, 3}};
    const auto iterations = settings()["iterations"].get<std::uint32_t>();
    if (colliders() != nullptr) colliders()->record();
    if (grips() != nullptr) grips()->record_upload();
    if (contact_) contact_->record_frame(dt_s, substeps);
    for (int s = 0; s < substeps; ++s) {
      // First, so that a vertex let go is free in all of its frame.
      if (move_grips_ != nullptr) grips()->record_move(*move_grips_, (s + 1.0) / substeps, dt_s);
      dispatch(stage_integrate_, *integrate_, w.size(), c, {16 * n + 48 * f, 64 * f});
      for (c.iteration = 0; c.iteration < iterations; ++c.iteration) {
        for (const auto& [stage, kernel, families, vertices] : constraints)
          for (std::size_t k = 0; k < families->size(); ++k) {
            c.multiplier_first = static_cast<std::uint32_t>(k * w.size());
            project(stage, *kernel, (*families)[k], c, vertices);
          }
      }
      if (contact_) contact_->record_substep(s, substeps, dt_s);
    }
  }

  std::unique_ptr<XpbdContact> contact_;
  std::vector<Family> stretch_, shear_, bend_;
  int stage_integrate_ = -1, stage_stretch_ = -1, stage_shear_ = -1, stage_bend_ = -1;
  vulkan::Buffer *x_ = nullptr, *v_ = nullptr, *rx_ = nullptr, *rv_ = nullptr;
  vulkan::Kernel *integrate_ = nullptr, *distance_ = nullptr, *shear_distance_ = nullptr, *bending_ = nullptr;
  const vulkan::Kernel* move_grips_ = nullptr;
};

}  // namespace

SolverInfo xpbd_info() {
  SolverInfo info;
  info.name = "xpbd";
  info.folder = "solvers/pbd-gpu";
  info.summary = "extended PBD in small steps: physical compliance, coloured Gauss-Seidel, bitwise repeatable";
  info.version = "1";
  info.precision = "float32";
  info.on_gpu = true;
  info.supports = {Feature::Stretch,    Feature::Shear,      Feature::Bend,     Feature::Damping,    Feature::Pins,
                   Feature::MovingPins, Feature::Sphere,     Feature::Box,      Feature::Plane,      Feature::Capsules,
                   Feature::StaticMesh, Feature::MovingMesh, Feature::Friction, Feature::DoubleSided};
  info.settings = {
      {"substeps", "10", "substeps a frame"},
      {"iterations", "1", "constraint iterations a substep; multipliers start at 0 in each substep"},
      {"contact_samples", "1", "points on each edge that take part in contact beside its two vertices, 0 to 16"},
      {"stage_times", "false", "timestamps around every stage (slower; for profiling)"}};
  return info;
}

std::unique_ptr<GpuSolver> make_xpbd(const nlohmann::json& settings, const DeviceOptions& device, bool count_bytes) {
  if (!(settings["substeps"].get<double>() >= 1 && settings["substeps"].get<double>() <= 4096))
    throw Error("solver xpbd: setting substeps: expected 1 to 4096; found " + settings["substeps"].dump());
  if (!(settings["iterations"].get<double>() >= 1 && settings["iterations"].get<double>() <= 4096))
    throw Error("solver xpbd: setting iterations: expected 1 to 4096; found " + settings["iterations"].dump());
  if (!(settings["contact_samples"].get<double>() >= 0 && settings["contact_samples"].get<double>() <= 16))
    throw Error("solver xpbd: setting contact_samples: expected 0 to 16; found " + settings["contact_samples"].dump());
  return std::make_unique<Xpbd>(xpbd_info(), settings, device, count_bytes);
}

/// v <- v + g h - (1 - e^{-c h}) v, x <- x + h v, every substep.
double xpbd_free_fall_m(const Scene& scene, const nlohmann::json& settings, int frames) {
  const int substeps = settings["substeps"].get<int>();
  const double h = scene.time.dt() / substeps, g = scene.gravity_m_per_s2[1];
  const double loss = scene.needs.has(Feature::Damping) ? -std::expm1(-scene.material.damping_per_s * h) : 0;
  double v = scene.cloth.initial_velocity_m_per_s[1], x = 0;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    v += g * h - loss * v;
    x += v * h;
  }
  return x;
}

}  // namespace clothbench::pbd_gpu
