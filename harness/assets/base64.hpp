#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clothbench::assets {

/// RFC 4648 section 4, padded.
std::string encode_base64(const std::uint8_t* bytes, std::size_t count);

/// RFC 4648 section 4, strict: padded, no line breaks, unused bits zero. On failure returns false and puts the reason
/// in `problem` ("character 17 is not of the base64 alphabet").
bool decode_base64(std::string_view text, std::vector<std::uint8_t>& bytes, std::string& problem);

}  // namespace clothbench::assets
