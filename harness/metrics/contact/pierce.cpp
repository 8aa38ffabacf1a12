#include "metrics/contact/pierce.hpp"

namespace clothbench::contact {

std::size_t pierced(const TriangleMeshView& cloth, std::span<const Bone> segments) {
  std::vector<bool> crossed(segments.size(), false);
  std::vector<Box> boxes;
  Box all;
  for (const auto& [a, b] : segments) all.extend(boxes.emplace_back(Box(a).extend(b)));
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> triangle = cloth.triangle(t);
    const Box box = Box(triangle[0]).extend(triangle[1]).extend(triangle[2]);
    if (!box.intersects(all)) continue;
    for (std::size_t k = 0; k < segments.size(); ++k)
      if (!crossed[k] && box.intersects(boxes[k]))
        crossed[k] = crossing<3>(segments[k][0], segments[k][1], triangle) != 0;
  }
  std::size_t count = 0;
  for (const bool c : crossed) count += c;
  return count;
}

}  // namespace clothbench::contact
