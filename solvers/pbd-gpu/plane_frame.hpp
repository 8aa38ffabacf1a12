#pragma once
#include <memory>

#include "lines.hpp"
#include "plane_contact.hpp"

namespace clothbench::pbd_gpu {

/// Lines and contact by planes of a whole frame in one kernel (shaders/plane_frame.comp), phase for phase as
/// the kernels of the phases have it. It also moves held vertices.
class PlaneFrame {
 public:
  /// Null where the cloth touches itself, or where device or settings do not allow it: it takes a device that runs all
  /// its workgroups at once.
  static std::unique_ptr<PlaneFrame> make(FrameBuilder& frame, Lines& lines, PlaneContact& contact);

  struct Steps {
    int substeps;
    TimeStep step;
  };
  /// Call after PlaneContact::record_pieces. `far`: of a frame in which no collider can be near.
  void record(double dt_s, const Steps& near, const Steps& far);

 private:
  PlaneFrame(FrameBuilder& frame, Lines& lines, PlaneContact& contact)
      : frame_(frame), lines_(lines), contact_(contact) {}
  bool add_kernels();
  /// The kernel of frames in which no collider can be near: of one workgroup where that holds the cloth
  /// (shaders/plane_far.glsl), else that of many without contact, which lists the pairs too.
  void add_far(const std::vector<std::uint32_t>& constants, std::uint32_t threads);

  LineConstants constants(double dt_s, const Steps&, bool listed) const;

  FrameBuilder& frame_;
  Lines& lines_;
  PlaneContact& contact_;
  vulkan::Groups groups_{1, 1}, far_groups_{1, 1};
  bool far_lists_ = false;  ///< the kernel of frames without contact makes the list
  const FrameKernel *kernel_ = nullptr, *far_ = nullptr;
};

}  // namespace clothbench::pbd_gpu
