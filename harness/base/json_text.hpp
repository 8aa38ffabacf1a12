#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// Reads a whole file. Throws Error naming the file if it is missing, a folder, unreadable or over `most_bytes`, which
/// is checked before anything is read.
std::string read_text(const std::filesystem::path&, std::uintmax_t most_bytes = 16u << 20);

/// Strict JSON: no duplicate keys, no NaN or Infinity, no number beyond double range, nesting <= 64. Throws Error with
/// `source` and line and column, or the JSON pointer of a repeated key.
nlohmann::json parse_json(const std::string& text, const std::string& source);

/// The message of an exception of the JSON library, without the text that it had read.
std::string what_without_text(const std::exception&);

/// Throws Error for an invalid value that the schema cannot detect, with its place and what was expected.
[[noreturn]] void refuse(const std::string& source, const std::string& pointer, const std::string& expected);

/// Checks against one of the schemas in scenarios/schema (compiled in). Throws one Error: the deepest violation, with
/// `source`, JSON pointer (below `pointer`, the place of the value in its file), what was expected and, for an unknown
/// key, the nearest known one.
void validate_json(const nlohmann::json&, const std::string& schema_text, const std::string& source,
                   const std::string& pointer = "");

/// Adds each missing value that has a `default` in the schema.
void fill_defaults(nlohmann::json&, const std::string& schema_text);

}  // namespace clothbench
