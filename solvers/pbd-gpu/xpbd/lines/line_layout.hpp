#pragma once
#include <cstdint>
#include <vector>

#include "xpbd/constraints.hpp"

namespace clothbench::pbd_gpu {

/// One flag for each chain of the four colours (rows, columns, both diagonals; max(columns, rows) each): 1 if it may be
/// straight between two held vertices, where it has one more link than degrees of freedom.
std::vector<std::uint8_t> over_constrained_lines(const Scene&);

/// Properties of a device that decide how lines are spread over threads.
struct LineDevice {
  std::uint32_t subgroup = 32;  ///< lanes that can shuffle values
  std::uint32_t max_threads = 128, shared_B = 16384;
  /// Use two vertices per thread and workgroups of up to 1024 threads. On an H200 this is faster by 8 to 14 % up to
  /// 32 x 32 and by a quarter above; other devices may have too few registers.
  bool wide = false;
};

/// Distribution of chains over threads: `lanes` threads per chain, `vertices` per thread, `threads` per workgroup.
struct LineShape {
  std::uint32_t lanes = 0, vertices = 0, threads = 0;
  std::uint32_t beside = 1;  ///< neighbouring chains whose threads are interleaved, so that loads are contiguous
  std::uint32_t chains_a_group() const { return threads / lanes; }
};
/// Requested members of a LineShape; 0: chosen by the functions below.
struct LineRequest {
  std::uint32_t vertices = 0, threads = 0, beside = 0;
  bool corrects_splitting = false;  ///< vertices also store a shift (xpbd/time/README.md)
};
/// Shape of line_frame, which simulates a frame in one workgroup; threads = 0 if the cloth or the device does not fit.
LineShape frame_shape(int columns, int rows, const LineRequest&, const LineDevice&);
/// Shape of line_pass for lines of `length` vertices. On wide devices (an H200), two vertices per thread are fastest up
/// to 384 vertices, and 2 or 4 interleaved chains above 192. Throws Error above 8192.
LineShape pass_shape(int length, const LineRequest&, const LineDevice&);

/// Rounds of cyclic reduction after which the remaining off-diagonal entries of the bending system are below 1e-7; at
/// most log2(lanes). Few are needed if alpha is far above the inverse masses: hinges are then weakly coupled.
std::uint32_t bend_rounds(double alpha, double max_inverse_mass, const LineShape&);

}  // namespace clothbench::pbd_gpu
