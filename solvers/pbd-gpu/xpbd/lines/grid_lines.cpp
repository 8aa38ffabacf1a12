#include "xpbd/lines/grid_lines.hpp"

#include <algorithm>
#include <cmath>

#include "xpbd/grid_barrier.hpp"

namespace clothbench::pbd_gpu {

/// Threads per workgroup if many workgroups share lines and contact. A line needs only 32, but pairs and vertices use
/// all threads: a desk takes 3.4 times as long with 32, and no less time with 256 (H200).
constexpr std::uint32_t kThreadsWithContact = 128;

Lines::Lines(FrameBuilder& frame, const Scene& scene, bool uses_bdf2, bool tension, bool corrects_splitting)
    : frame_(frame),
      scene_(scene),
      tethers_(tethers_of(scene, frame.settings()["tethers"].get<bool>())),
      uses_bdf2_(uses_bdf2),
      tension_(tension),
      corrects_splitting_(corrects_splitting) {
  if (tethers_.to.empty()) frame_.disable("tethers", tethers_.reason);
  const std::size_t n = scene.cloth.vertex_count();
  std::vector<float> smallest;
  for (const std::uint8_t over_constrained : over_constrained_lines(scene)) {
    smallest.push_back(over_constrained != 0 ? static_cast<float>(kRegularisation) : 0.0f);
    regularised_ = regularised_ || over_constrained != 0;
  }
  if (regularised_) frame_.add_buffer(BIND_REGULARISATION, "regularisation", smallest);
  if (!corrects_splitting_) return;
  frame_.add_buffer(BIND_SHIFTS, "shifts by columns and rows", n * sizeof(vec4));
  frame_.add_buffer(BIND_LINK_CREEP, "creep of links", passes() * n * sizeof(float));
}

void Lines::add_kernels(bool any_masses) {
  const LineShape one_group = single_dispatch_shape();
  const bool scaled = !scene_.cloth.mass_factors.empty();
  moves_grips_ = one_group.threads > 0 && !any_masses && !scaled;
  if (moves_grips_) {
    shape_ = {one_group, one_group};
    substeps_ = frame_.add_kernel(frame_.add_stage("Lines", scene_.needs & kLineFeatures), "line_frame",
                                  sizeof(LineConstants), specialization(one_group).by_number(), one_group.threads);
  } else if (scaled || !add_persistent()) {
    add_passes();
  }
}

LineRequest Lines::request() const {
  return {frame_.tuning()["vertices_a_thread"].get<std::uint32_t>(),
          frame_.tuning()["threads_a_group"].get<std::uint32_t>(), frame_.tuning()["lines_beside"].get<std::uint32_t>(),
          corrects_splitting_};
}

LineDevice Lines::device() const {
  const vulkan::Device& d = *frame_.device();
  LineDevice line;
  line.subgroup = d.shuffled_lanes();
  line.max_threads = std::min(d.limits().maxComputeWorkGroupInvocations, d.limits().maxComputeWorkGroupSize[0]);
  line.wide = d.is_discrete();
  line.shared_B =
      line.wide ? d.limits().maxComputeSharedMemorySize : std::min(d.limits().maxComputeSharedMemorySize, 32768u);
  return line;
}

LineSpecialization Lines::specialization(const LineShape& shape) const {
  LineSpecialization s;
  s.LANES = shape.lanes;
  s.K = shape.vertices;
  s.COLUMNS = static_cast<std::uint32_t>(scene_.cloth.columns);
  s.ROWS = static_cast<std::uint32_t>(scene_.cloth.rows);
  s.THREADS = shape.threads;
  if (scene_.needs.has(Feature::Bend)) s.FEATURES |= LINES_BEND;
  if (scene_.needs.has(Feature::Shear)) s.FEATURES |= LINES_SHEAR;
  if (scene_.material.membrane_stiffness_N_per_m) s.FEATURES |= LINES_ELASTIC;
  if (regularised_) s.FEATURES |= LINES_REGULARISED;
  if (uses_bdf2_) s.FEATURES |= LINES_BDF2;
  if (tension_) s.FEATURES |= LINES_TENSION;
  if (corrects_splitting_) s.FEATURES |= LINES_SPLITTING;
  s.GRIPS = static_cast<std::uint32_t>(scene_.grips.vertices.size());
  s.TETHERS = static_cast<std::uint32_t>(tethers_.to.size());
  uint* const ends[Tethers::kMax][2] = {{&s.TETHER_0, &s.TETHER_0_LAST},
                                        {&s.TETHER_1, &s.TETHER_1_LAST},
                                        {&s.TETHER_2, &s.TETHER_2_LAST},
                                        {&s.TETHER_3, &s.TETHER_3_LAST}};
  for (std::size_t k = 0; k < tethers_.to.size(); ++k) {
    const PinnedRectangle& r = tethers_.to[k];
    *ends[k][0] = r.first_column | r.first_row << 16;
    *ends[k][1] = r.last_column | r.last_row << 16;
  }
  s.SUBGROUP = device().subgroup;
  s.BESIDE = shape.beside;
  const bool square =
      s.COLUMNS == s.ROWS && shape.lanes * shape.vertices == s.COLUMNS && s.COLUMNS % shape.chains_a_group() == 0;
  s.EXACT = square ? 1 : 0;
  return s;
}

vulkan::Groups Lines::groups_of(const LineShape& shape) const {
  const auto chains = static_cast<std::uint32_t>(std::max(scene_.cloth.columns, scene_.cloth.rows));
  return vulkan::groups_for(chains, shape.chains_a_group());
}

LineShape Lines::single_dispatch_shape() const {
  return frame_shape(scene_.cloth.columns, scene_.cloth.rows, request(), device());
}

LineShape Lines::shape_with_contact() const {
  LineRequest wanted = request();
  if (wanted.threads == 0 && device().wide) wanted.threads = kThreadsWithContact;
  return pass_shape(std::max(scene_.cloth.columns, scene_.cloth.rows), wanted, device());
}

LineSpecialization Lines::persistent_specialization(const LineShape& shape) {
  shape_ = {shape, shape};
  LineSpecialization s = specialization(shape);
  s.PERSISTENT = 1;
  return s;
}

/// False if the device does not run all workgroups at once, or if that is not tested.
bool Lines::add_persistent() {
  const LineShape shape = pass_shape(std::max(scene_.cloth.columns, scene_.cloth.rows), request(), device());
  const std::vector<std::uint32_t> constants = persistent_specialization(shape).by_number();
  if (!runs_at_once<LineConstants>(frame_, "line_pass", constants, shape.threads, groups_of(shape))) return false;
  const int stage = frame_.add_stage("Lines", scene_.needs & (kLineFeatures - FeatureSet{Feature::MovingPins}));
  add_grid_barrier(frame_);
  substeps_ = frame_.add_kernel(stage, "line_pass", sizeof(LineConstants), constants, shape.threads);
  return true;
}

void Lines::add_passes() {
  shape_ = {pass_shape(scene_.cloth.columns, request(), device()), pass_shape(scene_.cloth.rows, request(), device())};
  const char* const names[] = {"Rows", "Columns", "Diagonals"};
  const FeatureSet serves[] = {{Feature::Stretch, Feature::Bend, Feature::Damping, Feature::Pins},
                               {Feature::Stretch, Feature::Bend},
                               {Feature::Shear}};
  for (std::size_t k = 0; k < (scene_.needs.has(Feature::Shear) ? 3u : 2u); ++k) {
    const LineShape& shape = shape_[std::min<std::size_t>(k, 1)];
    pass_[k] = frame_.add_kernel(frame_.add_stage(names[k], scene_.needs & serves[k]), "line_pass",
                                 sizeof(LineConstants), specialization(shape).by_number(), shape.threads);
  }
}

LineConstants Lines::constants(double dt_s, int substeps, const TimeStep& step) const {
  const Cloth& cloth = scene_.cloth;
  const double h = step.implicit_h_s, du = cloth.du(), dv = cloth.dv();
  const auto f = [](double x) { return static_cast<float>(x); };
  auto c = step_constants<LineConstants>(frame_, step);
  c.kick_scale = f(step.kick_scale);
  c.tether_stretch = f(tethers_.stretch);
  c.rest_u = f(du);
  c.rest_v = f(dv);
  c.rest_d = f(std::hypot(du, dv));
  if (const auto Y = scene_.material.membrane_stiffness_N_per_m) {
    const bool shears = scene_.needs.has(Feature::Shear);
    c.alpha_u = f(1 / (grid_spring_N_per_m(*Y, {du, dv}, shears) * h * h * step.force_scale));
    c.alpha_v = f(1 / (grid_spring_N_per_m(*Y, {dv, du}, shears) * h * h * step.force_scale));
    if (shears) c.alpha_d = f(1 / (diagonal_spring_N_per_m(*Y, {du, dv}) * h * h * step.force_scale));
  }
  const double mass = cloth.areal_density_kg_per_m2 * du * dv;
  if (scene_.needs.has(Feature::Bend)) {
    const double B = scene_.material.bending_rigidity_N_m;
    c.bend_u = f(du * du * du / (B * dv) / (h * h * step.force_scale));
    c.bend_v = f(dv * dv * dv / (B * du) / (h * h * step.force_scale));
    c.bend_rounds_u = bend_rounds(static_cast<double>(c.bend_u), 4 / mass, shape_[0]);
    c.bend_rounds_v = bend_rounds(static_cast<double>(c.bend_v), 4 / mass, shape_[1]);
  }
  c.inverse_mass = f(1 / mass);
  c.substep_part = f(1.0 / substeps);
  c.frames_per_s = f(1 / dt_s);
  return c;
}

void Lines::record(int first, int count, int substeps, double dt_s, const TimeStep& step) {
  LineConstants c = constants(dt_s, substeps, step);
  c.first_substep = static_cast<std::uint32_t>(first);
  c.substeps = static_cast<std::uint32_t>(count);
  if (substeps_ != nullptr) {
    c.passes = c.substeps * passes();
    frame_.dispatch_groups(*substeps_, groups_of(shape_[0]), c);
    return;
  }
  c.passes = 1;
  for (c.first_pass = 0; c.first_pass < passes(); ++c.first_pass) {
    // Diagonals are solved first, then columns, then rows: the constraints along warp and weft are satisfied best.
    const std::uint32_t colour = passes() - 1 - c.first_pass;
    const auto chains = static_cast<std::uint32_t>(colour == 0 ? scene_.cloth.rows : scene_.cloth.columns);
    frame_.dispatch_groups(*pass_[std::min(colour, 2u)],
                           vulkan::groups_for(chains, shape_[std::min(colour, 1u)].chains_a_group()), c);
  }
}

}  // namespace clothbench::pbd_gpu
