#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace clothbench {

/// Random numbers that are the same on every machine: the C++ standard specifies engines, but not distributions.
class Dice {
 public:
  /// Each pair of a seed and a word gives its own sequence.
  Dice(std::uint64_t seed, const std::string& word);

  double unit();  ///< uniform in [0, 1)
  double between(double low, double high);
  double log_between(double low, double high);  ///< uniform in the logarithm; both bounds above 0
  int whole(int low, int high);                 ///< both bounds included

  /// Rows of a rotation, uniform in SO(3). Source: Shoemake, Graphics Gems III, 1992.
  std::array<std::array<double, 3>, 3> rotation();

 private:
  std::mt19937_64 engine_;
};

inline Dice::Dice(std::uint64_t seed, const std::string& word) {
  std::vector<std::uint32_t> words = {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)};
  for (const char c : word) words.push_back(static_cast<unsigned char>(c));
  std::seed_seq sequence(words.begin(), words.end());
  engine_.seed(sequence);
}

inline double Dice::unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
inline double Dice::between(double low, double high) { return low + (high - low) * unit(); }
inline double Dice::log_between(double low, double high) { return low * std::pow(high / low, unit()); }
inline int Dice::whole(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }

inline std::array<std::array<double, 3>, 3> Dice::rotation() {
  const double u = unit(), a = 2 * std::numbers::pi * unit(), b = 2 * std::numbers::pi * unit();
  const double x = std::sqrt(1 - u) * std::sin(a), y = std::sqrt(1 - u) * std::cos(a), z = std::sqrt(u) * std::sin(b),
               w = std::sqrt(u) * std::cos(b);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

}  // namespace clothbench
