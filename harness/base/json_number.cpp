#include "base/json_number.hpp"

#include <cmath>
#include <limits>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

nlohmann::json finite_or_null(double v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(); }

nlohmann::json number_to_json(double v) {
  if (std::isnan(v)) return nullptr;
  if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
  return v;
}

double number_from_json(const nlohmann::json& j, const std::string& name) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (j.is_number()) return j.get<double>();
  if (j.is_null()) return kMissing;
  if (j == "inf") return kInfinity;
  if (j == "-inf") return -kInfinity;
  throw Error(name + R"(: expected a number, null, "inf" or "-inf"; found )" + shortened(j.dump(), 60));
}

nlohmann::json numbers_to_json(const std::map<std::string, double>& values) {
  nlohmann::json j = nlohmann::json::object();
  for (const auto& [name, v] : values) j[name] = number_to_json(v);
  return j;
}

std::map<std::string, double> numbers_from_json(const nlohmann::json& j) {
  std::map<std::string, double> values;
  for (const auto& [name, v] : j.items()) values[name] = number_from_json(v, name);
  return values;
}

}  // namespace clothbench
