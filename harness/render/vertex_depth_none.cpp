#include "clothbench/error.hpp"
#include "render/vertex_values.hpp"

namespace clothbench::render {

struct VertexDepth::State {};

VertexDepth::VertexDepth(const Scene&) {
  throw Error("--colour depth: this build has no contact metrics (-DCLOTHBENCH_WITH_CONTACT_METRICS=OFF)");
}
VertexDepth::~VertexDepth() = default;
std::vector<float> VertexDepth::at(int, std::span<const double>, bool) { return {}; }

}  // namespace clothbench::render
