#pragma once
#include <functional>
#include <string>
#include <vector>

namespace clothbench {

/// Boundary of a row of a stability map, along an axis of positive values.
struct Boundary {
  double last_good = 0;  ///< 0: no value is good
  double first_bad = 0;  ///< infinite: no value is bad
};

/// The first transition from good to bad along ascending `values`, by bisection of the logarithm down to `decades`.
/// Values are probed in order, at most `after_bad` of them beyond the first bad one (to see whether those are bad too).
/// `good(x)` is called once for each x.
Boundary find_boundary(const std::vector<double>& values, double decades, int after_bad,
                       const std::function<bool(double)>& good);

/// Evaluates a product of powers such as "x", "-0.5*x", "x^-1" or "2*x*y^0.5" at x and y. Throws Error naming the text.
double evaluate(const std::string& expression, double x, double y);

}  // namespace clothbench
