#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "clothbench/error.hpp"

namespace clothbench {

/// Bounds of a value; NaN if unknown.
struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN(), high = low;
};

/// 95 % Wilson score interval of the pass probability if `passed` of `drawn` independent trials passed; [0, 1] if there
/// were none. Throws Error if passed > drawn. Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
inline Interval wilson_95(std::size_t passed, std::size_t drawn) {
  if (passed > drawn)
    throw Error("Wilson's interval: " + std::to_string(passed) + " of " + std::to_string(drawn) + " passed");
  if (drawn == 0) return {0, 1};
  constexpr double z = 1.959963984540054;  // 97.5 % point of the normal distribution
  const double n = static_cast<double>(drawn), p = static_cast<double>(passed) / n, zz = z * z / n;
  const double middle = (p + zz / 2) / (1 + zz), half = z / (1 + zz) * std::sqrt(p * (1 - p) / n + zz / (4 * n));
  return {passed == 0 ? 0 : std::max(0.0, middle - half), passed == drawn ? 1 : std::min(1.0, middle + half)};
}

/// Quantile `q` (0 to 1) of the finite values, interpolated linearly; NaN if there are none.
inline double quantile(std::vector<double> v, double q) {
  std::erase_if(v, [](double x) { return !std::isfinite(x); });
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(v.begin(), v.end());
  const double at = q * (static_cast<double>(v.size()) - 1);
  const auto i = static_cast<std::size_t>(at);
  return i + 1 < v.size() ? v[i] + (at - static_cast<double>(i)) * (v[i + 1] - v[i]) : v.back();
}

}  // namespace clothbench
