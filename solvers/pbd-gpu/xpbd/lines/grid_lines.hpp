#pragma once
#include <array>

#include "common/frame_builder.hpp"
#include "xpbd/lines/line_layout.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {

inline constexpr FeatureSet kLineFeatures{Feature::Stretch, Feature::Shear, Feature::Bend,
                                          Feature::Damping, Feature::Pins,  Feature::MovingPins};

/// The constraints of `xpbd` on an even grid: a substep predicts, applies tethers and solves diagonals, columns and
/// rows, each line directly. One dispatch simulates any number of substeps: with one workgroup for small cloths, with
/// many for larger ones if the device runs all at once. Otherwise a substep has four dispatches (two without shear).
class Lines {
 public:
  /// Adds its buffers. The buffers of the state must exist, one vec4 per vertex: positions (.w = inverse mass),
  /// velocities, and the rounding errors of both (compensated sums).
  Lines(FrameBuilder& frame, const Scene& scene, bool uses_bdf2, bool tension, bool corrects_splitting);
  /// Adds its stages and kernels. `any_masses`: contact changes inverse masses during a substep, so line_frame, which
  /// computes them, cannot be used.
  void add_kernels(bool any_masses);
  /// Shape of the fused kernel.
  LineShape shape_with_contact() const;
  /// Stores a shape; returns the specialization constants of a kernel of this shape whose workgroups all run at once.
  LineSpecialization persistent_specialization(const LineShape&);
  /// Shape of line_frame (threads 0 if the cloth or the device does not fit), and the specialization constants of a
  /// shape.
  LineShape single_dispatch_shape() const;
  LineSpecialization specialization(const LineShape&) const;
  vulkan::Groups groups_of(const LineShape&) const;
  LineConstants constants(double dt_s, int substeps, const TimeStep&) const;
  std::uint32_t passes() const { return scene_.needs.has(Feature::Shear) ? 4 : 2; }

  /// Records substeps [first, first + count) of the `substeps` of a frame of dt_s, each with this TimeStep. If no
  /// kernel simulates many substeps, `count` must be 1.
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
  const FrameKernel* substeps_ = nullptr;     ///< any number of substeps per dispatch; null: pass_ is used
  std::array<const FrameKernel*, 3> pass_{};  ///< one colour per dispatch: rows, columns, diagonals
  std::array<LineShape, 2> shape_{};          ///< of rows, and of columns and diagonals
};

}  // namespace clothbench::pbd_gpu
