#include "base/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/record.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kDeepest = 64;
constexpr std::size_t kShown = 120;  // maximum bytes that a message shows of the input or of a library's message

std::string at(const std::string& text, std::size_t byte) {
  byte = std::min(byte, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(byte), '\n');
  const std::size_t newline = byte == 0 ? std::string::npos : text.rfind('\n', byte - 1);
  return fmt::format("line {}, column {}", line, newline == std::string::npos ? byte : byte - newline - 1);
}

/// Rejects repeated keys and unlimited nesting, which nlohmann's parser accepts; builds no value.
class Strict : public nlohmann::json_sax<json> {
 public:
  Strict(const std::string& text, const std::string& source) : text_(text), source_(source) {}
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return push(); }
  bool start_array(std::size_t) override { return push(); }
  bool end_object() override { return pop(); }
  bool end_array() override { return pop(); }
  bool key(string_t& k) override {
    path_.back() = k;
    if (keys_.back().insert(k).second) return true;
    std::string pointer;
    for (const std::string& p : path_) pointer += "/" + shortened(p, kShown);
    throw Error(source_ + ": " + pointer + ": this key occurs twice; expected it once");
  }
  bool parse_error(std::size_t byte, const std::string&, const nlohmann::detail::exception& e) override {
    constexpr int kOutOfRange = 406;
    throw Error(fmt::format("{}: {}: not valid JSON: {}", source_, at(text_, byte),
                            e.id == kOutOfRange ? "a number beyond double range" : what_without_text(e)));
  }

 private:
  bool pop() {
    keys_.pop_back();
    path_.pop_back();
    return true;
  }
  bool push() {
    keys_.emplace_back();
    path_.emplace_back("…");
    if (keys_.size() > kDeepest) throw Error(fmt::format("{}: nested deeper than {} levels", source_, kDeepest));
    return true;
  }
  const std::string& text_;
  const std::string& source_;
  std::vector<std::set<std::string>> keys_;
  std::vector<std::string> path_;
};

/// The sub-schema that `$ref` refers to; `schema` itself if it has no `$ref`.
const json& sub_schema(const json& schema, const json& root) {
  if (!schema.contains("$ref")) return schema;
  return root.at(json::json_pointer(schema["$ref"].get<std::string>().substr(1)));
}

/// Whether an empty object is valid, so that a missing object may be replaced by its defaults.
bool may_be_empty(const json& s) {
  return s.contains("properties") && !s.contains("required") && !s.contains("minProperties") &&
         s.value("type", json()) == "object";
}

void fill(json& value, const json& schema, const json& root) {
  const json& s = sub_schema(schema, root);
  if (value.is_object() && s.contains("properties"))
    for (const auto& [key, sub] : s["properties"].items()) {
      const json& target = sub_schema(sub, root);
      if (!value.contains(key)) {
        if (sub.contains("default"))
          value[key] = sub["default"];
        else if (may_be_empty(target))
          value[key] = json::object();
        else
          continue;
      }
      fill(value[key], sub, root);
    }
  if (value.is_array() && s.contains("items"))
    for (json& item : value) fill(item, s["items"], root);
}

std::string pointer_of(const std::vector<std::string>& context) {
  json::json_pointer pointer;
  for (std::size_t i = 1; i < context.size(); ++i) {
    std::string part = context[i];
    if (part.size() >= 2 && part.front() == '[' && part.back() == ']') part = part.substr(1, part.size() - 2);
    pointer.push_back(part);
  }
  return pointer.to_string();
}

/// Sub-schema for a pointer; null if the schema does not define it.
json schema_at(const json& root, const std::string& pointer) {
  json s = root;
  std::size_t i = 1;
  while (i < pointer.size()) {
    const std::size_t end = std::min(pointer.find('/', i), pointer.size());
    const std::string part = pointer.substr(i, end - i);
    s = json(sub_schema(s, root));
    if (s.contains("properties") && s["properties"].contains(part))
      s = json(s["properties"][part]);
    else if (s.contains("items"))
      s = json(s["items"]);
    else if (s.contains("additionalProperties"))
      s = json(s["additionalProperties"]);
    else
      return json();
    i = end + 1;
  }
  return json(sub_schema(s, root));
}

