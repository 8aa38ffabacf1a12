#include "base/interval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"

namespace clothbench {

Interval wilson_95(std::size_t passed, std::size_t drawn) {
  if (passed > drawn) throw Error(fmt::format("Wilson's interval: {} of {} passed", passed, drawn));
  if (drawn == 0) return {0, 1};
  constexpr double z = 1.959963984540054;  // 97.5 % point of the normal distribution
  const double n = static_cast<double>(drawn), p = static_cast<double>(passed) / n, zz = z * z / n;
  const double middle = (p + zz / 2) / (1 + zz), half = z / (1 + zz) * std::sqrt(p * (1 - p) / n + zz / (4 * n));
  return {passed == 0 ? 0 : std::max(0.0, middle - half), passed == drawn ? 1 : std::min(1.0, middle + half)};
}

}  // namespace clothbench
