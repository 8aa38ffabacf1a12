#include "plane_frame.hpp"

#include <algorithm>
#include <functional>

#include "persistent.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Threads whose sums plane_scan.glsl adds up together.
constexpr std::uint32_t kScanBlock = 32;
/// Workgroups where more than capsules touches: one takes a third longer for a hand mesh that pushes, twice as many win
/// a twentieth (H200). Capsules have too few pairs to share.
constexpr std::uint32_t kWorkgroups = 64;

}  // namespace

std::unique_ptr<PlaneFrame> PlaneFrame::make(FrameBuilder& frame, Lines& lines, PlaneContact& contact) {
  const std::string wanted = frame.tuning()["contact_frame"];
  if (contact.with_itself()) return nullptr;
  if (!frame.settings()["one_dispatch"].get<bool>() || wanted == "never") return nullptr;
  // A CPU takes seconds to compile it, and runs a workgroup on one of its cores.
  const vulkan::Device& device = *frame.device();
  if (wanted == "auto" && device.is_software() && device.profile() == nullptr) return nullptr;
  std::unique_ptr<PlaneFrame> made(new PlaneFrame(frame, lines, contact));
  auto groups = frame.tuning()["contact_groups"].get<std::uint32_t>();
  const bool capsules_alone = (frame.scene().needs & kColliderFeatures) == FeatureSet{Feature::Capsules};
  if (groups == 0 && !capsules_alone) groups = kWorkgroups;
  if ((groups > 0 && made->add_kernel(true, groups)) || made->add_kernel(false, 1) || made->add_kernel(true, 1))
    return made;
  if (wanted == "always")
    throw Error(
        "solver xpbd: setting tuning.contact_frame=always: expected an even grid of at most 32 x 32 vertices, or a "
        "device that runs all workgroups at once, and one iteration a substep");
  return nullptr;
}

bool PlaneFrame::add_kernel(bool many, std::uint32_t least_groups) {
  const LineShape shape = lines_.frame_shape_with_contact(many);
  if (shape.threads == 0 || shape.threads % kScanBlock != 0) return false;
  LineSpecialization lines = lines_.specialization_with_contact(shape, many);
  groups_ = many ? lines_.groups_of(shape) : vulkan::Groups{1, 1};
  // Workgroups beyond those of the lines have pairs and vertices alone, and so threads without a line.
  if (many && least_groups > groups_.x * groups_.y) {
    groups_ = vulkan::groups_for(least_groups, 1);
    lines.EXACT = 0;
  }
  std::vector<std::uint32_t> constants = lines.by_number();
  PlaneFrameSpecialization planes = contact_.frame_specialization();
  // One workgroup has too few threads to spare several for a vertex.
  if (!shape.shuffles || !many) planes.TEAM = 1;
  const std::vector<std::uint32_t> contact = planes.by_number();
  std::transform(contact.begin(), contact.end(), constants.begin(), constants.begin(), std::bit_or<>());
  const std::string name = std::string("plane_frame") + (many ? "_many" : "") + (shape.shuffles ? "_shuffle" : "");
  lines_.add_regularisation();
  if (many) {
    if (!runs_at_once<LineConstants>(frame_, name, constants, shape.threads, groups_)) return false;
    add_meeting(frame_);
  }
  const FeatureSet of_lines{Feature::Stretch, Feature::Shear, Feature::Bend,
                            Feature::Damping, Feature::Pins,  Feature::MovingPins};
  const int stage = frame_.add_stage("LinesAndContact", (frame_.scene().needs & of_lines) | contact_.serves(), true);
  kernel_ = frame_.add_kernel(stage, name, sizeof(LineConstants), constants, shape.threads);
  return true;
}

void PlaneFrame::record(int substeps, double dt_s, const TimeStep& step) {
  LineConstants c = lines_.constants(dt_s, substeps, step);
  const PlaneContactConstants contact = contact_.constants(0, substeps, dt_s);
  c.substeps = static_cast<std::uint32_t>(substeps);
  c.passes = c.substeps * lines_.passes();
  c.frame_s = contact.frame_s;
  c.reach_m = contact.reach_m;
  const auto n = static_cast<double>(frame_.scene().cloth.vertex_count());
  frame_.dispatch_groups(*kernel_, groups_, c, lines_.substep_traffic() * substeps + Traffic{32 * n, 36 * n});
}

}  // namespace clothbench::pbd_gpu