std::string expectation(const json& s) {
  if (!s.is_object()) return "";
  std::vector<std::string> parts;
  if (s.contains("type")) parts.push_back(s["type"].is_string() ? s["type"].get<std::string>() : dump(s["type"]));
  if (s.contains("enum")) parts.push_back("one of " + dump(s["enum"]));
  if (s.contains("minimum")) parts.push_back(">= " + dump(s["minimum"]));
  if (s.contains("exclusiveMinimum")) parts.push_back("> " + dump(s["exclusiveMinimum"]));
  if (s.contains("maximum")) parts.push_back("<= " + dump(s["maximum"]));
  if (s.contains("minItems") && s.contains("maxItems") && s["minItems"] == s["maxItems"])
    parts.push_back(dump(s["minItems"]) + " items");
  else if (s.contains("minItems"))
    parts.push_back("at least " + dump(s["minItems"]) + " items");
  else if (s.contains("maxItems"))
    parts.push_back("at most " + dump(s["maxItems"]) + " items");
  if (s.contains("minLength")) parts.push_back("at least " + dump(s["minLength"]) + " characters");
  if (s.contains("pattern")) parts.push_back("matching " + s["pattern"].get<std::string>());
  return joined(parts);
}

/// First key of an object that is not in its schema, and the most similar known one (valijson names only the object).
std::string unknown_key(const json& value, const json& schema, const json& root, const std::string& pointer) {
  const json s = json(sub_schema(schema, root));
  if (value.is_object() && s.contains("properties")) {
    const json& known = s["properties"];
    for (const auto& [key, sub] : value.items()) {
      if (known.contains(key)) {
        if (std::string found = unknown_key(sub, known[key], root, pointer + "/" + key); !found.empty()) return found;
      } else if (s.value("additionalProperties", json(true)) == json(false)) {
        std::vector<std::string> names;
        for (const auto& [name, unused] : known.items()) names.push_back(name);
        return fmt::format("{}/{}: unknown key{}", pointer, shortened(key, 40), nearest_known(key, names));
      }
    }
  }
  if (value.is_array() && s.contains("items"))
    for (std::size_t i = 0; i < value.size(); ++i)
      if (std::string found = unknown_key(value[i], s["items"], root, fmt::format("{}/{}", pointer, i)); !found.empty())
        return found;
  return "";
}

/// Long strings would overflow the stack, because the validator matches patterns by recursion, one level per character.
void refuse_long_strings(const json& value, const std::string& source, const std::string& pointer) {
  constexpr std::size_t kMost = 4096;
  if (value.is_string() && value.get_ref<const std::string&>().size() > kMost)
    throw Error(fmt::format("{}: {}: a string of {} bytes; expected at most {}", source, pointer,
                            value.get_ref<const std::string&>().size(), kMost));
  if (value.is_structured())
    for (const auto& [key, item] : value.items()) refuse_long_strings(item, source, pointer + "/" + shortened(key, 40));
}

std::string missing_key(const json& value, const json& schema) {
  if (!value.is_object() || !schema.is_object() || !schema.contains("required")) return "";
  for (const auto& key : schema["required"])
    if (!value.contains(key.get<std::string>())) return key.get<std::string>();
  return "";
}

}  // namespace

// For a syntax error the library gives position, cause, "last read:" with the text, and sometimes what it expected.
std::string what_without_text(const std::exception& e) {
  const std::string what = e.what();
  const std::size_t place = what.find("column"), colon = what.find(": ", place), read = what.find("; last read: ");
  if (colon == std::string::npos) return shortened(what, kShown);
  const std::size_t expected = what.rfind("; expected ");
  return shortened(what.substr(colon + 2, read - (read == std::string::npos ? 0 : colon + 2)) +
                       (read < expected && expected != std::string::npos ? what.substr(expected) : std::string()),
                   kShown);
}

