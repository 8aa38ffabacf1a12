#include "xpbd/mesh/chains.hpp"

#include <bit>

#include "xpbd/constraints.hpp"
#include "xpbd/grid_barrier.hpp"
#include "xpbd/mesh/matrices.hpp"

namespace clothbench::pbd_gpu {

constexpr std::uint32_t kBlock = 256;

Chains::Chains(FrameBuilder& frame, const Scene& scene, const ChainCloth& cloth, bool uses_bdf2, bool tension,
               bool membrane)
    : frame_(frame),
      scene_(scene),
      block_(std::min({kBlock, frame.device()->limits().maxComputeWorkGroupInvocations,
                       frame.device()->limits().maxComputeWorkGroupSize[0]})),
      uses_bdf2_(uses_bdf2),
      tension_(tension),
      membrane_(membrane) {
  const FeatureSet needs = scene.needs;
  const FeatureSet serves{Feature::Stretch,   Feature::Shear,      Feature::Damping, Feature::Pins,
                          Feature::ClothMesh, Feature::UnevenGrid, Feature::Regions, Feature::Bend};
  const int stage = frame.add_stage("Chains", needs & serves);
  const TetherTable tethers = tether_table(scene, frame.settings()["tethers"].get<bool>());
  tethers_ = tethers.a_vertex;
  if (tethers_ == 0) frame.disable("tethers", tethers.reason);
  add_colours(cloth);
  add_bending();
  add_membrane();
  if (solves_together())
    frame.add_buffer(BIND_BENDING_STEPS, "bending steps",
                     (membrane_ ? 4 : 3) * scene.cloth.vertex_count() * sizeof(vec4));
  frame.add_buffer(BIND_CHAIN_ENTRIES, "chain entries", entries_);
  if (tethers_ > 0) frame.add_buffer(BIND_TETHER_ENDS, "tether ends", tethers.ends);
  const char* kernel = membrane_ ? "chain_pass_membrane" : "chain_pass";
  ChainSpecialization s = specialization();
  s.PERSISTENT = 1;
  persistent_ =
      cloth.welded.empty() && runs_at_once<ChainConstants>(frame, kernel, s.by_number(), block_, all_groups());
  if (persistent_) {
    frame.add_buffer(BIND_CHAIN_COLOURS, "chain colours", colours_);
    add_grid_barrier(frame);
  }
  s.PERSISTENT = persistent_ ? 1 : 0;
  kernel_ = frame.add_kernel(stage, kernel, sizeof(ChainConstants), s.by_number(), block_);
  if (cloth.welded.empty()) return;
  std::vector<std::uint32_t> welds;
  for (const std::uint32_t vertex : cloth.welded) {
    welds.push_back(vertex);
    welds.push_back(cloth.particle[vertex]);
  }
  welds_ = static_cast<std::uint32_t>(cloth.welded.size());
  frame.add_buffer(BIND_WELDS, "welds", welds);
  weld_ = frame.add_kernel(stage, "weld", 4);
}

void Chains::add_colours(const ChainCloth& cloth) {
  const std::size_t n = scene_.cloth.vertex_count();
  const std::vector<ChainColour> colours =
      membrane_ ? std::vector<ChainColour>(1) : colours_of(edge_paths(scene_, cloth), n, block_);
  for (std::size_t f = 0; f < colours.size(); ++f) {
    const std::vector<ChainEntry> more = entries_of(colours[f], scene_, cloth, block_, f == 0);
    const auto rounds = membrane_ ? 0u : static_cast<std::uint32_t>(std::bit_width(colours[f].longest() - 1));
    colours_.push_back({static_cast<uint>(entries_.size()), static_cast<uint>(more.size()) / block_, rounds});
    entries_.insert(entries_.end(), more.begin(), more.end());
  }
}

ChainSpecialization Chains::specialization() const {
  ChainSpecialization s;
  s.THREADS = block_;
  s.TETHERS = tethers_;
  if (scene_.needs.has(Feature::Shear) || scene_.needs.has(Feature::ClothMesh)) s.FEATURES |= LINES_SHEAR;
  if (bends_) s.FEATURES |= LINES_BEND;
  if (uses_bdf2_) s.FEATURES |= LINES_BDF2;
  if (tension_) s.FEATURES |= LINES_TENSION;
  return s;
}

void Chains::add_bending() {
  bends_ = scene_.needs.has(Feature::Bend);
  if (!bends_) return;
  const BendingMatrix K = bending_matrix(scene_);
  max_per_s2_ = K.max_per_s2;
  const SlicedRows<BendingEntry> table = bending_table(K);
  frame_.add_buffer(BIND_BENDING_SLICES, "bending slices", table.slices);
  frame_.add_buffer(BIND_BENDING_ENTRIES, "bending entries", table.entries);
}

void Chains::add_membrane() {
  if (!membrane_) return;
  max_per_s2_ += membrane_bound(scene_);
  const SlicedRows<MembraneCorner> table = membrane_table(scene_);
  frame_.add_buffer(BIND_MEMBRANE_SLICES, "triangle slices", table.slices);
  frame_.add_buffer(BIND_MEMBRANE_CORNERS, "triangle corners", table.entries);
}

/// Workgroups: the maximum number of blocks of a colour.
vulkan::Groups Chains::all_groups() const {
  std::uint32_t largest = 0;
  for (const ChainRange& f : colours_) largest = std::max(largest, f.blocks);
  return vulkan::groups_for(std::uint64_t{largest} * block_, block_);
}

void Chains::record(int count, const TimeStep& step, bool again) {
  const double forces = step.force_scale * step.kick_scale;
  auto c = step_constants<ChainConstants>(
      frame_, {step.implicit_h_s, step.history_weight, step.kick_scale * step.damping_fraction, forces, 1});
  c.per_force_scale = static_cast<float>(1 / forces);
  c.colours = membrane_ ? 0 : static_cast<std::uint32_t>(colours_.size());
  c.again = again ? 1 : 0;
  if (solves_together()) {
    const double square = step.implicit_h_s * step.implicit_h_s * forces, largest = square * max_per_s2_;
    c.bending_iterations = bending_iterations(largest);
    c.vertices = static_cast<std::uint32_t>(scene_.cloth.vertex_count());
    c.bending_step = static_cast<float>(square);
    c.bending_gain = static_cast<float>(2 / (2 + largest));
    c.bending_spread = static_cast<float>(largest / (2 + largest) * (largest / (2 + largest)) / 4);
  }
  const std::uint32_t first_colour = solves_together() ? 1 + c.bending_iterations : 0, first = again ? first_colour : 0,
                      end = first_colour + c.colours;
  if (persistent_) {
    c.first_pass = first;
    c.passes = (end - first) * static_cast<std::uint32_t>(count);
    frame_.dispatch_groups(*kernel_, all_groups(), c);
    return;
  }
  c.passes = 1;
  for (int s = 0; s < count; ++s) {
    for (c.first_pass = first; c.first_pass < end; ++c.first_pass) {
      const std::uint32_t k = c.first_pass;
      const ChainRange& colour = colours_[k < first_colour ? 0 : k - first_colour];
      c.first_entry = colour.first_entry;
      c.rounds = colour.rounds;
      frame_.dispatch(*kernel_, k > 0 && k < first_colour ? c.vertices : colour.blocks * block_, c);
    }
    record_welds();
  }
}

void Chains::record_welds() {
  if (weld_ != nullptr) frame_.dispatch(*weld_, welds_, welds_);
}

}  // namespace clothbench::pbd_gpu
