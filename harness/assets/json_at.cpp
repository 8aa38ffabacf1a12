#include "assets/json_at.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::assets {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string escaped(const std::string& name) {
  std::string out;
  for (char c : name) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

std::string what_is(const nlohmann::json& j) {
  return shortened(j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), 60);
}

}  // namespace

JsonAt::JsonAt(const nlohmann::json& root, std::string source)
    : JsonAt(root, std::make_shared<const std::string>(std::move(source)), "") {}

JsonAt::JsonAt(const nlohmann::json& value, std::shared_ptr<const std::string> source, std::string pointer)
    : value_(&value), source_(std::move(source)), pointer_(std::move(pointer)) {}

void JsonAt::fail(const std::string& message) const {
  throw Error(*source_ + ": " + (pointer_.empty() ? "/" : pointer_) + ": " + message);
}

std::optional<JsonAt> JsonAt::maybe(const std::string& name) const {
  if (!value_->is_object()) fail("expected an object, not " + what_is(*value_));
  const auto found = value_->find(name);
  if (found == value_->end()) return std::nullopt;
  return JsonAt(*found, source_, pointer_ + "/" + escaped(name));
}

JsonAt JsonAt::key(const std::string& name) const {
  const std::optional<JsonAt> found = maybe(name);
  if (!found) fail("\"" + name + "\" is missing");
  return *found;
}

JsonAt JsonAt::item(std::size_t i) const {
  if (i >= size()) fail(fmt::format("expected at least {} items", i + 1));
  return JsonAt((*value_)[i], source_, fmt::format("{}/{}", pointer_, i));
}

std::size_t JsonAt::size() const {
  if (!value_->is_array()) fail("expected an array, not " + what_is(*value_));
  return value_->size();
}

double JsonAt::number() const {
  if (!value_->is_number()) fail("expected a number, not " + what_is(*value_));
  const double v = value_->get<double>();
  if (!std::isfinite(v)) fail("expected a finite number");
  return v;
}

double JsonAt::number_or(const std::string& name, double otherwise) const {
  const auto found = maybe(name);
  return found ? found->number() : otherwise;
}

std::string JsonAt::text() const {
  if (!value_->is_string()) fail("expected a string, not " + what_is(*value_));
  return value_->get<std::string>();
}

bool JsonAt::boolean() const {
  if (!value_->is_boolean()) fail("expected true or false, not " + what_is(*value_));
  return value_->get<bool>();
}

Eigen::VectorXd JsonAt::numbers(std::size_t n) const {
  if (size() != n) fail(fmt::format("expected {} numbers, not {}", n, size()));
  Eigen::VectorXd out(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) out[static_cast<Eigen::Index>(i)] = item(i).number();
  return out;
}

void JsonAt::only(const std::vector<std::string>& known) const {
  if (!value_->is_object()) fail("expected an object, not " + what_is(*value_));
  for (const auto& [name, unused] : value_->items()) {
    if (contains(known, name)) continue;
    fail(fmt::format("unknown key {}; known: {}{}", in_quotes(name), joined(known), nearest_known(name, known)));
  }
}

std::string JsonAt::word(const std::vector<std::string>& known) const {
  const std::string given = text();
  if (contains(known, given)) return given;
  fail(fmt::format("{} is not one of {}{}", in_quotes(given), joined(known), nearest_known(given, known)));
}

std::string encode_base64(const std::uint8_t* bytes, std::size_t count) {
  std::string text;
  text.reserve((count + 2) / 3 * 4);
  for (std::size_t i = 0; i < count; i += 3) {
    const std::size_t there = count - i < 3 ? count - i : 3;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < there ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= there ? kDigits[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

std::vector<std::uint8_t> JsonAt::bytes() const {
  if (!value_->is_string()) fail("expected a string, not " + what_is(*value_));
  const auto& text = value_->get_ref<const std::string&>();
  if (text.size() % 4 != 0)
    fail(fmt::format("{} characters of base64; expected a multiple of 4 (cut off?)", text.size()));
  std::size_t digits = text.size();
  while (digits > 0 && text.size() - digits < 2 && text[digits - 1] == '=') --digits;
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (std::size_t i = 0; i < digits; ++i) {
    const std::size_t v = kDigits.find(text[i]);
    if (v == kDigits.npos) fail(fmt::format("character {} is not of the base64 alphabet", i));
    bits = (bits << 6 | static_cast<std::uint32_t>(v)) & 0xffffffu;
    held += 6;
    if (held >= 8) {
      held -= 8;
      out.push_back(static_cast<std::uint8_t>(bits >> held));
    }
  }
  if ((bits & ((1u << held) - 1u)) != 0) fail("the last base64 character has bits set that belong to no byte");
  return out;
}

}  // namespace clothbench::assets
