#include "assets/base64.hpp"

#include <fmt/format.h>

namespace clothbench::assets {
namespace {

int value_of(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

}  // namespace

std::string encode_base64(const std::uint8_t* bytes, std::size_t count) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
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

bool decode_base64(std::string_view text, std::vector<std::uint8_t>& bytes, std::string& problem) {
  bytes.clear();
  if (text.size() % 4 != 0) {
    problem = fmt::format("{} characters of base64; expected a multiple of 4 (cut off?)", text.size());
    return false;
  }
  std::size_t digits = text.size();
  while (digits > 0 && text.size() - digits < 2 && text[digits - 1] == '=') --digits;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (std::size_t i = 0; i < digits; ++i) {
    const int v = value_of(text[i]);
    if (v < 0) {
      problem = fmt::format("character {} is not of the base64 alphabet", i);
      return false;
    }
    bits = (bits << 6 | static_cast<std::uint32_t>(v)) & 0xffffffu;
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> held));
    }
  }
  if ((bits & ((1u << held) - 1u)) != 0) {
    problem = "the last base64 character has bits set that belong to no byte";
    return false;
  }
  return true;
}

}  // namespace clothbench::assets
