#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// Whole file as text. Throws Error naming the file: missing, a folder, unreadable, over 16 MiB.
std::string read_text(const std::filesystem::path&);

/// Strict JSON: no duplicate keys, no NaN or Infinity, no number beyond double range, nesting <= 64. Throws Error with
/// `source` and line and column, or the JSON pointer of a repeated key.
nlohmann::json parse_json(const std::string& text, const std::string& source);

/// Throws the Error of a value that the schema lets through: where it stands, and what was expected.
[[noreturn]] void refuse(const std::string& source, const std::string& pointer, const std::string& expected);

/// Checks against one of the schemas in scenarios/schema (compiled in). Throws one Error: the deepest violation, with
/// `source`, JSON pointer (below `pointer`, where the value stands in its file), what was expected and, for an unknown
/// key, the nearest known one.
void validate_json(const nlohmann::json&, const std::string& schema_text, const std::string& source,
                   const std::string& pointer = "");

/// The sub-schema that `$ref` means; the schema itself where it has none.
const nlohmann::json& sub_schema(const nlohmann::json& schema, const nlohmann::json& root);

/// Adds every `default` the schema names that is missing.
void fill_defaults(nlohmann::json&, const std::string& schema_text);

}  // namespace clothbench
