#include "lines.hpp"

#include <algorithm>
#include <cmath>

#include "crumpled.hpp"
#include "resident.hpp"

namespace clothbench::pbd_gpu {
namespace {

using vulkan::Access;

/// Least alpha over inverse mass of chains that are pulled taut between held vertices: singular in single precision
/// without. Ten times as much shows in the length of the cloth, a tenth lets links of some cloths blow up.
constexpr double kFirmness = 1e-3;

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

Tethers tethers_if(bool wanted, const Scene& scene) {
  if (wanted) return tethers_of(scene);
  Tethers none;
  none.why_not = "setting tethers=false";
  return none;
}

}  // namespace

Lines::Lines(GpuSolver& solver, const Scene& scene, const vulkan::Buffer& x, const vulkan::Buffer& v,
             const vulkan::Buffer& rx, const vulkan::Buffer& rv)
    : solver_(solver),
      scene_(scene),
      x_(x),
      v_(v),
      rx_(rx),
      rv_(rv),
      tethers_(tethers_if(solver.settings()["tethers"].get<bool>(), scene)),
      taut_(taut_chains(scene)),
      iterations_(solver.settings()["iterations"].get<std::uint32_t>()),
      batch_(solver.settings()["batch"].get<std::uint32_t>()),
      keep_(iterations_ > 1 && (scene.material.membrane_stiffness_N_per_m || scene.needs.has(Feature::Bend))),
      firm_(std::any_of(taut_.begin(), taut_.end(), [](std::uint8_t t) { return t != 0; })) {
  if (tethers_.to.empty()) solver_.leave_out("tethers", tethers_.why_not);
  if (!scene.needs.has(Feature::Damping)) solver_.leave_out("damping", "the scene has none");
  if (!scene.needs.has(Feature::Shear)) solver_.leave_out("diagonals", "the scene has no shear stiffness");
  if (!scene.needs.has(Feature::Bend)) solver_.leave_out("bending", "the scene has no bending");
  if (!keep_)
    solver_.leave_out("multipliers", iterations_ > 1 ? "nothing is compliant"
                                                     : "setting iterations=1: they would start at 0 and be dropped");
  const std::size_t n = scene.cloth.vertex_count();
  if (keep_ && scene.material.membrane_stiffness_N_per_m)
    link_multipliers_ = &solver_.add_buffer("link multipliers", (scene.needs.has(Feature::Shear) ? 4 : 2) * n * 4);
  if (keep_ && scene.needs.has(Feature::Bend))
    hinge_multipliers_ = &solver_.add_buffer("hinge multipliers", 2 * n * sizeof(vec4));
  const bool one = solver.settings()["one_dispatch"].get<bool>();
  const LineShape frame = frame_shape(scene.cloth.columns, scene.cloth.rows, wish(), device());
  if (frame.threads > 0 && one)
    add_frame(frame);
  else if (batch_ > 1)
    throw Error(
        "solver xpbd: setting batch: takes cloths that fit one workgroup each (32 x 32 vertices, one_dispatch)");
  else if (!one || !add_resident())
    add_passes();
  if (batch_ > 1 && (keep_ || !scene.grips.vertices.empty() || !scene.colliders.empty()))
    throw Error(
        "solver xpbd: setting batch: takes no hands, no colliders, and one iteration a substep where anything is "
        "compliant");
}

LineWish Lines::wish() const {
  return {solver_.tuning()["vertices_a_thread"].get<std::uint32_t>(),
          solver_.tuning()["threads_a_group"].get<std::uint32_t>(),
          solver_.tuning()["lines_beside"].get<std::uint32_t>()};
}

LineDevice Lines::device() const {
  const vulkan::Device& d = solver_.vulkan_device();
  LineDevice line;
  if (solver_.tuning()["shuffles"].get<bool>()) line.subgroup = d.shuffled_lanes();
  line.most_threads = std::min(d.limits().maxComputeWorkGroupInvocations, d.limits().maxComputeWorkGroupSize[0]);
  line.wide = d.is_discrete();
  line.shared_B =
      line.wide ? d.limits().maxComputeSharedMemorySize : std::min(d.limits().maxComputeSharedMemorySize, 32768u);
  return line;
}

std::uint32_t Lines::features() const {
  const FeatureSet needs = scene_.needs;
  std::uint32_t f = 0;
  if (needs.has(Feature::Damping)) f |= LINES_DAMPING;
  if (needs.has(Feature::Bend)) f |= LINES_BEND;
  if (needs.has(Feature::Shear)) f |= LINES_SHEAR;
  if (scene_.material.membrane_stiffness_N_per_m) f |= LINES_ELASTIC;
  // What moves may drive the cloth as fast as it likes, and so may springs that start stretched.
  const bool driven = needs.has(Feature::MovingMesh) || needs.has(Feature::Capsules);
  if ((!tethers_.to.empty() || starts_crumpled(scene_)) && !driven) f |= LINES_LIMIT_SPEED;
  if (firm_) f |= LINES_FIRM;
  return f;
}

std::vector<std::uint32_t> Lines::specialization(const LineShape& shape) const {
  std::vector<std::uint32_t> s = {shape.lanes,
                                  shape.vertices,
                                  static_cast<std::uint32_t>(scene_.cloth.columns),
                                  static_cast<std::uint32_t>(scene_.cloth.rows),
                                  shape.threads,
                                  features(),
                                  static_cast<std::uint32_t>(tethers_.to.size())};
  for (std::size_t k = 0; k < Tethers::kMost; ++k) {
    const PinnedRectangle r = k < tethers_.to.size() ? tethers_.to[k] : PinnedRectangle{};
    s.push_back(r.first_column | r.first_row << 16);
    s.push_back(r.last_column | r.last_row << 16);
  }
  s.push_back(std::max(1u, device().subgroup));
  s.push_back(shape.beside);
  const auto columns = static_cast<std::uint32_t>(scene_.cloth.columns),
             rows = static_cast<std::uint32_t>(scene_.cloth.rows);
  const bool square =
      columns == rows && shape.lanes * shape.vertices == columns && columns % shape.chains_a_group() == 0;
  s.push_back(square ? 1 : 0);
  return s;
}

std::vector<vulkan::Binding> Lines::bindings(const vulkan::Buffer* fifth) {
  // What the scene lacks is never touched: the positions stand in.
  std::vector<vulkan::Binding> b = {{&x_, Access::ReadWrite},
                                    {&v_, Access::ReadWrite},
                                    {&rx_, Access::ReadWrite},
                                    {&rv_, Access::ReadWrite},
                                    {fifth != nullptr ? fifth : &x_, Access::Read}};
  if (!keep_) return b;
  b.push_back({link_multipliers_ != nullptr ? link_multipliers_ : &x_, Access::ReadWrite});
  b.push_back({hinge_multipliers_ != nullptr ? hinge_multipliers_ : &x_, Access::ReadWrite});
  return b;
}

void Lines::add_frame(const LineShape& shape) {
  const FeatureSet serves{Feature::Stretch, Feature::Shear,      Feature::Bend,
                          Feature::Damping, Feature::MovingPins, Feature::Pins};
  stage_frame_ = solver_.add_stage("Lines", scene_.needs & serves);
  shape_[0] = shape_[1] = shape_[2] = shape;
  std::vector<std::uint32_t> s = specialization(shape);
  s.push_back(static_cast<std::uint32_t>(scene_.grips.vertices.size()));
  const auto most = static_cast<std::size_t>(std::max(scene_.cloth.columns, scene_.cloth.rows));
  for (std::size_t family = 0; family < 4; ++family) {
    std::uint32_t bits = 0;
    for (std::size_t chain = 0; chain < most; ++chain) bits |= std::uint32_t{taut_[family * most + chain]} << chain;
    s.push_back(bits);
  }
  const vulkan::Buffer* grips = solver_.grips() != nullptr ? &solver_.grips()->buffer() : nullptr;
  frame_ = &solver_.add_kernel(stage_frame_, shaders::kLineFrame[shape.shuffles ? 1 : 0][keep_ ? 1 : 0],
                               bindings(grips), sizeof(LineConstants), s, shape.threads);
}

void Lines::add_firmness() {
  if (!firm_) return;
  std::vector<std::uint8_t> bytes(taut_.size() * 4);
  for (std::size_t k = 0; k < taut_.size(); ++k) {
    const float least = taut_[k] != 0 ? static_cast<float>(kFirmness) : 0.0f;
    std::memcpy(&bytes[4 * k], &least, 4);
  }
  firmness_ = &solver_.add_buffer("firmness", bytes.size(), bytes);
}

/// False where the device does not run all workgroups at once, or nobody can tell.
bool Lines::add_resident() {
  const std::string wanted = solver_.tuning()["device_barrier"];
  const bool may = wanted == "always" || (wanted == "auto" && device().wide);
  if (!may || device().subgroup == 0) return false;
  const LineShape shape = pass_shape(std::max(scene_.cloth.columns, scene_.cloth.rows), wish(), device());
  const auto chains = static_cast<std::uint32_t>(std::max(scene_.cloth.columns, scene_.cloth.rows));
  const vulkan::Groups groups = vulkan::groups_for(chains, shape.chains_a_group());
  const auto with_barrier = [&](const vulkan::Buffer& m, const vulkan::Buffer& none) {
    std::vector<vulkan::Binding> b = bindings(firmness_);
    b.push_back({&m, Access::ReadWrite});
    b.push_back({&none, Access::Write});
    return b;
  };
  const std::vector<std::uint32_t> s = specialization(shape);
  if (!runs_at_once(solver_.device_, shaders::kLinesResident[keep_ ? 1 : 0], s, shape.threads, with_barrier, groups,
                    LineConstants{}, wanted == "always"))
    return false;
  add_firmness();
  shape_[0] = shape_[1] = shape_[2] = shape;
  const FeatureSet serves{Feature::Stretch, Feature::Shear, Feature::Bend, Feature::Damping, Feature::Pins};
  stage_frame_ = solver_.add_stage("Lines", scene_.needs & serves);
  meeting_ = &solver_.add_buffer("meeting", 8);
  vulkan::Buffer& host = solver_.add_host_buffer("missed", 4);
  std::memset(host.mapped(), 0, 4);
  solver_.set_missed(host);
  missed_ = &host;
  resident_ = &solver_.add_kernel(stage_frame_, shaders::kLinesResident[keep_ ? 1 : 0], with_barrier(*meeting_, host),
                                  sizeof(LineConstants), s, shape.threads);
  return true;
}

void Lines::add_passes() {
  const FeatureSet needs = scene_.needs;
  shape_[0] = pass_shape(scene_.cloth.columns, wish(), device());
  shape_[1] = shape_[2] = pass_shape(scene_.cloth.rows, wish(), device());
  add_firmness();
  const char* const names[] = {"Rows", "Columns", "Diagonals"};
  const FeatureSet serves[] = {{Feature::Stretch, Feature::Bend, Feature::Damping, Feature::Pins},
                               {Feature::Stretch, Feature::Bend},
                               {Feature::Shear}};
  for (std::size_t k = 0; k < (needs.has(Feature::Shear) ? 3u : 2u); ++k) {
    stage_[k] = solver_.add_stage(names[k], needs & serves[k]);
    pass_[k] =
        &solver_.add_kernel(stage_[k], shaders::kLinePass[shape_[k].shuffles ? 1 : 0][keep_ ? 1 : 0],
                            bindings(firmness_), sizeof(LineConstants), specialization(shape_[k]), shape_[k].threads);
  }
}

LineConstants Lines::constants(double dt_s, int substeps) const {
  const Cloth& cloth = scene_.cloth;
  const double h = dt_s / substeps, du = cloth.du(), dv = cloth.dv();
  const Vec3 g = scene_.gravity_m_per_s2;
  const auto f = [](double x) { return static_cast<float>(x); };
  LineConstants c{};
  c.gravity_h = {f(g[0] * h), f(g[1] * h), f(g[2] * h), 0};
  c.h = f(h);
  c.loss = f(-std::expm1(-scene_.material.damping_per_s * h));
  c.speed_limit = f(2 * std::sqrt(2 * norm(g) * std::hypot(cloth.width_m, cloth.height_m)) +
                    2 * norm(cloth.initial_velocity_m_per_s) +
                    norm(cloth.spin_rad_per_s) * std::hypot(cloth.width_m, cloth.height_m));
  c.tether_stretch = f(tethers_.stretch);
  c.rest_u = f(du);
  c.rest_v = f(dv);
  c.rest_d = f(std::hypot(du, dv));
  if (const auto Y = scene_.material.membrane_stiffness_N_per_m) {
    const Springs k = springs(*Y, du, dv, scene_.needs.has(Feature::Shear));
    c.alpha_u = f(1 / (k.along_u * h * h));
    c.alpha_v = f(1 / (k.along_v * h * h));
    if (k.diagonal > 0) c.alpha_d = f(1 / (k.diagonal * h * h));
  }
  const double mass = cloth.areal_density_kg_per_m2 * du * dv;
  if (scene_.needs.has(Feature::Bend)) {
    const double B = scene_.material.bending_rigidity_N_m;
    c.bend_u = f(du * du * du / (B * dv) / (h * h));
    c.bend_v = f(dv * dv * dv / (B * du) / (h * h));
    c.bend_rounds_u = bend_rounds(static_cast<double>(c.bend_u), 4 / mass, shape_[0]);
    c.bend_rounds_v = bend_rounds(static_cast<double>(c.bend_v), 4 / mass, shape_[1]);
  }
  c.inverse_mass = f(1 / mass);
  c.firmness = f(kFirmness);
  c.substep_part = f(1.0 / substeps);
  c.frames_per_s = f(1 / dt_s);
  c.iterations = iterations_;
  c.per_h = f(1 / h);
  c.patience = patience(*solver_.device_).in_a_frame;
  return c;
}

Lines::Constraints Lines::count(std::uint32_t family) const {
  const int columns = scene_.cloth.columns, rows = scene_.cloth.rows;
  const int di = family == 0 || family == 2 ? 1 : family == 3 ? -1 : 0, dj = family == 0 ? 0 : 1;
  const std::vector<float>& w = solver_.inverse_mass_now();
  const auto at = [&](int i, int j) { return w[static_cast<std::size_t>(j * columns + i)]; };
  Constraints n;
  for (int j = 0; j + dj < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      if (i + di < 0 || i + di >= columns) continue;
      n.links += at(i, j) + at(i + di, j + dj) > 0;
      if (family > 1 || i + 2 * di >= columns || j + 2 * dj >= rows) continue;
      n.hinges += at(i, j) + at(i + di, j + dj) + at(i + 2 * di, j + 2 * dj) > 0;
    }
  return n;
}

/// Kept multipliers are read twice and written once an iteration, the first reads none.
Traffic Lines::multiplier_traffic(std::uint32_t family, std::uint32_t iteration) const {
  if (!keep_) return {};
  const Constraints n = count(family);
  const double bytes =
      (link_multipliers_ != nullptr ? 4 * n.links : 0) + (hinge_multipliers_ != nullptr ? 16 * n.hinges : 0);
  return {iteration > 0 ? 2 * bytes : 0, bytes};
}

/// Of one family: every vertex is read, free ones are written; the first also reads where tethers end.
Traffic Lines::pass_traffic(std::uint32_t family, std::uint32_t iteration, bool first) const {
  const std::vector<float>& w = solver_.inverse_mass_now();
  const auto n = static_cast<double>(w.size());
  const auto free = static_cast<double>(std::count_if(w.begin(), w.end(), [](float w_i) { return w_i > 0; }));
  const auto chains = static_cast<double>(family == 0 ? scene_.cloth.rows : scene_.cloth.columns);
  Traffic t = multiplier_traffic(family, iteration);
  t.read_B += 32 * n + (firmness_ != nullptr ? 4.0 * shape_[std::min(family, 2u)].lanes * chains : 0) +
              (first ? 16 * static_cast<double>(tethers_.to.size()) * free : 0);
  t.write_B += 32 * free;
  return t;
}

/// Of what sums could not hold, in each dispatch that integrates.
Traffic Lines::rests_traffic() const {
  const std::vector<float>& w = solver_.inverse_mass_now();
  return {32.0 * static_cast<double>(w.size()),
          32.0 * static_cast<double>(std::count_if(w.begin(), w.end(), [](float w_i) { return w_i > 0; }))};
}

void Lines::record(int first, int count, int substeps, double dt_s) {
  LineConstants c = constants(dt_s, substeps);
  c.first_substep = static_cast<std::uint32_t>(first);
  c.substeps = static_cast<std::uint32_t>(count);
  if (frame_ == nullptr && resident_ == nullptr) {
    record_passes(c);
    return;
  }
  const auto n = static_cast<double>(scene_.cloth.vertex_count());
  Traffic t = resident_ != nullptr ? rests_traffic() : Traffic{64 * n * batch_, 64 * n * batch_};
  if (frame_ != nullptr)
    t.read_B += static_cast<double>(sizeof(GripVertex) * scene_.grips.vertices.size()) * (1 + count);
  const std::uint32_t families = scene_.needs.has(Feature::Shear) ? 4 : 2;
  for (std::uint32_t iteration = 0; iteration < iterations_; ++iteration)
    for (std::uint32_t family = 0; family < families; ++family) {
      const Traffic m = frame_ != nullptr ? multiplier_traffic(family, iteration)
                                          : pass_traffic(family, iteration, family + 1 == families && iteration == 0);
      t.read_B += count * m.read_B;
      t.write_B += count * m.write_B;
    }
  if (frame_ != nullptr) {
    solver_.dispatch_groups(stage_frame_, *frame_, vulkan::groups_for(batch_, 1), c, t);
    return;
  }
  const auto chains = static_cast<std::uint32_t>(std::max(scene_.cloth.columns, scene_.cloth.rows));
  solver_.dispatch_groups(stage_frame_, *resident_, vulkan::groups_for(chains, shape_[0].chains_a_group()), c, t);
}

/// Diagonals first: threads have the last word, columns before rows.
void Lines::record_passes(LineConstants c) {
  const std::uint32_t families = scene_.needs.has(Feature::Shear) ? 4 : 2;
  for (c.iteration = 0; c.iteration < iterations_; ++c.iteration)
    for (std::uint32_t turn = 0; turn < families; ++turn) {
      c.family = families - 1 - turn;
      const bool first = turn == 0 && c.iteration == 0;
      const bool last = turn + 1 == families && c.iteration + 1 == iterations_;
      c.turn = (first ? LINES_FIRST : 0) | (last ? LINES_LAST : 0);
      const std::size_t kind = std::min(c.family, 2u);
      const auto chains = static_cast<std::uint32_t>(c.family == 0 ? scene_.cloth.rows : scene_.cloth.columns);
      Traffic t = pass_traffic(c.family, c.iteration, first);
      if (first) {
        t.read_B += rests_traffic().read_B;
        t.write_B += rests_traffic().write_B;
      }
      solver_.dispatch_groups(stage_[kind], *pass_[kind], vulkan::groups_for(chains, shape_[kind].chains_a_group()), c,
                              t);
    }
}

}  // namespace clothbench::pbd_gpu
