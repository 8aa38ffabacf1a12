#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <string>

namespace clothbench {

/// Random numbers that are equal on every machine. The engine is the standard's. The distributions are defined here,
/// because each library implements the standard's distributions in its own way.
class Dice {
 public:
  /// One sequence for each pair of a seed and a word.
  Dice(std::uint64_t seed, const std::string& word);

  double unit();  ///< uniform in [0, 1)
  double between(double low, double high);
  double log_between(double low, double high);  ///< uniform in the logarithm; both above 0
  int whole(int low, int high);                 ///< both included

  /// Rows of a rotation, uniform in SO(3). Source: Shoemake, Graphics Gems III, 1992.
  std::array<std::array<double, 3>, 3> rotation();

 private:
  std::mt19937_64 engine_;
};

}  // namespace clothbench
