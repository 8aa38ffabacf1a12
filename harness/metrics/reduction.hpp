#pragma once
#include <utility>
#include <vector>

#include "metrics/registry.hpp"

namespace clothbench {

/// Reductions of one series. The result is NaN if any frame is NaN or the series is missing.
Reduction greatest(const char* series);
Reduction least(const char* series);
Reduction last(const char* series);
Reduction sum(const char* series);
Reduction time_mean(const char* series);         ///< by trapezoids
Reduction greatest_settled(const char* series);  ///< over the scene's last half second; NaN unless the pass is complete
Reduction greatest_last_second(const char* series);  ///< the same over its last second
Reduction mean_last_second(const char* series);
/// A reduction by a custom rule.
inline Reduction own(std::vector<std::string> series, std::string what, std::function<double(const RunView&)> value,
                     std::string units) {
  return {std::move(series), std::move(what), std::move(value), std::move(units)};
}

/// Longest time [s] without a break in which `is` is true, one value a frame. A frame stands for the interval before
/// it.
double longest_time(const std::vector<bool>& is, const std::vector<double>& time_s);
/// Greatest value from an index on; NaN if any is NaN, or if there are none.
double greatest_of(const std::vector<double>* values, std::size_t from = 0);
/// By trapezoids; NaN for fewer than two values.
double mean_over_time(const std::vector<double>& values, const std::vector<double>& time_s);

}  // namespace clothbench
