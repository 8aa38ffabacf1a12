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
/// The same of cloth that touches itself, which has more pairs: a fold takes 668 us with 96, 565 with 264, 563 with
/// 396, and 612 a dispatch a phase; at 48 x 48 vertices 6358, 3829, 3882 and 4439 (H200,
/// `clothbench run contact/self-fold --set solver.tuning.contact_groups=264`).
constexpr std::uint32_t kWorkgroupsWithItself = 264;

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
  if (!frame.settings()["one_dispatch"].get<bool>() || wanted == "never") return nullptr;
  // A CPU takes seconds to compile it, and runs a workgroup on one of its cores.
  const vulkan::Device& device = *frame.device();
  if (wanted == "auto" && device.is_software() && device.profile() == nullptr) return nullptr;
  std::unique_ptr<PlaneFrame> made(new PlaneFrame(frame, lines, contact));
  auto groups = frame.tuning()["contact_groups"].get<std::uint32_t>();
  // A phone's few cores gain nothing from many workgroups of a sweep's few pairs.
  const bool capsules_alone = (frame.scene().needs & kColliderFeatures) == FeatureSet{Feature::Capsules};
  if (groups == 0 && (device.is_discrete() || !capsules_alone))
    groups = contact.with_itself() ? kWorkgroupsWithItself : kWorkgroups;
  // Pairs of the cloth with itself are too many for one workgroup.
  if (contact.with_itself()) return made->add_kernel(true, std::max(groups, 1u)) ? std::move(made) : nullptr;
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
  if (shape.threads == 0 || shape.threads % kThreadsTogether != 0) return false;
  LineSpecialization lines = lines_.specialization_with_contact(shape, many);
  groups_ = many ? lines_.groups_of(shape) : vulkan::Groups{1, 1};
  // Workgroups beyond those of the lines have pairs and vertices alone, and so threads without a line.
  if (many && least_groups > groups_.x * groups_.y) {
    groups_ = vulkan::groups_for(least_groups, 1);
    lines.EXACT = 0;
  }
  PlaneFrameSpecialization planes = contact_.frame_specialization();
  // One workgroup has too few threads to spare several for a vertex.
  if (!shape.shuffles || !many) planes.TEAM = 1;
  const std::vector<std::uint32_t> constants = both(lines, planes);
  const bool with_itself = contact_.with_itself();
  if (with_itself && !shape.shuffles) return false;
  const std::string name = std::string("plane_frame") + (many ? "_many" : "") + (shape.shuffles ? "_shuffle" : "") +
                           (with_itself ? "_self" : "");
  lines_.add_regularisation();
  if (many) {
    if (!runs_at_once<LineConstants>(frame_, name, constants, shape.threads, groups_)) return false;
    add_meeting(frame_);
  }
  if (with_itself) contact_.add_self_list_kernels();
  const int stage = frame_.add_stage("LinesAndContact", (frame_.scene().needs & kOfLines) | contact_.serves(), true);
  kernel_ = frame_.add_kernel(stage, name, sizeof(LineConstants), constants, shape.threads);
  add_far(name, constants, shape.threads);
  return true;
}

void PlaneFrame::add_far(const std::string& name, const std::vector<std::uint32_t>& constants, std::uint32_t threads) {
  const PlaneFrameSpecialization planes = contact_.frame_specialization();
  if (planes.PIECES == 0 || planes.PLANES > 0 || contact_.with_itself()) return;
  const LineShape one = lines_.frame_shape_with_contact(false);
  const bool in_one_group = one.threads > 0;
  if (!in_one_group && !runs_at_once<LineConstants>(frame_, name + "_far", constants, threads, groups_)) return;
  const int stage = frame_.add_stage("LinesFarFromColliders", frame_.scene().needs & kOfLines, true);
  const auto add = [&](const std::string& of, const std::vector<std::uint32_t>& with, std::uint32_t of_threads) {
    far_ = frame_.add_kernel(stage, of, sizeof(LineConstants), with, of_threads);
  };
  if (in_one_group) {
    LineSpecialization lines = lines_.whole_specialization(one);
    lines.GRIPS = static_cast<std::uint32_t>(frame_.scene().grips.vertices.size());
    add(one.shuffles ? "line_frame_shuffle_far" : "line_frame_far", both(lines, planes), one.threads);
  } else {
    add(name + "_far", constants, threads);
    far_groups_ = groups_;
    far_lists_ = true;
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
  if (contact_.with_itself()) contact_.record_self_list(dt_s, near.substeps);
  if (far_ != nullptr) frame_.dispatch_groups(*far_, far_groups_, constants(dt_s, far, false), {64 * n, 64 * n});
  frame_.dispatch_groups(*kernel_, groups_, constants(dt_s, near, far_lists_),
                         lines_.substep_traffic() * near.substeps + Traffic{32 * n, 36 * n});
}

}  // namespace clothbench::pbd_gpu
