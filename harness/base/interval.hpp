#pragma once
#include <cstddef>
#include <limits>

namespace clothbench {

/// Bounds of a value; NaN where they are not known.
struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN(), high = low;
};

/// 95 % Wilson score interval of the pass probability, if `passed` of `drawn` independent trials passed; [0, 1] without
/// trials. Throws Error if more passed than were drawn. Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
Interval wilson_95(std::size_t passed, std::size_t drawn);

}  // namespace clothbench
