#pragma once
#include <utility>
#include <vector>

#include "metrics/registry.hpp"

namespace clothbench {

/// Of one series. NaN in any frame gives NaN, no such series too.
Reduction greatest(const char* series);
Reduction last(const char* series);
Reduction sum(const char* series);
Reduction time_mean(const char* series);             ///< by trapezoids
Reduction greatest_settled(const char* series);      ///< of the scene's last half second; NaN unless the pass is whole
Reduction greatest_last_second(const char* series);  ///< the same of its last second
Reduction mean_last_second(const char* series);
/// By a rule of its own.
inline Reduction own(std::vector<std::string> series, std::string what, std::function<double(const RunView&)> value,
                     std::string units) {
  return {std::move(series), std::move(what), std::move(value), std::move(units)};
}

/// Of values: greatest from an index on, NaN if any is, or there are none.
double greatest_of(const std::vector<double>* values, std::size_t from = 0);
/// By trapezoids; NaN of less than two values.
double mean_over_time(const std::vector<double>& values, const std::vector<double>& time_s);

}  // namespace clothbench
