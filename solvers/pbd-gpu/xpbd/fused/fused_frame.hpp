#pragma once
#include <memory>

#include "xpbd/contact/contact.hpp"
#include "xpbd/lines/grid_lines.hpp"

namespace clothbench::pbd_gpu {

/// Simulates a frame with lines and contact in one dispatch (fused_frame.comp), with the same passes as the path that
/// has one kernel per pass. Also moves attached vertices.
class FusedFrame {
 public:
  /// Null with self-collision, scaled masses, too many shapes or vertices, if the settings forbid it, or if the device
  /// does not run all workgroups at once.
  static std::unique_ptr<FusedFrame> make(FrameBuilder& frame, Lines& lines, XpbdContact& contact);

  struct Steps {
    int substeps;
    TimeStep step;
  };
  /// Call after XpbdContact::record_shapes. `contact_free`: steps if the device finds the frame contact-free.
  void record(double dt_s, const Steps& contact, const Steps& contact_free);

 private:
  FusedFrame(FrameBuilder& frame, Lines& lines, XpbdContact& contact)
      : frame_(frame), lines_(lines), contact_(contact) {}
  bool add_kernels();
  /// Adds the kernel of contact-free frames: line_frame with one workgroup if that holds the cloth
  /// (contact_free_frame.glsl), otherwise fused_frame with many workgroups, which also builds the list of pairs.
  void add_contact_free(const std::vector<std::uint32_t>& constants, std::uint32_t threads);

  LineConstants constants(double dt_s, const Steps&, bool listed) const;

  FrameBuilder& frame_;
  Lines& lines_;
  XpbdContact& contact_;
  vulkan::Groups groups_{1, 1}, contact_free_groups_{1, 1};
  bool contact_free_lists_ = false;  ///< the contact-free kernel builds the list of pairs
  const FrameKernel *kernel_ = nullptr, *contact_free_ = nullptr;
};

}  // namespace clothbench::pbd_gpu
