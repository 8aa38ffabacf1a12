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
Reduction greatest_settled(const char* series);  ///< over the scene's last half second; NaN unless the pass is complete
Reduction greatest_last_second(const char* series);  ///< the same over its last second
Reduction mean_last_second(const char* series);
/// A reduction by a custom rule.
inline Reduction own(std::vector<std::string> series, std::string what, std::function<double(const RunView&)> value,
                     std::string units) {
  return {std::move(series), std::move(what), std::move(value), std::move(units)};
}

/// Greatest value from an index on; NaN if any is NaN, or if there are none.
double greatest_of(const std::vector<double>* values, std::size_t from = 0);

}  // namespace clothbench
