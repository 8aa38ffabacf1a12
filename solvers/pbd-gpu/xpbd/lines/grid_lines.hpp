#pragma once
#include <array>

#include "common/frame_builder.hpp"
#include "xpbd/lines/line_layout.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {

inline constexpr FeatureSet kLineFeatures{Feature::Stretch, Feature::Shear, Feature::Bend,
                                          Feature::Damping, Feature::Pins,  Feature::MovingPins};

/// The constraints of `xpbd`: a substep integrates, applies tethers and solves rows, columns and diagonals, each line
/// directly. One dispatch takes any number of substeps: of one workgroup for small cloths, of many for larger ones
/// where the device runs them all at once. Else a substep takes four dispatches (two without shear).
class Lines {
 public:
  /// Adds its stages, buffers and kernels. The buffers of the state must exist, one vec4 per vertex: positions (.w =
  /// inverse mass), velocities, and the rounding errors of both (compensated sums).
  Lines(FrameBuilder& frame, const Scene& scene, bool uses_bdf2, bool tension, bool corrects_splitting);
  /// Adds its stages and kernels. With contact by separating planes vertices have any inverse mass while they are
  /// solved, which the kernel of a frame in one workgroup cannot do.
  void add_kernels(bool any_masses);
  /// Shape of the kernel of lines and contact in one.
  LineShape shape_with_contact() const;
  /// What a kernel of workgroups that run at once is specialized to.
  LineSpecialization persistent_specialization(const LineShape&);
  /// Shape of the kernel that takes a frame in one dispatch in one workgroup (threads 0 if cloth or device do not fit
  /// it), and what it is specialized to.
  LineShape single_dispatch_shape() const;
  LineSpecialization specialization(const LineShape&) const;
  vulkan::Groups groups_of(const LineShape&) const;
  LineConstants constants(double dt_s, int substeps, const TimeStep&) const;
  std::uint32_t passes() const { return scene_.needs.has(Feature::Shear) ? 4 : 2; }

  /// Records substeps [first, first + count) of the `substeps` of a frame of dt_s, each a TimeStep. A cloth that does
  /// not fit one dispatch takes one substep a call.
  void record(int first, int count, int substeps, double dt_s, const TimeStep&);
  bool is_single_dispatch() const { return substeps_ != nullptr && (moves_grips_ || scene_.grips.vertices.empty()); }
  /// True if its kernels move attached vertices with their hands.
  bool moves_grips() const { return moves_grips_; }

 private:
  LineDevice device() const;
  bool add_persistent();
  void add_passes();
  LineRequest request() const;

  FrameBuilder& frame_;
  const Scene& scene_;
  const Tethers tethers_;
  const bool uses_bdf2_, tension_, corrects_splitting_;
  bool regularised_ = false, moves_grips_ = false;
  const FrameKernel* substeps_ = nullptr;     ///< takes any number of substeps in a dispatch; else pass_ one colour
  std::array<const FrameKernel*, 3> pass_{};  ///< rows, columns, diagonals
  std::array<LineShape, 2> shape_{};          ///< of rows, and of columns and diagonals
};

}  // namespace clothbench::pbd_gpu
