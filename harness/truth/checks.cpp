#include <cmath>
#include <limits>
#include <sstream>

#include "clothbench/error.hpp"
#include "truth/solutions.hpp"

namespace clothbench::truth {
namespace {

template <class Number>
Number checked(bool good, Number value, const char* argument, const std::string& expected) {
  if (good) return value;
  std::ostringstream message;
  message << "argument " << argument << ": expected " << expected << ", got " << value;
  throw Error(message.str());
}

std::string text(double value) {
  std::ostringstream out;
  out.precision(std::numeric_limits<double>::max_digits10);
  out << value;
  return out.str();
}

}  // namespace

double positive(double value, const char* argument) {
  return checked(std::isfinite(value) && value > 0, value, argument, "a finite number above 0");
}

double non_negative(double value, const char* argument) {
  return checked(std::isfinite(value) && value >= 0, value, argument, "a finite number, 0 or more");
}

double within(double value, double least, double greatest, const char* argument) {
  return checked(value >= least && value <= greatest, value, argument,
                 "a number from " + text(least) + " to " + text(greatest));
}

double between(double value, double lower, double upper, const char* argument) {
  return checked(value > lower && value < upper, value, argument,
                 "a number above " + text(lower) + " and below " + text(upper));
}

int at_least(int value, int least, const char* argument) {
  return checked(value >= least, value, argument, "a whole number, " + std::to_string(least) + " or more");
}

}  // namespace clothbench::truth
