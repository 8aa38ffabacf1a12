#pragma once
#include <array>
#include <cstring>
#include <vector>

#include "gpu_solver.hpp"
#include "line_plan.hpp"

namespace clothbench::pbd_gpu {

/// The constraints of `xpbd`: a substep integrates, tethers and solves rows, columns and diagonals, each line at once.
/// Small cloths take any number of substeps in one dispatch of one workgroup; larger ones in one dispatch of many,
/// where the device runs them all at once; else it is four dispatches a substep (two without shear).
class Lines {
 public:
  /// Adds its stages, buffers and kernels. Buffers hold one vec4 a vertex: positions (.w = inverse mass), velocities,
  /// and what their sums could not hold.
  Lines(GpuSolver& solver, const Scene& scene, const vulkan::Buffer& x, const vulkan::Buffer& v,
        const vulkan::Buffer& rx, const vulkan::Buffer& rv);

  /// Substeps [first, first + count) of `substeps` of a frame of dt_s. A cloth that does not fit one dispatch takes one
  /// at a time.
  void record(int first, int count, int substeps, double dt_s);
  bool whole_frame() const { return frame_ != nullptr || (resident_ != nullptr && scene_.grips.vertices.empty()); }
  /// Do held vertices go with their hands in here?
  bool moves_grips() const { return frame_ != nullptr; }

 private:
  struct Constraints {
    double links = 0, hinges = 0;  ///< those with a free vertex
  };
  LineDevice device() const;
  std::uint32_t features() const;
  std::vector<std::uint32_t> specialization(const LineShape&) const;
  std::vector<vulkan::Binding> bindings(const vulkan::Buffer* fifth);
  void add_frame(const LineShape&);
  bool add_resident();
  void add_passes();
  void add_firmness();
  LineWish wish() const;
  Traffic pass_traffic(std::uint32_t family, std::uint32_t iteration, bool first) const;
  Traffic rests_traffic() const;
  LineConstants constants(double dt_s, int substeps) const;
  Constraints count(std::uint32_t family) const;
  Traffic multiplier_traffic(std::uint32_t family, std::uint32_t iteration) const;
  void record_passes(LineConstants c);

  GpuSolver& solver_;
  const Scene& scene_;
  const vulkan::Buffer &x_, &v_, &rx_, &rv_;
  const Tethers tethers_;
  const std::vector<std::uint8_t> taut_;
  const std::uint32_t iterations_, batch_;
  const bool keep_;  ///< multipliers, from one iteration to the next
  bool firm_ = false;
  const vulkan::Buffer *link_multipliers_ = nullptr, *hinge_multipliers_ = nullptr, *firmness_ = nullptr;
  int stage_frame_ = -1;
  const vulkan::Kernel* frame_ = nullptr;
  const vulkan::Kernel* resident_ = nullptr;
  const vulkan::Buffer *meeting_ = nullptr, *missed_ = nullptr;
  std::array<int, 3> stage_{-1, -1, -1};  ///< rows, columns, diagonals
  std::array<const vulkan::Kernel*, 3> pass_{};
  std::array<LineShape, 3> shape_{};
};

}  // namespace clothbench::pbd_gpu
