#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "base/dice.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Values that are drawn from named ranges and noted under their names.
class DrawnValues {
 public:
  /// `at`: file and JSON pointer of the ranges.
  DrawnValues(Dice dice, const nlohmann::json& ranges, std::string at);

  double between(const std::string& range) { return between(range, range); }
  /// Draws from a range and notes it under another name.
  double between(const std::string& range, const std::string& name);
  double log_between(const std::string& range);
  int whole(const std::string& range);

  void note(const std::string& name, nlohmann::json value) { values_[name] = std::move(value); }
  Dice& dice() { return dice_; }
  const nlohmann::json& values() const { return values_; }
  /// Throws Error if a range has not been used.
  void check_all_used() const;

 private:
  std::array<double, 2> range(const std::string& name);

  Dice dice_;
  const nlohmann::json& ranges_;
  const std::string at_;
  nlohmann::json values_ = nlohmann::json::object();
  std::set<std::string> used_;
};

/// To 1e-6.
double rounded(double);
Vec3 rounded(const Vec3&);

/// Angles [deg] about the world's x, then y, then z axis that give this rotation (its rows).
Vec3 euler_deg(const std::array<Vec3, 3>&);

/// The hand of a sweep or a push, in colliders[0]. Returns its speed [m/s].
double draw_sweep(nlohmann::json& scene, DrawnValues&);
double draw_push(nlohmann::json& scene, DrawnValues&);
/// The two hands of a stretch, in grips. Returns their speed [m/s].
double draw_stretch(nlohmann::json& scene, DrawnValues&);

}  // namespace clothbench
