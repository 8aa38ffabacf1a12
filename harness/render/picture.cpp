#include "render/picture.hpp"

#include <algorithm>
#include <cstring>

namespace clothbench::render {

void Picture::put(const Picture& other, int x, int y) {
  const int from = std::max(0, -x), to = std::min(other.width, width - x);
  if (from >= to) return;
  for (int row = std::max(0, -y); row < std::min(other.height, height - y); ++row)
    std::memcpy(at(x + from, y + row), other.at(from, row), static_cast<std::size_t>(to - from) * 3);
}

}  // namespace clothbench::render
