#include "chains.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include "crumpled.hpp"
#include "line_plan.hpp"
#include "resident.hpp"

namespace clothbench::pbd_gpu {
namespace {

using vulkan::Access;

constexpr std::uint32_t kBlock = 256;

}  // namespace

Chains::Chains(GpuSolver& solver, const Scene& scene, const ChainCloth& cloth, const vulkan::Buffer& x,
               const vulkan::Buffer& v, const vulkan::Buffer& rx, const vulkan::Buffer& rv)
    : solver_(solver),
      scene_(scene),
      block_(std::min({kBlock, solver.vulkan_device().limits().maxComputeWorkGroupInvocations,
                       solver.vulkan_device().limits().maxComputeWorkGroupSize[0]})) {
  const FeatureSet needs = scene.needs;
  const FeatureSet serves{Feature::Stretch,   Feature::Shear,      Feature::Damping, Feature::Pins,
                          Feature::ClothMesh, Feature::UnevenGrid, Feature::Regions};
  stage_ = solver.add_stage("Chains", needs & serves);
  TetherTable tethers;
  if (solver.settings()["tethers"].get<bool>())
    tethers = tether_table(scene);
  else
    tethers.why_not = "setting tethers=false";
  tethers_ = tethers.a_vertex;
  if (tethers_ == 0) solver.leave_out("tethers", tethers.why_not);
  if (!needs.has(Feature::Damping)) solver.leave_out("damping", "the scene has none");
  const std::vector<ChainFamily> families = families_of(strands(scene, cloth), scene.cloth.vertex_count(), block_);
  for (std::size_t f = 0; f < families.size(); ++f) {
    const std::vector<ChainEntry> more = entries_of(families[f], scene, cloth, block_, f == 0);
    const auto rounds = static_cast<std::uint32_t>(std::bit_width(families[f].longest() - 1));
    families_.push_back(
        {static_cast<std::uint32_t>(entries_.size()), static_cast<std::uint32_t>(more.size()), rounds, 0, 0});
    entries_.insert(entries_.end(), more.begin(), more.end());
  }
  const vulkan::Buffer& entries =
      solver.add_buffer("chain entries", entries_.size() * sizeof(ChainEntry), bytes_of(entries_));
  const vulkan::Buffer* ends =
      tethers_ > 0 ? &solver.add_buffer("tether ends", tethers.ends.size() * sizeof(TetherEnd), bytes_of(tethers.ends))
                   : &x;
  std::uint32_t features = 0;
  if (needs.has(Feature::Damping)) features |= LINES_DAMPING;
  if (needs.has(Feature::Shear) || needs.has(Feature::ClothMesh)) features |= LINES_SHEAR;
  const bool driven = needs.has(Feature::MovingMesh) || needs.has(Feature::Capsules);
  if ((tethers_ > 0 || starts_crumpled(scene)) && !driven) features |= LINES_LIMIT_SPEED;
  const std::vector<vulkan::Binding> bindings = {{&x, Access::ReadWrite},  {&v, Access::ReadWrite},
                                                 {&rx, Access::ReadWrite}, {&rv, Access::ReadWrite},
                                                 {&entries, Access::Read}, {ends, Access::Read}};
  const std::vector<std::uint32_t> specialization = {block_, features, tethers_};
  if (cloth.welded.empty()) add_resident(bindings, specialization);
  if (resident_ == nullptr)
    kernel_ = &solver.add_kernel(stage_, shaders::kChainPass, bindings, sizeof(ChainConstants), specialization, block_);
  if (cloth.welded.empty()) return;
  std::vector<std::uint32_t> welds;
  for (const std::uint32_t vertex : cloth.welded) {
    welds.push_back(vertex);
    welds.push_back(cloth.particle[vertex]);
  }
  welds_ = static_cast<std::uint32_t>(cloth.welded.size());
  const vulkan::Buffer& pairs = solver.add_buffer("welds", welds.size() * 4, bytes_of(welds));
  weld_ = &solver.add_kernel(stage_, shaders::kWeld,
                             {{&x, Access::ReadWrite}, {&v, Access::ReadWrite}, {&pairs, Access::Read}}, 4);
}

/// As Lines::add_resident.
void Chains::add_resident(const std::vector<vulkan::Binding>& bindings,
                          const std::vector<std::uint32_t>& specialization) {
  const std::string wanted = solver_.tuning()["device_barrier"];
  if (!(wanted == "always" || (wanted == "auto" && solver_.vulkan_device().is_discrete()))) return;
  std::vector<ChainRange> ranges;
  for (const Family& f : families_) ranges.push_back({f.first_entry, f.entries / block_, f.rounds, 0});
  // What the trial reads of it is nothing.
  const auto with_barrier = [&](const vulkan::Buffer& table, const vulkan::Buffer& meeting,
                                const vulkan::Buffer& missed) {
    std::vector<vulkan::Binding> b = bindings;
    b.push_back({&table, Access::Read});
    b.push_back({&meeting, Access::ReadWrite});
    b.push_back({&missed, Access::Write});
    return b;
  };
  const vulkan::Buffer& entries = *bindings[4].buffer;
  const auto trial = [&](const vulkan::Buffer& meeting, const vulkan::Buffer& missed) {
    return with_barrier(entries, meeting, missed);
  };
  if (!runs_at_once(solver_.device_, shaders::kChainsResident, specialization, block_, trial, all_groups(),
                    ChainConstants{}, wanted == "always"))
    return;
  const vulkan::Buffer& table =
      solver_.add_buffer("chain families", ranges.size() * sizeof(ChainRange), bytes_of(ranges));
  const vulkan::Buffer& meeting = solver_.add_buffer("meeting", 8);
  vulkan::Buffer& missed = solver_.add_host_buffer("missed", 4);
  std::memset(missed.mapped(), 0, 4);
  solver_.set_missed(missed);
  resident_ = &solver_.add_kernel(stage_, shaders::kChainsResident, with_barrier(table, meeting, missed),
                                  sizeof(ChainConstants), specialization, block_);
}

/// As many workgroups as the family of most blocks has.
vulkan::Groups Chains::all_groups() const {
  std::uint32_t most = 0;
  for (const Family& f : families_) most = std::max(most, f.entries);
  return vulkan::groups_for(most, block_);
}

/// Vertices on each family's chains, and how many of them are free in this frame.
void Chains::count_vertices() {
  const std::vector<float>& w = solver_.inverse_mass_now();
  for (Family& f : families_) {
    f.vertices = f.free = 0;
    for (std::uint32_t k = f.first_entry; k < f.first_entry + f.entries; ++k) {
      if (entries_[k].vertex == CHAIN_NOBODY) continue;
      f.vertices += 1;
      f.free += w[entries_[k].vertex] > 0 ? 1 : 0;
    }
  }
}

Traffic Chains::traffic(std::size_t family) const {
  const Family& f = families_[family];
  const double rests = family == 0 ? 1 : 0;
  return {16.0 * f.entries + (32 + 32 * rests) * f.vertices + 24 * rests * tethers_ * f.free,
          (32 + 32 * rests) * f.free};
}

void Chains::record(int count, int substeps, double dt_s) {
  count_vertices();
  const Cloth& cloth = scene_.cloth;
  const double h = dt_s / substeps, across = std::hypot(cloth.width_m, cloth.height_m);
  const Vec3 g = scene_.gravity_m_per_s2;
  const auto f = [](double value) { return static_cast<float>(value); };
  ChainConstants c{};
  c.gravity_h = {f(g[0] * h), f(g[1] * h), f(g[2] * h), 0};
  c.h = f(h);
  c.loss = f(-std::expm1(-scene_.material.damping_per_s * h));
  c.speed_limit = f(2 * std::sqrt(2 * norm(g) * across) + 2 * norm(cloth.initial_velocity_m_per_s) +
                    norm(cloth.spin_rad_per_s) * across);
  c.per_h = f(1 / h);
  c.patience = patience(solver_.vulkan_device()).in_a_frame;
  c.families = static_cast<std::uint32_t>(families_.size());
  c.substeps = static_cast<std::uint32_t>(count);
  if (resident_ != nullptr) {
    const vulkan::Groups groups = all_groups();
    Traffic all;
    for (std::size_t k = 0; k < families_.size(); ++k) {
      all.read_B += count * (traffic(k).read_B + 16.0 * groups.x * groups.y * block_);
      all.write_B += count * traffic(k).write_B;
    }
    solver_.dispatch_groups(stage_, *resident_, groups, c, all);
    return;
  }
  for (int s = 0; s < count; ++s) {
    for (std::size_t k = 0; k < families_.size(); ++k) {
      const Family& family = families_[k];
      c.first_entry = family.first_entry;
      c.turn = k == 0 ? LINES_FIRST : 0;
      c.rounds = family.rounds;
      solver_.dispatch_groups(stage_, *kernel_, vulkan::groups_for(family.entries, block_), c, traffic(k));
    }
    if (weld_ != nullptr) solver_.dispatch(stage_, *weld_, welds_, welds_, {40.0 * welds_, 32.0 * welds_});
  }
}

}  // namespace clothbench::pbd_gpu
