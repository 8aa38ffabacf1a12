#include "render/offscreen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "clothbench/vector.hpp"
#include "common/gpu_solver.hpp"
#include "vulkan/device.hpp"

namespace clothbench::render {
namespace {

using vulkan::check;

constexpr std::uint64_t kPatience_ns = 60'000'000'000;  // a software device takes seconds for a large image

}  // namespace

Offscreen::Offscreen(std::shared_ptr<vulkan::Device> device, VkExtent2D extent, std::size_t count)
    : device_(std::move(device)), extent_(extent) {
  const std::uint32_t most = std::min({device_->limits().maxImageDimension2D, device_->limits().maxFramebufferWidth,
                                       device_->limits().maxFramebufferHeight});
  if (extent.width < 1 || extent.height < 1 || extent.width > most || extent.height > most)
    throw Error(fmt::format("a picture of {} x {}: expected at most {} x {} on this device", extent.width,
                            extent.height, most, most));
  for (std::size_t k = 0; k < count; ++k)
    images_.push_back(std::make_unique<Image>(device_, kFormat, extent, VK_SAMPLE_COUNT_1_BIT,
                                              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT));
  *fence_.create(device_->handle()) = vulkan::make_fence(*device_);
  commands_ = vulkan::make_commands(*device_);
}

Offscreen::~Offscreen() {
  if (drawn_by_ != nullptr)
    for (const auto& image : images_) drawn_by_->forget(image->handle());
  vkFreeCommandBuffers(device_->handle(), device_->command_pool(), 1, &commands_);
}

template <class Record>
void Offscreen::submit(Record&& record) {
  vulkan::begin(commands_);
  record();
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  vulkan::submit(*device_, commands_, fence_);
  const VkFence fence = fence_;
  check(vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, kPatience_ns), "vkWaitForFences");
  check(vkResetFences(device_->handle(), 1, &fence), "vkResetFences");
}

void Offscreen::draw(SceneRenderer& renderer, std::span<const Camera> cameras) {
  if (cameras.size() != images_.size())
    throw Error(fmt::format("{} cameras for {} images", cameras.size(), images_.size()));
  drawn_by_ = &renderer;
  std::vector<Drawing> drawings;
  for (std::size_t k = 0; k < cameras.size(); ++k)
    drawings.push_back({images_[k]->handle(), extent_, cameras[k].view(renderer.origin()), cameras[k].projection()});
  submit([&] { renderer.record(commands_, drawings); });
}

Picture Offscreen::read(std::size_t k) {
  const std::size_t pixels = static_cast<std::size_t>(extent_.width) * extent_.height;
  if (!pixels_) pixels_ = std::make_unique<vulkan::Buffer>(device_, "picture", 4 * pixels, vulkan::Buffer::Place::Host);
  submit([&] {
    // The copy waits for the rendering. Afterwards the image returns to the layout in which rendering left it.
    auto drawn = blank<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
    drawn.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    drawn.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    drawn.oldLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    drawn.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    drawn.srcQueueFamilyIndex = drawn.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    drawn.image = images_.at(k)->handle();
    drawn.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &drawn);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {extent_.width, extent_.height, 1};
    vkCmdCopyImageToBuffer(commands_, images_[k]->handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_->handle(), 1,
                           &copy);
    auto copied = blank<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    copied.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    copied.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    VkImageMemoryBarrier back = drawn;
    back.srcAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    back.dstAccessMask = 0;
    std::swap(back.oldLayout, back.newLayout);
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_HOST_BIT | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, 0, 1, &copied, 0,
                         nullptr, 1, &back);
  });
  Picture out(static_cast<int>(extent_.width), static_cast<int>(extent_.height));
  const auto* rgba = static_cast<const std::uint8_t*>(pixels_->mapped());
  for (std::size_t p = 0; p < pixels; ++p)
    for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * p + c] = rgba[4 * p + c];
  return out;
}

namespace {

class StereoDrawer : public FrameDrawer {
 public:
  StereoDrawer(const Scene& scene, const ClothSolver& solver, const DeviceOptions& options, VkExtent2D eye)
      : scene_(scene),
        solver_(solver),
        renderer_(vulkan::Device::get(options), Offscreen::kFormat),
        images_(vulkan::Device::get(options), eye, 2) {
    near_ = Bounds::of(initial_positions(scene));
    const Vec3 middle = scaled(0.5, plus(near_.low, near_.high));
    const double size = std::max({scene.cloth.width_m, scene.cloth.height_m, near_.diagonal()});
    near_.grow(size);
    cameras_ = eyes(middle, size, 0.05 * size, 100 * size);
    renderer_.set_cloth(scene.cloth, middle);
    if (solver.info().on_gpu) {
      gpu_ = dynamic_cast<const pbd_gpu::GpuSolver*>(&solver);
      if (gpu_ == nullptr) throw Error("solver " + solver.info().name + ": rendering has no access to its positions");
    }
    falls_ = scene.pins.vertices.empty() && scene.grips.vertices.empty() && scene.colliders.empty();
    renderer_.set_surfaces(surfaces(scene, 0, near_));
  }

  void draw(int frame) override {
    if (gpu_ != nullptr) {
      renderer_.use_positions(gpu_->position_buffer(), gpu_->origin_m());
    } else {
      solver_.read_state(state_);
      renderer_.write_positions(state_.position);
    }
    if (!scene_.motion.empty()) renderer_.set_surfaces(surfaces(scene_, frame, near_));
    std::array<Camera, 2> cameras = cameras_;
    if (falls_) {  // free cloth would fall out of sight, so the eyes fall with it
      const double t = scene_.time.at(frame);
      for (Camera& c : cameras)
        c.eye_m = plus(c.eye_m, plus(scaled(t, scene_.cloth.initial_velocity_m_per_s),
                                     scaled(0.5 * t * t, scene_.gravity_m_per_s2)));
    }
    images_.draw(renderer_, cameras);
  }

 private:
  const Scene& scene_;
  const ClothSolver& solver_;
  ClothState state_;
  Bounds near_;
  std::array<Camera, 2> cameras_;
  const pbd_gpu::GpuSolver* gpu_ = nullptr;  ///< null: a solver on the CPU
  bool falls_ = false;
  SceneRenderer renderer_;
  Offscreen images_;
};

}  // namespace

Rendering stereo_rendering(int width, int height) {
  Rendering r;
  r.describe = [=](const SolverInfo& info) {
    return fmt::format("2 eyes of {} x {} pixels, {} samples each; positions: {}", width, height,
                       SceneRenderer::kSamples, info.on_gpu ? "the solver's own buffer" : "read_state, uploaded");
  };
  r.make = [=](const Scene& scene, const ClothSolver& solver, const DeviceOptions& options) {
    return std::make_unique<StereoDrawer>(
        scene, solver, options, VkExtent2D{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)});
  };
  return r;
}

}  // namespace clothbench::render
