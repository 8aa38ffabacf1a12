#pragma once
#include <cstddef>

namespace clothbench {

/// Bounds of a share, both in [0, 1].
struct Interval {
  double low = 0, high = 1;
};

/// Wilson's score interval at 95 % for the probability behind `passed` of `drawn` independent trials; [0, 1] without
/// trials. Throws Error if more passed than were drawn. Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
Interval wilson_95(std::size_t passed, std::size_t drawn);

}  // namespace clothbench
