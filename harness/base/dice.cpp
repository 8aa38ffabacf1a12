#include "base/dice.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace clothbench {

using std::numbers::pi;

Dice::Dice(std::uint64_t seed, const std::string& word) {
  std::vector<std::uint32_t> words = {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)};
  for (const char c : word) words.push_back(static_cast<unsigned char>(c));
  std::seed_seq sequence(words.begin(), words.end());
  engine_.seed(sequence);
}

double Dice::unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
double Dice::between(double low, double high) { return low + (high - low) * unit(); }
double Dice::log_between(double low, double high) { return low * std::pow(high / low, unit()); }
int Dice::whole(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }

std::array<std::array<double, 3>, 3> Dice::rotation() {
  const double u = unit(), a = 2 * pi * unit(), b = 2 * pi * unit();
  const double x = std::sqrt(1 - u) * std::sin(a), y = std::sqrt(1 - u) * std::cos(a), z = std::sqrt(u) * std::sin(b),
               w = std::sqrt(u) * std::cos(b);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

}  // namespace clothbench
