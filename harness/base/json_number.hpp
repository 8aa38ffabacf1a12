#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// How stored JSON holds a double. JSON has neither NaN nor infinity: null is missing, the texts "inf" and "-inf" are
/// the infinities. Every file that is read back goes through these functions.
nlohmann::json number_to_json(double);

/// For pages and figures, which draw nothing where there is no number: null for the infinities too.
nlohmann::json finite_or_null(double);

/// Throws Error naming `name` if the value is none of number, null, "inf" and "-inf".
double number_from_json(const nlohmann::json&, const std::string& name);

nlohmann::json numbers_to_json(const std::map<std::string, double>&);
std::map<std::string, double> numbers_from_json(const nlohmann::json&);

}  // namespace clothbench
