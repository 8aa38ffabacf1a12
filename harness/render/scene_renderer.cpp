#include "render/scene_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "clothbench/vector.hpp"

namespace clothbench::render {
namespace {

constexpr auto kSampleBit = VK_SAMPLE_COUNT_4_BIT;
static_assert(static_cast<int>(kSampleBit) == SceneRenderer::kSamples);

/// Requires graphics on the device's compute queue; on every GPU that we know of, that queue supports both.
std::shared_ptr<vulkan::Device> drawing(std::shared_ptr<vulkan::Device> device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device->physical(), &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device->physical(), &count, families.data());
  if ((families.at(device->queue_family()).queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0) return device;
  throw Error(device->info().name + ": its first compute queue does not support graphics", ExitCode::NoDevice);
}

vec4 as_vec4(const Vec3& v, double w) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(w)};
}

/// Position of the viewer from a rigid view matrix.
Vec3 eye_of(const Mat4& view) {
  Vec3 eye{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t r = 0; r < 3; ++r) eye[k] -= view[4 * k + r] * view[12 + r];
  return eye;
}

/// The two axes along which a mesh is longest; without a pattern, the checker lies in their plane.
std::array<std::size_t, 2> longest_axes(const ClothMesh& m) {
  Bounds box = Bounds::none();
  for (const Vec3& x : m.vertices) box.add(x);
  const Vec3 sides = minus(box.high, box.low);
  const std::size_t least = std::min_element(sides.rbegin(), sides.rend()).base() - sides.begin() - 1;
  return {least == 0 ? 1u : 0u, least == 2 ? 1u : 2u};
}

constexpr double kSquares = 8, kMostSquares = 64;  // checker squares: along the shorter side; at most along the longer

/// Computes a corner's position on the checker, in squares.
class Checker {
 public:
  explicit Checker(const Cloth& cloth) : cloth_(cloth), axes_{0, 1} {
    shorter_m_ = std::min(cloth.width_m, cloth.height_m);
    if (cloth.mesh && cloth.mesh->pattern_m.empty()) axes_ = longest_axes(*cloth.mesh);
  }

  std::array<double, 2> at(std::size_t triangle, std::size_t corner, std::uint32_t v) const {
    if (!cloth_.mesh) {
      const auto columns = static_cast<std::uint32_t>(cloth_.columns);
      return {squares(cloth_.width_m) * (v % columns) / (columns - 1),
              squares(cloth_.height_m) * (v / columns) / (cloth_.rows - 1)};
    }
    const ClothMesh& m = *cloth_.mesh;
    std::array<double, 2> at_m = {m.vertices[v][axes_[0]], m.vertices[v][axes_[1]]};
    if (!m.pattern_m.empty()) at_m = m.pattern_m[triangle][corner];
    const double per_m = shorter_m_ > 0 ? kSquares / shorter_m_ : 1;
    return {at_m[0] * per_m, at_m[1] * per_m};
  }

 private:
  double squares(double side_m) const {
    return shorter_m_ > 0 ? std::clamp(std::round(kSquares * side_m / shorter_m_), 1.0, kMostSquares) : kSquares;
  }

  const Cloth& cloth_;
  std::array<std::size_t, 2> axes_;
  double shorter_m_;
};

/// Triangles, checker and vertex-triangle adjacency in the layout that cloth.vert reads.
std::vector<std::uint32_t> mesh_words(const Cloth& cloth) {
  const auto triangles = clothbench::triangles(cloth);
  const Checker checker(cloth);
  std::vector<std::uint32_t> words, first(cloth.vertex_count() + 1, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = triangles[t][c];
      words.push_back(v);
      for (const double x : checker.at(t, c, v)) words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(x)));
      ++first[v + 1];
    }
  for (std::size_t v = 0; v + 1 < first.size(); ++v) first[v + 1] += first[v];
  std::vector<std::uint32_t> lists(3 * triangles.size()), next = first;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t]) lists[next[v]++] = t;
  words.insert(words.end(), first.begin(), first.end());
  words.insert(words.end(), lists.begin(), lists.end());
  return words;
}

}  // namespace

SceneRenderer::SceneRenderer(std::shared_ptr<vulkan::Device> device, VkFormat colour)
    : device_(drawing(std::move(device))), format_(colour), pipelines_(device_, colour, kSampleBit) {
  set_surfaces({});
}

std::unique_ptr<vulkan::Buffer> SceneRenderer::filled(const char* name, const void* data, std::size_t bytes) const {
  // Vulkan forbids empty buffers, so a buffer that only fills a binding has bytes that no shader reads.
  auto buffer =
      std::make_unique<vulkan::Buffer>(device_, name, std::max<std::size_t>(bytes, 16), vulkan::Buffer::Place::Host);
  if (data != nullptr && bytes > 0) std::memcpy(buffer->mapped(), data, bytes);
  return buffer;
}

void SceneRenderer::set_cloth(const Cloth& cloth, const Vec3& origin_m) {
  if (!cloth.mesh && (cloth.columns < 2 || cloth.rows < 2))
    throw Error(
        fmt::format("the cloth's grid is {} x {}: expected at least 2 x 2 vertices", cloth.columns, cloth.rows));
  origin_m_ = origin_m;
  const std::vector<std::uint32_t> words = mesh_words(cloth);
  mesh_ = filled("mesh to draw", words.data(), words.size() * sizeof(std::uint32_t));
  vertices_of_cloth_ = cloth.vertex_count();
  triangles_of_cloth_ = clothbench::triangles(cloth).size();
  own_positions_.reset();
  positions_ = nullptr;
  bound_ = false;
}

