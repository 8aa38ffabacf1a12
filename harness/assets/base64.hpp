#pragma once
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/json_text.hpp"

namespace clothbench::assets {

inline constexpr std::string_view kBase64Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Base64 of RFC 4648, section 4: padded, without line breaks.
inline std::string encode_base64(const std::uint8_t* bytes, std::size_t count) {
  std::string text;
  text.reserve((count + 2) / 3 * 4);
  for (std::size_t i = 0; i < count; i += 3) {
    const std::size_t there = count - i < 3 ? count - i : 3;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < there ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= there ? kBase64Digits[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

/// Throws Error with `source` and JSON pointer.
inline std::vector<std::uint8_t> decode_base64(const std::string& text, const std::string& source,
                                               const std::string& pointer) {
  if (text.size() % 4 != 0)
    refuse(source, pointer, fmt::format("{} characters of base64; expected a multiple of 4 (cut off?)", text.size()));
  std::size_t digits = text.size();
  while (digits > 0 && text.size() - digits < 2 && text[digits - 1] == '=') --digits;
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (std::size_t i = 0; i < digits; ++i) {
    const std::size_t v = kBase64Digits.find(text[i]);
    if (v == kBase64Digits.npos) refuse(source, pointer, fmt::format("character {} is not in the base64 alphabet", i));
    bits = (bits << 6 | static_cast<std::uint32_t>(v)) & 0xffffffu;
    held += 6;
    if (held >= 8) {
      held -= 8;
      out.push_back(static_cast<std::uint8_t>(bits >> held));
    }
  }
  if ((bits & ((1u << held) - 1u)) != 0)
    refuse(source, pointer, "the last base64 character has bits set that belong to no byte");
  return out;
}

/// Decodes base64 and copies the bytes unchanged into items.
template <class Item>
std::vector<Item> decode_items(const std::string& text, const std::string& source, const std::string& pointer) {
  static_assert(std::is_trivially_copyable_v<Item> && std::endian::native == std::endian::little);
  const std::vector<std::uint8_t> from = decode_base64(text, source, pointer);
  if (from.size() % sizeof(Item) != 0)
    refuse(source, pointer, fmt::format("{} bytes; expected a multiple of {}", from.size(), sizeof(Item)));
  std::vector<Item> out(from.size() / sizeof(Item));
  if (!out.empty()) std::memcpy(out.data(), from.data(), from.size());
  return out;
}

}  // namespace clothbench::assets
