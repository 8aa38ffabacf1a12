#pragma once

namespace clothbench::truth {

/// The value itself if it is what its name says; otherwise (NaN and infinity included) an Error that names the
/// argument, what was expected, and what came.
double positive(double value, const char* argument);
double non_negative(double value, const char* argument);
double within(double value, double least, double greatest, const char* argument);  ///< ends included
double between(double value, double lower, double upper, const char* argument);    ///< ends excluded
int at_least(int value, int least, const char* argument);

}  // namespace clothbench::truth
