#include "xpbd/fused/fused_frame.hpp"

#include "xpbd/grid_barrier.hpp"

namespace clothbench::pbd_gpu {

/// Minimum number of workgroups; those without lines process pairs and vertices. With 1, capsule sweeps take a sixth
/// longer, a desk three times as long; 64 costs 6 % on a desk and 9 % in a whole room, 256 costs 5 % in sweeps (H100).
constexpr std::uint32_t kWorkgroups = 96;
/// Maximum number of groups of shapes: nearby_groups has one bit each, in 4 KiB of shared memory.
constexpr std::uint32_t kMaxGroups = 1u << 15;
/// Maximum vertices of cloth on static colliders, which has contact in most frames. For more vertices, one kernel per
/// pass takes less GPU time, by a third with 96 x 96 and by half with 128 x 128 (p95 on a sphere, H200).
constexpr std::uint32_t kMaxOnStaticShapes = 64 * 64;

std::unique_ptr<FusedFrame> FusedFrame::make(FrameBuilder& frame, Lines& lines, XpbdContact& contact) {
  const std::string wanted = frame.tuning()["contact_frame"];
  if (wanted == "never" || contact.with_itself() || !frame.scene().cloth.mass_factors.empty() ||
      contact.specialization().GROUPS > kMaxGroups)
    return nullptr;
  const bool is_large = !contact.has_kinematic_shapes() && frame.scene().cloth.vertex_count() > kMaxOnStaticShapes;
  // A software device takes seconds to compile the kernel, and runs each workgroup on one CPU core.
  if (wanted == "auto" && (is_large || frame.device()->is_software())) return nullptr;
  std::unique_ptr<FusedFrame> made(new FusedFrame(frame, lines, contact));
  if (made->add_kernels()) return made;
  if (wanted == "always")
    throw Error("solver xpbd: tuning.contact_frame=always: expected a device that runs all workgroups at once");
  return nullptr;
}

bool FusedFrame::add_kernels() {
  const LineShape shape = lines_.shape_with_contact();
  if (shape.threads % 32 != 0) return false;  // not all clusters of lanes are complete
  LineSpecialization lines = lines_.persistent_specialization(shape);
  groups_ = lines_.groups_of(shape);
  const auto wanted = frame_.tuning()["contact_groups"].get<std::uint32_t>();
  // Additional workgroups have no lines, so not every thread is on a chain.
  if (const std::uint32_t smallest = wanted != 0 ? wanted : kWorkgroups; smallest > groups_.x * groups_.y) {
    groups_ = vulkan::groups_for(smallest, 1);
    lines.EXACT = 0;
  }
  const std::vector<std::uint32_t> constants = joined(lines, contact_.specialization());
  if (!runs_at_once<LineConstants>(frame_, "fused_frame", constants, shape.threads, groups_)) return false;
  add_grid_barrier(frame_);
  const int stage = frame_.add_stage("FusedFrame", (frame_.scene().needs & kLineFeatures) | contact_.serves());
  kernel_ = frame_.add_kernel(stage, "fused_frame", sizeof(LineConstants), constants, shape.threads);
  add_contact_free(constants, shape.threads);
  return true;
}

void FusedFrame::add_contact_free(const std::vector<std::uint32_t>& constants, std::uint32_t threads) {
  const ContactSpecialization& planes = contact_.specialization();
  if (planes.SHAPES == 0 || planes.PLANES > 0) return;
  const LineShape one = lines_.single_dispatch_shape();
  const bool in_one_group = one.threads > 0;
  if (!in_one_group && !runs_at_once<LineConstants>(frame_, "fused_frame_contact_free", constants, threads, groups_))
    return;
  const int stage = frame_.add_stage("ContactFreeFrame", frame_.scene().needs & kLineFeatures);
  if (!in_one_group) {
    contact_free_lists_ = true;
    contact_free_ = frame_.add_kernel(stage, "fused_frame_contact_free", sizeof(LineConstants), constants, threads);
    contact_free_groups_ = groups_;
  } else {
    contact_free_ = frame_.add_kernel(stage, "line_frame_contact_free", sizeof(LineConstants),
                                      joined(lines_.specialization(one), planes), one.threads);
  }
}

LineConstants FusedFrame::constants(double dt_s, const Steps& steps, bool listed) const {
  LineConstants c = lines_.constants(dt_s, steps.substeps, steps.step);
  const ContactConstants contact = contact_.constants(0, steps.substeps, dt_s);
  c.substeps = static_cast<std::uint32_t>(steps.substeps);
  c.first_pass = listed ? BROAD_PHASE_DONE : 0;
  c.passes = c.substeps * lines_.passes();
  c.frame_s = contact.frame_s;
  c.bound_m = contact.bound_m;
  return c;
}

void FusedFrame::record(double dt_s, const Steps& contact, const Steps& contact_free) {
  if (contact_free_ != nullptr)
    frame_.dispatch_groups(*contact_free_, contact_free_groups_, constants(dt_s, contact_free, false));
  frame_.dispatch_groups(*kernel_, groups_, constants(dt_s, contact, contact_free_lists_));
}

}  // namespace clothbench::pbd_gpu
