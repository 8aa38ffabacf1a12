#pragma once
#include <cstdint>
#include <vector>

#include "xpbd/constraints.hpp"

namespace clothbench::pbd_gpu {

/// One flag for each chain of the four colours (rows, columns, both diagonals; max(columns, rows) each): 1 if two held
/// vertices may pull it over-constrained, so that its links are one more than its degrees of freedom.
std::vector<std::uint8_t> over_constrained_lines(const Scene&);

/// Properties of a device that decide how lines are spread over threads.
struct LineDevice {
  std::uint32_t subgroup = 32;  ///< lanes that exchange by shuffles
  std::uint32_t max_threads = 128, shared_B = 16384;
  /// Use two vertices per thread and workgroups of up to 1024 threads. On an H200 this is faster by 8 to 14 % up to
  /// 32 x 32 and by a quarter above; other devices may have too few registers.
  bool wide = false;
};

/// How chains are spread over threads: `lanes` threads per chain, `vertices` a thread, `threads` a workgroup.
struct LineShape {
  std::uint32_t lanes = 0, vertices = 0, threads = 0;
  std::uint32_t beside = 1;  ///< neighbouring chains whose threads take turns
  std::uint32_t chains_a_group() const { return threads / lanes; }
};
/// The user's request for a shape; 0: chosen here.
struct LineRequest {
  std::uint32_t vertices = 0, threads = 0, beside = 0;
  bool corrects_splitting = false;  ///< a vertex has a shift too (xpbd/time/README.md)
};
/// Shape of the kernel that computes a frame of a whole cloth; threads = 0 if the cloth or the device does not fit it.
LineShape frame_shape(int columns, int rows, const LineRequest&, const LineDevice&);
/// Shape of the kernel of one colour of lines of `length` vertices. On wide devices (an H200) two vertices per thread
/// are fastest up to some 384, and reading 2 or 4 neighbouring columns at once above 192. Throws Error past 8192.
LineShape pass_shape(int length, const LineRequest&, const LineDevice&);

/// Rounds of cyclic reduction after which the off-diagonal rest of the bending matrix is below 1e-7; at most
/// log2(lanes). Few are needed if alpha is far above the inverse masses, because hinges are then weakly coupled.
std::uint32_t bend_rounds(double alpha, double max_inverse_mass, const LineShape&);

}  // namespace clothbench::pbd_gpu
