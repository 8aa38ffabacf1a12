#pragma once
#include <boost/math/tools/roots.hpp>
#include <cstdint>
#include <string>

#include "clothbench/error.hpp"

namespace clothbench::truth {

/// The single root x > 0 of a monotonic function, increasing if `rising`, from a guess, to machine precision. Throws
/// Error, naming `what`, if none is found within a factor 2^200 of the guess.
template <class Function>
double positive_root(const Function& function, double guess, bool rising, const char* what) {
  std::uintmax_t iterations = 400;
  const auto tolerance = boost::math::tools::eps_tolerance<double>(52);
  try {
    const auto bracket =
        boost::math::tools::bracket_and_solve_root(function, guess, 2.0, rising, tolerance, iterations);
    return 0.5 * (bracket.first + bracket.second);
  } catch (const std::exception& e) {
    throw Error(std::string(what) + ": no root found: " + e.what());
  }
}

}  // namespace clothbench::truth
