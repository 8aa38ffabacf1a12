#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace clothbench {

/// Quantile `q` (0 to 1) of the finite values, linear between them; NaN if there are none.
inline double quantile(std::vector<double> v, double q) {
  std::erase_if(v, [](double x) { return !std::isfinite(x); });
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(v.begin(), v.end());
  const double at = q * (static_cast<double>(v.size()) - 1);
  const auto i = static_cast<std::size_t>(at);
  return i + 1 < v.size() ? v[i] + (at - static_cast<double>(i)) * (v[i + 1] - v[i]) : v.back();
}

}  // namespace clothbench
