#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// Reads a whole file. Throws Error naming the file if it is missing, a folder, unreadable or over `most_bytes`.
std::string read_text(const std::filesystem::path&, std::uintmax_t most_bytes = 16u << 20);

/// Strict JSON: no duplicate keys, no NaN or Infinity, no number beyond double range, nesting <= 64. Throws Error with
/// `source` and line and column, or the JSON pointer of a repeated key.
nlohmann::json parse_json(const std::string& text, const std::string& source);

/// The message of an exception of the JSON library, without the text that it had read.
std::string what_without_text(const std::exception&);

/// Throws Error for an invalid value that the schema cannot detect, with its place and what was expected.
[[noreturn]] void refuse(const std::string& source, const std::string& pointer, const std::string& expected);

/// Checks against one of the schemas in scenarios/schema (compiled in). Throws Error of the deepest violation:
/// `source`, JSON pointer (below `pointer`, the value's place in its file), what was expected, the nearest known key.
void validate_json(const nlohmann::json&, const std::string& schema_text, const std::string& source,
                   const std::string& pointer = "");

/// Adds each missing value that has a `default` in the schema.
void fill_defaults(nlohmann::json&, const std::string& schema_text);

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
