#pragma once
#include <functional>
#include <string>
#include <vector>

namespace clothbench {

/// Where a row of a stability map turns, along an axis of positive values.
struct Boundary {
  double last_good = 0;  ///< 0: none is
  double first_bad = 0;  ///< infinite: none is
};

/// The first turn from good to bad along ascending `values`, by bisection of the logarithm down to `decades`. Values
/// are probed in order, at most `after_bad` of them beyond the first bad one (to see whether what lies there is bad
/// too). `good(x)` is asked once for each x.
Boundary find_boundary(const std::vector<double>& values, double decades, int after_bad,
                       const std::function<bool(double)>& good);

/// A product of powers such as "x", "-0.5*x", "x^-1" or "2*x*y^0.5" at x and y. Throws Error naming the text.
double evaluate(const std::string& expression, double x, double y);

}  // namespace clothbench
