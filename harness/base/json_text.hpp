#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// Reads a whole file. Throws Error naming the file if it is missing, a folder, unreadable or over `most_bytes`.
std::string read_text(const std::filesystem::path&, std::uintmax_t most_bytes = 16u << 20);

/// Parses strict JSON: no duplicate keys, no NaN or Infinity, no number beyond double range, nesting <= 64. Throws
/// Error with `source` and line and column, or with the JSON pointer of a repeated key.
nlohmann::json parse_json(const std::string& text, const std::string& source);

/// `parse` and `dump` of the JSON library, whose templates are compiled here once instead of in every module.
nlohmann::json json_from(std::string_view);
nlohmann::json json_or_discarded(std::string_view);
std::string dump(const nlohmann::json&, int indent = -1, bool ascii = false,
                 nlohmann::json::error_handler_t = nlohmann::json::error_handler_t::strict);

/// Message of a JSON library's exception, without the input text that it quotes.
std::string what_without_text(const std::exception&);

/// Throws Error, with the location and the expected value, for an invalid value that the schema cannot detect.
[[noreturn]] void refuse(const std::string& source, const std::string& pointer, const std::string& expected);

/// Checks a value against a schema of scenarios/schema (compiled in). Throws Error for the deepest violation: `source`,
/// JSON pointer (below `pointer`, the value's place in its file), the expected value, the most similar known key.
void validate_json(const nlohmann::json&, const std::string& schema_text, const std::string& source,
                   const std::string& pointer = "");

/// Adds each missing value for which the schema has a `default`.
void fill_defaults(nlohmann::json&, const std::string& schema_text);

/// Encodes a double for stored JSON, which has neither NaN nor infinity: null is a missing value, and the strings "inf"
/// and "-inf" are the infinities. Use it for every JSON file that is read back.
nlohmann::json number_to_json(double);

/// For pages and figures, which draw only finite numbers: null for NaN and the infinities.
nlohmann::json finite_or_null(double);

/// Throws Error naming `name` unless the value is a number, null, "inf" or "-inf".
double number_from_json(const nlohmann::json&, const std::string& name);

nlohmann::json numbers_to_json(const std::map<std::string, double>&);
std::map<std::string, double> numbers_from_json(const nlohmann::json&);

}  // namespace clothbench
