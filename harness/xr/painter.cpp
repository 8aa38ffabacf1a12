#include "xr/painter.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "clothbench/record.hpp"
#include "vulkan/device.hpp"

namespace clothbench::xr {
namespace {

using vulkan::check;

Vec3 vector_of(const XrVector3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// The axes x, y, z of an orientation.
std::array<Vec3, 3> axes_of(const XrQuaternionf& q) {
  const Eigen::Matrix3d m = Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>().toRotationMatrix();
  return {{{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}}};
}

constexpr double kNear_m = 0.05, kFar_m = 100;  // a hand close to the face; the far end of a hall
constexpr std::uint64_t kTimeout_ns = 10'000'000'000;

}  // namespace

render::Mat4 view_of(const XrPosef& pose, const Vec3& origin_m) {
  const auto [right, up, back] = axes_of(pose.orientation);
  return render::Camera{vector_of(pose.position), right, up, back}.view(origin_m);
}

render::Mat4 projection_of(const XrFovf& fov, double near_m, double far_m) {
  const double left = std::tan(static_cast<double>(fov.angleLeft)),
               right = std::tan(static_cast<double>(fov.angleRight));
  const double up = std::tan(static_cast<double>(fov.angleUp)), down = std::tan(static_cast<double>(fov.angleDown));
  render::Mat4 m{};
  m[0] = 2 / (right - left);
  m[8] = (right + left) / (right - left);
  m[5] = -2 / (up - down);
  m[9] = -(up + down) / (up - down);
  m[10] = -far_m / (far_m - near_m);
  m[14] = -far_m * near_m / (far_m - near_m);
  m[11] = -1;
  return m;
}

Painter::Painter(std::shared_ptr<vulkan::Device> device, Session& session)
    : device_(std::move(device)), session_(session), renderer_(device_, session.format()), device_s_(kMissing) {
  try {
    commands_ = vulkan::make_commands(*device_);
    fence_ = vulkan::make_fence(*device_);
    if (device_->has_timestamps()) queries_ = vulkan::make_timestamps(*device_, 2);
  } catch (...) {
    release();
    throw;
  }
}

Painter::~Painter() { release(); }

void Painter::release() {
  vkDeviceWaitIdle(device_->handle());
  for (const Eye& eye : session_.eyes())
    for (const VkImage image : eye.images) renderer_.forget(image);
  vkDestroyQueryPool(device_->handle(), queries_, nullptr);
  vkDestroyFence(device_->handle(), fence_, nullptr);
  if (commands_ != VK_NULL_HANDLE) vkFreeCommandBuffers(device_->handle(), device_->command_pool(), 1, &commands_);
}

void Painter::wait() {
  if (!in_flight_) return;
  check(vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, kTimeout_ns), "vkWaitForFences");
  in_flight_ = false;
  check(vkResetFences(device_->handle(), 1, &fence_), "vkResetFences");
  if (queries_ == VK_NULL_HANDLE) return;
  std::array<std::uint64_t, 2> ticks{};
  check(vkGetQueryPoolResults(device_->handle(), queries_, 0, 2, sizeof ticks, ticks.data(), 8, VK_QUERY_RESULT_64_BIT),
        "vkGetQueryPoolResults");
  device_s_ = device_->seconds(ticks[0], ticks[1]);
}

void Painter::paint(const std::vector<XrView>& views) {
  wait();
  const Instance& xr = session_.instance();
  std::array<std::uint32_t, 2> index{};
  for (std::size_t k = 0; k < 2; ++k) {
    const XrSwapchain images = session_.eyes()[k].swapchain;
    auto acquire = blank<XrSwapchainImageAcquireInfo>(XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO);
    xr.check(xr.xr().xrAcquireSwapchainImage(images, &acquire, &index[k]), "xrAcquireSwapchainImage");
    auto wait = blank<XrSwapchainImageWaitInfo>(XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
    wait.timeout = XR_INFINITE_DURATION;
    xr.check(xr.xr().xrWaitSwapchainImage(images, &wait), "xrWaitSwapchainImage");
  }
  record(index[0], index[1], views);
  vulkan::submit(*device_, commands_, fence_);
  in_flight_ = true;
  for (const Eye& eye : session_.eyes()) {
    auto release = blank<XrSwapchainImageReleaseInfo>(XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO);
    xr.check(xr.xr().xrReleaseSwapchainImage(eye.swapchain, &release), "xrReleaseSwapchainImage");
  }
}

void Painter::record(std::uint32_t left, std::uint32_t right, const std::vector<XrView>& views) {
  vulkan::begin(commands_);
  if (queries_ != VK_NULL_HANDLE) {
    vkCmdResetQueryPool(commands_, queries_, 0, 2);
    vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries_, 0);
  }
  const std::array<std::uint32_t, 2> index = {left, right};
  std::vector<render::Drawing> drawings;
  for (std::size_t k = 0; k < 2; ++k)
    drawings.push_back({session_.eyes()[k].images.at(index[k]), session_.extent(),
                        view_of(views[k].pose, renderer_.origin()), projection_of(views[k].fov, kNear_m, kFar_m)});
  renderer_.record(commands_, drawings);
  if (queries_ != VK_NULL_HANDLE) vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, 1);
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

}  // namespace clothbench::xr
