#include "plane_frame.hpp"

#include <algorithm>
#include <functional>

#include "persistent.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Workgroups are of so many threads or a multiple, so that lanes that share a vertex are all there.
constexpr std::uint32_t kThreadsTogether = 32;
/// Workgroups: those beyond the lines' have pairs and vertices alone. One takes a sixth longer where capsules sweep,
/// and three times as long on a desk; 64 lose 6 % on a desk and 9 % in a whole room, and 256 lose 5 % in sweeps (H100).
constexpr std::uint32_t kWorkgroups = 96;

/// The two have no number in common.
std::vector<std::uint32_t> both(const LineSpecialization& lines, const PlaneFrameSpecialization& planes) {
  std::vector<std::uint32_t> all = lines.by_number();
  const std::vector<std::uint32_t> more = planes.by_number();
  std::transform(more.begin(), more.end(), all.begin(), all.begin(), std::bit_or<>());
  return all;
}

constexpr FeatureSet kOfLines{Feature::Stretch, Feature::Shear, Feature::Bend,
                              Feature::Damping, Feature::Pins,  Feature::MovingPins};

}  // namespace

std::unique_ptr<PlaneFrame> PlaneFrame::make(FrameBuilder& frame, Lines& lines, PlaneContact& contact) {
  const std::string wanted = frame.tuning()["contact_frame"];
  if (wanted == "never" || contact.with_itself() || !frame.scene().cloth.mass_factors.empty()) return nullptr;
  // A CPU takes seconds to compile it, and runs a workgroup on one of its cores.
  if (wanted == "auto" && frame.device()->is_software()) return nullptr;
  std::unique_ptr<PlaneFrame> made(new PlaneFrame(frame, lines, contact));
  if (made->add_kernels()) return made;
  if (wanted == "always")
    throw Error(
        "solver xpbd: setting tuning.contact_frame=always: expected a device that runs all workgroups of "
        "plane_frame at once");
  return nullptr;
}

bool PlaneFrame::add_kernels() {
  const LineShape shape = lines_.shape_with_contact();
  if (shape.threads % kThreadsTogether != 0) return false;
  LineSpecialization lines = lines_.specialization_with_contact(shape);
  groups_ = lines_.groups_of(shape);
  const auto wanted = frame_.tuning()["contact_groups"].get<std::uint32_t>();
  // Workgroups beyond those of the lines have pairs and vertices alone, and so threads without a line.
  if (const std::uint32_t least = wanted != 0 ? wanted : kWorkgroups; least > groups_.x * groups_.y) {
    groups_ = vulkan::groups_for(least, 1);
    lines.EXACT = 0;
  }
  const std::vector<std::uint32_t> constants = both(lines, contact_.frame_specialization());
  lines_.add_regularisation();
  if (!runs_at_once<LineConstants>(frame_, "plane_frame", constants, shape.threads, groups_)) return false;
  add_meeting(frame_);
  const int stage = frame_.add_stage("LinesAndContact", (frame_.scene().needs & kOfLines) | contact_.serves(), true);
  kernel_ = frame_.add_kernel(stage, "plane_frame", sizeof(LineConstants), constants, shape.threads);
  add_far(constants, shape.threads);
  return true;
}

void PlaneFrame::add_far(const std::vector<std::uint32_t>& constants, std::uint32_t threads) {
  const PlaneFrameSpecialization planes = contact_.frame_specialization();
  if (planes.PIECES == 0 || planes.PLANES > 0) return;
  const LineShape one = lines_.whole_shape();
  const bool in_one_group = one.threads > 0;
  if (!in_one_group && !runs_at_once<LineConstants>(frame_, "plane_frame_far", constants, threads, groups_)) return;
  const int stage = frame_.add_stage("LinesFarFromColliders", frame_.scene().needs & kOfLines, true);
  if (!in_one_group) {
    far_lists_ = true;
    far_ = frame_.add_kernel(stage, "plane_frame_far", sizeof(LineConstants), constants, threads);
    far_groups_ = groups_;
  } else {
    far_ = frame_.add_kernel(stage, "line_frame_far", sizeof(LineConstants),
                             both(lines_.whole_specialization(one), planes), one.threads);
  }
}

LineConstants PlaneFrame::constants(double dt_s, const Steps& steps, bool listed) const {
  LineConstants c = lines_.constants(dt_s, steps.substeps, steps.step);
  const PlaneContactConstants contact = contact_.constants(0, steps.substeps, dt_s);
  c.substeps = static_cast<std::uint32_t>(steps.substeps);
  c.first_pass = listed ? PLANE_FRAME_LISTED : 0;
  c.passes = c.substeps * lines_.passes();
  c.frame_s = contact.frame_s;
  c.reach_m = contact.reach_m;
  return c;
}

void PlaneFrame::record(double dt_s, const Steps& near, const Steps& far) {
  const auto n = static_cast<double>(frame_.scene().cloth.vertex_count());
  if (far_ != nullptr) frame_.dispatch_groups(*far_, far_groups_, constants(dt_s, far, false), {64 * n, 64 * n});
  frame_.dispatch_groups(*kernel_, groups_, constants(dt_s, near, far_lists_),
                         lines_.substep_traffic() * near.substeps + Traffic{32 * n, 36 * n});
}

}  // namespace clothbench::pbd_gpu