void refuse(const std::string& source, const std::string& pointer, const std::string& expected) {
  throw Error(source + ": " + pointer + ": " + expected);
}

std::string read_text(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) throw Error(path.string() + ": no such file");
  if (std::filesystem::is_directory(path, ec)) throw Error(path.string() + ": a folder; expected a file");
  const auto size = std::filesystem::file_size(path, ec);
  if (!ec && size > most_bytes)
    throw Error(fmt::format("{}: {} bytes; at most {} are read", path.string(), size, most_bytes));
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw Error(path.string() + ": cannot be read");
  return text.str();
}

nlohmann::json parse_json(const std::string& text, const std::string& source) {
  if (text.empty()) throw Error(source + ": line 1, column 1: not valid JSON: the file is empty");
  Strict strict(text, source);
  json::sax_parse(text, &strict);
  return json_from(text);
}

nlohmann::json json_from(std::string_view text) { return json::parse(text); }

nlohmann::json json_or_discarded(std::string_view text) { return json::parse(text, nullptr, false); }

std::string dump(const nlohmann::json& value, int indent, bool ascii, json::error_handler_t on_error) {
  return value.dump(indent, ' ', ascii, on_error);
}

void fill_defaults(nlohmann::json& value, const std::string& schema_text) {
  const json schema = json_from(schema_text);
  fill(value, schema, schema);
}

// Reduces valijson's errors to one message: place of the deepest violation, the expected value, and the value found.

void validate_json(const nlohmann::json& value, const std::string& schema_text, const std::string& source,
                   const std::string& base) {
  const json schema_json = json_from(schema_text);
  if (const std::string fault = unknown_key(value, schema_json, schema_json, base); !fault.empty())
    throw Error(source + ": " + fault);
  if (schema_text.find("\"pattern\"") != std::string::npos) refuse_long_strings(value, source, base);

  valijson::Schema schema;
  valijson::SchemaParser parser;
  valijson::adapters::NlohmannJsonAdapter schema_adapter(schema_json), value_adapter(value);
  parser.populateSchema(schema_adapter, schema);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, value_adapter, &results)) return;

  std::vector<std::string> deepest;
  for (valijson::ValidationResults::Error e; results.popError(e);)
    if (e.context.size() > deepest.size()) deepest = e.context;
  const std::string pointer = pointer_of(deepest);
  const json sub = schema_at(schema_json, pointer);
  const json found = value.at(json::json_pointer(pointer));
  const std::string where = base + shortened(pointer, 200);
  if (const std::string key = missing_key(found, sub); !key.empty())
    throw Error(fmt::format("{}: {}: \"{}\" is missing", source, where.empty() ? "/" : where, key));
  throw Error(fmt::format("{}: {}: expected {}; found {}", source, where.empty() ? "/" : where, expectation(sub),
                          shortened(dump(found, -1, false, json::error_handler_t::replace), 60)));
}

json finite_or_null(double v) { return std::isfinite(v) ? json(v) : json(); }

json number_to_json(double v) {
  if (std::isnan(v)) return nullptr;
  if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
  return v;
}

double number_from_json(const json& j, const std::string& name) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (j.is_number()) return j.get<double>();
  if (j.is_null()) return kMissing;
  if (j == "inf") return kInfinity;
  if (j == "-inf") return -kInfinity;
  throw Error(name + R"(: expected a number, null, "inf" or "-inf"; found )" + shortened(dump(j), 60));
}

json numbers_to_json(const std::map<std::string, double>& values) {
  json j = json::object();
  for (const auto& [name, v] : values) j[name] = number_to_json(v);
  return j;
}

std::map<std::string, double> numbers_from_json(const json& j) {
  std::map<std::string, double> values;
  for (const auto& [name, v] : j.items()) values[name] = number_from_json(v, name);
  return values;
}

}  // namespace clothbench
