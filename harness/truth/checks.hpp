#pragma once

namespace clothbench::truth {

/// Each returns the value if it meets the condition in the function's name. Otherwise (also for NaN and infinity) it
/// throws an Error that names the argument, the expected range, and the value.
double positive(double value, const char* argument);
double non_negative(double value, const char* argument);
double within(double value, double least, double greatest, const char* argument);  ///< ends included
double between(double value, double lower, double upper, const char* argument);    ///< ends excluded
int at_least(int value, int least, const char* argument);

}  // namespace clothbench::truth
