#pragma once
#include <memory>

#include "xpbd/contact/contact.hpp"
#include "xpbd/lines/grid_lines.hpp"

namespace clothbench::pbd_gpu {

/// Lines and contact by separating planes of a frame in one dispatch in one kernel (fused_frame.comp), phase
/// for phase as the kernels of the phases have it. It also moves attached vertices.
class FusedFrame {
 public:
  /// Null where the cloth touches itself, or where device or settings do not allow it: it takes a device that runs all
  /// its workgroups at once.
  static std::unique_ptr<FusedFrame> make(FrameBuilder& frame, Lines& lines, XpbdContact& contact);

  struct Steps {
    int substeps;
    TimeStep step;
  };
  /// Call after XpbdContact::record_shapes. `far`: of a frame in which no collider can be near.
  void record(double dt_s, const Steps& contact, const Steps& contact_free);

 private:
  FusedFrame(FrameBuilder& frame, Lines& lines, XpbdContact& contact)
      : frame_(frame), lines_(lines), contact_(contact) {}
  bool add_kernels();
  /// The kernel of frames in which no collider can be near: of one workgroup where that holds the cloth
  /// (contact_free_frame.glsl), else the kernel of many without contact, which also lists the pairs.
  void add_contact_free(const std::vector<std::uint32_t>& constants, std::uint32_t threads);

  LineConstants constants(double dt_s, const Steps&, bool listed) const;

  FrameBuilder& frame_;
  Lines& lines_;
  XpbdContact& contact_;
  vulkan::Groups groups_{1, 1}, contact_free_groups_{1, 1};
  bool contact_free_lists_ = false;  ///< the kernel of frames without contact makes the list
  const FrameKernel *kernel_ = nullptr, *contact_free_ = nullptr;
};

}  // namespace clothbench::pbd_gpu
