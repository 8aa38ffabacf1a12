#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// Encodes a double for stored JSON. JSON has neither NaN nor infinity: null is a missing value, and the strings "inf"
/// and "-inf" are the infinities. Every JSON file that is read back uses these functions.
nlohmann::json number_to_json(double);

/// For pages and figures, which draw finite numbers only: null for NaN and for the infinities.
nlohmann::json finite_or_null(double);

/// Throws Error naming `name` if the value is none of number, null, "inf" and "-inf".
double number_from_json(const nlohmann::json&, const std::string& name);

nlohmann::json numbers_to_json(const std::map<std::string, double>&);
std::map<std::string, double> numbers_from_json(const nlohmann::json&);

}  // namespace clothbench
