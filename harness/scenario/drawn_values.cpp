#include "scenario/drawn_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

using nlohmann::json;

double rounded(double x) { return std::round(x * 1e6) / 1e6; }

Vec3 rounded(const Vec3& v) { return {rounded(v[0]), rounded(v[1]), rounded(v[2])}; }

Vec3 euler_deg(const std::array<Vec3, 3>& m) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  return {kDegrees * std::atan2(m[2][1], m[2][2]), kDegrees * std::asin(std::clamp(-m[2][0], -1.0, 1.0)),
          kDegrees * std::atan2(m[1][0], m[0][0])};
}

DrawnValues::DrawnValues(Dice dice, const json& ranges, std::string at)
    : dice_(std::move(dice)), ranges_(ranges), at_(std::move(at)) {}

std::array<double, 2> DrawnValues::range(const std::string& name) {
  if (!ranges_.contains(name)) throw Error(fmt::format("{}: \"{}\" is missing", at_, name));
  used_.insert(name);
  const std::array<double, 2> r = {ranges_[name][0].get<double>(), ranges_[name][1].get<double>()};
  if (!(r[0] <= r[1])) throw Error(fmt::format("{}/{}: expected the lower bound first", at_, name));
  return r;
}

double DrawnValues::between(const std::string& name, const std::string& as) {
  const auto [low, high] = range(name);
  const double x = rounded(dice_.between(low, high));
  note(as, x);
  return x;
}

double DrawnValues::log_between(const std::string& name) {
  const auto [low, high] = range(name);
  if (!(low > 0)) throw Error(fmt::format("{}/{}: expected a range above 0", at_, name));
  const double x = rounded(dice_.log_between(low, high));
  note(name, x);
  return x;
}

int DrawnValues::whole(const std::string& name) {
  const auto [low, high] = range(name);
  if (low != std::floor(low) || high != std::floor(high))
    throw Error(fmt::format("{}/{}: expected whole numbers", at_, name));
  const int x = dice_.whole(static_cast<int>(low), static_cast<int>(high));
  note(name, x);
  return x;
}

void DrawnValues::check_all_used() const {
  for (const auto& [name, unused] : ranges_.items())
    if (!used_.contains(name))
      throw Error(fmt::format("{}/{}: nothing is drawn from it{}", at_, name,
                              nearest_known(name, {used_.begin(), used_.end()})));
}

}  // namespace clothbench
