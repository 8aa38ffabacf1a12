#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "base/json_text.hpp"

namespace clothbench::assets {

/// RFC 4648 section 4, padded, no line breaks.
std::string encode_base64(const std::uint8_t* bytes, std::size_t count);
/// Throws Error with `source` and JSON pointer.
std::vector<std::uint8_t> decode_base64(const std::string& text, const std::string& source, const std::string& pointer);

/// The bytes as items that lie in memory as they do in the text.
template <class Item>
std::vector<Item> decode_items(const std::string& text, const std::string& source, const std::string& pointer) {
  static_assert(std::is_trivially_copyable_v<Item> && std::endian::native == std::endian::little);
  const std::vector<std::uint8_t> from = decode_base64(text, source, pointer);
  if (from.size() % sizeof(Item) != 0)
    refuse(source, pointer,
           std::to_string(from.size()) + " bytes; expected a multiple of " + std::to_string(sizeof(Item)));
  std::vector<Item> out(from.size() / sizeof(Item));
  if (!out.empty()) std::memcpy(out.data(), from.data(), from.size());
  return out;
}

}  // namespace clothbench::assets
