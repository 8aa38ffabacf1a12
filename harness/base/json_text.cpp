#include "base/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kDeepest = 64;
constexpr std::size_t kShown = 120;  // bytes of the input, or of a library's words about it, in a message

std::string at(const std::string& text, std::size_t byte) {
  byte = std::min(byte, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(byte), '\n');
  const std::size_t newline = byte == 0 ? std::string::npos : text.rfind('\n', byte - 1);
  return fmt::format("line {}, column {}", line, newline == std::string::npos ? byte : byte - newline - 1);
}

/// Rejects what nlohmann's own parser lets pass: repeated keys and bottomless nesting; builds nothing.
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

/// An object that is right without any key, so that its defaults may stand for it.
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

}  // namespace

// For a syntax error the library says where, what, "last read:" with the text, and perhaps what it expected.
std::string what_without_text(const std::exception& e) {
  const std::string what = e.what();
  const std::size_t place = what.find("column"), colon = what.find(": ", place), read = what.find("; last read: ");
  if (colon == std::string::npos) return shortened(what, kShown);
  const std::size_t expected = what.rfind("; expected ");
  return shortened(what.substr(colon + 2, read - (read == std::string::npos ? 0 : colon + 2)) +
                       (read < expected && expected != std::string::npos ? what.substr(expected) : std::string()),
                   kShown);
}

const json& sub_schema(const json& schema, const json& root) {
  if (!schema.contains("$ref")) return schema;
  return root.at(json::json_pointer(schema["$ref"].get<std::string>().substr(1)));
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
  return json::parse(text);
}

void fill_defaults(nlohmann::json& value, const std::string& schema_text) {
  const json schema = json::parse(schema_text);
  fill(value, schema, schema);
}

}  // namespace clothbench
