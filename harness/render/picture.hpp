#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace clothbench::render {

/// 8 bits a channel, sRGB, rgb interleaved, the top row first.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  Picture() = default;
  Picture(int w, int h, std::uint8_t grey)
      : width(w), height(h), rgb(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3, grey) {}
  std::uint8_t* at(int x, int y) {
    return &rgb[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 3];
  }
  const std::uint8_t* at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
  /// Copies another picture onto this one, with its upper left corner at (x, y); clips it at the borders.
  void put(const Picture&, int x, int y);
};

/// Writes under a temporary name, then renames. Throws Error naming the file.
void write_png(const std::filesystem::path&, const Picture&);
/// Throws Error naming the file and what is wrong with it.
Picture read_png(const std::filesystem::path&);

}  // namespace clothbench::render