void SceneRenderer::use_positions(const vulkan::Buffer& buffer, const Vec3& buffer_origin_m) {
  const std::size_t bytes = vertices_of_cloth_ * sizeof(vec4);
  if (buffer.bytes() < bytes)
    throw Error(
        fmt::format("buffer \"{}\" of {} B: expected one vec4 per vertex, {} B", buffer.name(), buffer.bytes(), bytes));
  positions_ = &buffer;
  buffer_origin_m_ = buffer_origin_m;
  bound_ = false;
}

void SceneRenderer::write_positions(std::span<const double> x) {
  const std::size_t vertices = vertices_of_cloth_;
  if (x.size() != 3 * vertices)
    throw Error(fmt::format("{} coordinates: expected {}, xyz of each vertex", x.size(), 3 * vertices));
  if (!own_positions_) own_positions_ = filled("positions to draw", nullptr, vertices * sizeof(vec4));
  auto* to = static_cast<float*>(own_positions_->mapped());
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t k = 0; k < 3; ++k) to[4 * v + k] = static_cast<float>(x[3 * v + k] - origin_m_[k]);
    to[4 * v + 3] = 0;
  }
  if (positions_ != own_positions_.get()) bound_ = false;
  positions_ = own_positions_.get();
  buffer_origin_m_ = origin_m_;
}

void SceneRenderer::set_surfaces(const Surfaces& s) {
  std::vector<vec4> vertices;
  vertices.reserve(2 * s.position_m.size());
  for (std::size_t v = 0; v < s.position_m.size(); ++v) {
    vertices.push_back(as_vec4(minus(s.position_m[v], origin_m_), s.look[v]));
    vertices.push_back(as_vec4(s.normal[v], 0));
  }
  const std::size_t bytes = vertices.size() * sizeof(vec4),
                    corner_bytes = s.triangles.size() * 3 * sizeof(std::uint32_t);
  if (vertices_ && bytes > 0 && vertices_->bytes() == bytes && corners_->bytes() == corner_bytes) {  // poses only
    std::memcpy(vertices_->mapped(), vertices.data(), bytes);
    std::memcpy(corners_->mapped(), s.triangles.data(), corner_bytes);
    return;
  }
  vertices_ = filled("colliders to draw", vertices.data(), bytes);
  corners_ = filled("corners of colliders to draw", s.triangles.data(), corner_bytes);
  corner_count_ = static_cast<std::uint32_t>(3 * s.triangles.size());
  bound_ = false;
}

Drawn SceneRenderer::constants(const Drawing& drawing) const {
  Drawn d{};
  const Mat4 to_clip = drawing.projection * drawing.view;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t r = 0; r < 4; ++r) d.to_clip[c][r] = static_cast<float>(to_clip[4 * c + r]);
  d.eye = as_vec4(eye_of(drawing.view), 0);
  d.sheet = {static_cast<float>(triangles_of_cloth_), static_cast<float>(vertices_of_cloth_), 0, 0};
  d.origin = as_vec4(minus(buffer_origin_m_, origin_m_), 0);
  return d;
}

void SceneRenderer::record(VkCommandBuffer commands, std::span<const Drawing> drawings) {
  if (positions_ == nullptr) throw Error("SceneRenderer::record: there are no positions to draw");
  if (!bound_) pipelines_.bind({positions_, vertices_.get(), corners_.get(), mesh_.get()});
  bound_ = true;
  // Wait for positions from a solver's kernels or copies before the vertex shader reads them.
  auto memory = blank<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                       VK_PIPELINE_STAGE_VERTEX_SHADER_BIT, 0, 1, &memory, 0, nullptr, 0, nullptr);
  for (const Drawing& d : drawings) record_one(commands, d);
}

void SceneRenderer::record_one(VkCommandBuffer commands, const Drawing& drawing) {
  if (!targets_ || targets_->extent().width != drawing.extent.width ||
      targets_->extent().height != drawing.extent.height)
    targets_ = std::make_unique<Targets>(device_, pipelines_.pass(), format_, kSampleBit, drawing.extent);
  std::array<VkClearValue, 3> clear{};
  clear[0].color = {{1, 1, 1, 1}};
  clear[1].depthStencil = {1, 0};
  auto begin = blank<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  begin.renderPass = pipelines_.pass();
  begin.framebuffer = targets_->framebuffer(drawing.image);
  begin.renderArea = {{0, 0}, drawing.extent};
  begin.clearValueCount = static_cast<std::uint32_t>(clear.size());
  begin.pClearValues = clear.data();
  vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{0, 0, static_cast<float>(drawing.extent.width), static_cast<float>(drawing.extent.height),
                            0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &begin.renderArea);
  const Drawn d = constants(drawing);
  pipelines_.use(commands, true, &d, sizeof d);
  vkCmdDraw(commands, static_cast<std::uint32_t>(3 * triangles_of_cloth_), 1, 0, 0);
  if (corner_count_ > 0) {
    pipelines_.use(commands, false, &d, sizeof d);
    vkCmdDraw(commands, corner_count_, 1, 0, 0);
  }
  vkCmdEndRenderPass(commands);
}

void SceneRenderer::forget(VkImage image) {
  if (targets_) targets_->forget(image);
}

}  // namespace clothbench::render
