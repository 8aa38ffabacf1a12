#include "xr/session.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace clothbench::xr {
namespace {

constexpr auto kViews = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
/// sRGB formats, which give correct colours because the renderer writes linear values.
constexpr std::array kFormats = {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB};

using assets::Side;

/// Calls an OpenXR function of the member xr_; throws as Instance::check.
#define CHECKED(function, ...) xr_.check(xr_.xr().function(__VA_ARGS__), #function)

static_assert(assets::kRecordedJointCount == XR_HAND_JOINT_COUNT_EXT);
static_assert(std::extent_v<decltype(XrHandTrackingCapsulesStateFB::capsules)> == assets::kCapsuleCount);

/// Whether position and orientation are known.
bool is_known(XrSpaceLocationFlags flags) {
  constexpr XrSpaceLocationFlags kKnown =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  return (flags & kKnown) == kKnown;
}

std::array<float, 3> three(const XrVector3f& v) { return {v.x, v.y, v.z}; }

assets::RecordedJoint joint(const XrPosef& p, float radius) {
  return {three(p.position), {p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w}, radius};
}

using vulkan::check;

Vec3 vector_of(const XrVector3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// The axes x, y, z of an orientation.
std::array<Vec3, 3> axes_of(const XrQuaternionf& q) {
  const Eigen::Matrix3d m = Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>().toRotationMatrix();
  return {{{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}}};
}

constexpr double kNear_m = 0.05, kFar_m = 100;  // a hand before the face; the far end of a hall
constexpr std::uint64_t kTimeout_ns = 10'000'000'000;

}  // namespace

Session::Session(const Instance& xr, std::shared_ptr<vulkan::Device> device, const SessionOptions& options)
    : xr_(xr), device_(std::move(device)), rate_hz_(options.rate_hz) {
  try {
    create_session();
    create_space(options.origin_m);
    create_eyes();
    choose_blend_mode();
  } catch (...) {  // because no destructor runs after an exception here
    release();
    throw;
  }
}

Session::~Session() { release(); }

void Session::release() {
  vkDeviceWaitIdle(device_->handle());
  for (Eye& eye : eyes_)
    if (eye.swapchain != XR_NULL_HANDLE) xr_.xr().xrDestroySwapchain(eye.swapchain);
  if (space_ != XR_NULL_HANDLE) xr_.xr().xrDestroySpace(space_);
  if (session_ != XR_NULL_HANDLE) xr_.xr().xrDestroySession(session_);
}

void Session::create_session() {
  auto vulkan = blank<XrGraphicsBindingVulkan2KHR>(XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR);
  vulkan.instance = device_->instance();
  vulkan.physicalDevice = device_->physical();
  vulkan.device = device_->handle();
  vulkan.queueFamilyIndex = device_->queue_family();
  vulkan.queueIndex = 0;
  auto info = blank<XrSessionCreateInfo>(XR_TYPE_SESSION_CREATE_INFO);
  info.next = &vulkan;
  info.systemId = xr_.system();
  CHECKED(xrCreateSession, xr_.handle(), &info, &session_);
}

void Session::create_space(const Vec3& origin_m) {
  if (space_ != XR_NULL_HANDLE) xr_.xr().xrDestroySpace(std::exchange(space_, XR_NULL_HANDLE));
  auto info = blank<XrReferenceSpaceCreateInfo>(XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
  info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
  info.poseInReferenceSpace.orientation.w = 1;
  info.poseInReferenceSpace.position = {static_cast<float>(origin_m[0]), static_cast<float>(origin_m[1]),
                                        static_cast<float>(origin_m[2])};
  CHECKED(xrCreateReferenceSpace, session_, &info, &space_);
}

void Session::create_eyes() {
  std::uint32_t count = 0;
  CHECKED(xrEnumerateViewConfigurationViews, xr_.handle(), xr_.system(), kViews, 0, &count, nullptr);
  std::vector<XrViewConfigurationView> views(count, blank<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW));
  CHECKED(xrEnumerateViewConfigurationViews, xr_.handle(), xr_.system(), kViews, count, &count, views.data());
  if (count != eyes_.size()) throw Error(fmt::format("OpenXR: {} views; expected 2", count), ExitCode::NoDevice);
  // Equal sizes for both eyes, so that the renderer keeps one set of targets.
  for (const auto& v : views) {
    extent_.width = std::max(extent_.width, v.recommendedImageRectWidth);
    extent_.height = std::max(extent_.height, v.recommendedImageRectHeight);
  }
  CHECKED(xrEnumerateSwapchainFormats, session_, 0, &count, nullptr);
  std::vector<std::int64_t> formats(count);
  CHECKED(xrEnumerateSwapchainFormats, session_, count, &count, formats.data());
  for (const VkFormat f : kFormats)
    if (format_ == VK_FORMAT_UNDEFINED && std::find(formats.begin(), formats.end(), f) != formats.end()) format_ = f;
  if (format_ == VK_FORMAT_UNDEFINED)
    throw Error("OpenXR: the runtime has no 8-bit sRGB swapchain (RGBA or BGRA)", ExitCode::NoDevice);
  for (Eye& eye : eyes_) {
    auto info = blank<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
    info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    info.format = format_;
    info.sampleCount = 1;
    info.width = extent_.width;
    info.height = extent_.height;
    info.faceCount = info.arraySize = info.mipCount = 1;
    CHECKED(xrCreateSwapchain, session_, &info, &eye.swapchain);
    CHECKED(xrEnumerateSwapchainImages, eye.swapchain, 0, &count, nullptr);
    std::vector<XrSwapchainImageVulkan2KHR> images(
        count, blank<XrSwapchainImageVulkan2KHR>(XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR));
    CHECKED(xrEnumerateSwapchainImages, eye.swapchain, count, &count,
            reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data()));
    for (const auto& image : images) eye.images.push_back(image.image);
  }
}

/// Chooses a mode in which the user sees only the scene, if the headset has one.
void Session::choose_blend_mode() {
  std::uint32_t count = 0;
  CHECKED(xrEnumerateEnvironmentBlendModes, xr_.handle(), xr_.system(), kViews, 0, &count, nullptr);
  std::vector<XrEnvironmentBlendMode> modes(count);
  CHECKED(xrEnumerateEnvironmentBlendModes, xr_.handle(), xr_.system(), kViews, count, &count, modes.data());
  if (modes.empty()) throw Error("OpenXR: the runtime has no environment blend mode", ExitCode::NoDevice);
  const bool opaque = std::find(modes.begin(), modes.end(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE) != modes.end();
  blend_ = opaque ? XR_ENVIRONMENT_BLEND_MODE_OPAQUE : modes.front();
}

void Session::request_rate(double rate_hz) const {
  if (!xr_.has(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) return;
  // A rate that the display lacks is not an error, because the log records the actual rate.
  xr_.call("xrRequestDisplayRefreshRateFB", session_, static_cast<float>(rate_hz));
}

bool Session::pump() {
  for (;;) {
    auto event = blank<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
    const XrResult result = xr_.xr().xrPollEvent(xr_.handle(), &event);
    xr_.check(result, "xrPollEvent");
    if (result == XR_EVENT_UNAVAILABLE) return !over_;
    if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING)
      over_ = true;
    else if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED)
      change(reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state);
  }
}

void Session::change(XrSessionState state) {
  if (state == XR_SESSION_STATE_READY) {
    auto info = blank<XrSessionBeginInfo>(XR_TYPE_SESSION_BEGIN_INFO);
    info.primaryViewConfigurationType = kViews;
    CHECKED(xrBeginSession, session_, &info);
    running_ = true;
    request_rate(rate_hz_);
  } else if (state == XR_SESSION_STATE_STOPPING) {
    running_ = false;
    CHECKED(xrEndSession, session_);
  } else if (state == XR_SESSION_STATE_EXITING || state == XR_SESSION_STATE_LOSS_PENDING) {
    running_ = false;
    over_ = true;
  }
}

void Session::request_exit() {
  if (running_) CHECKED(xrRequestExitSession, session_);
}

XrFrameState Session::wait_frame() {
  auto state = blank<XrFrameState>(XR_TYPE_FRAME_STATE);
  const auto info = blank<XrFrameWaitInfo>(XR_TYPE_FRAME_WAIT_INFO);
  CHECKED(xrWaitFrame, session_, &info, &state);
  return state;
}

void Session::begin_frame() {
  const auto info = blank<XrFrameBeginInfo>(XR_TYPE_FRAME_BEGIN_INFO);
  CHECKED(xrBeginFrame, session_, &info);
}

std::vector<XrView> Session::views(XrTime time) const {
  auto info = blank<XrViewLocateInfo>(XR_TYPE_VIEW_LOCATE_INFO);
  info.viewConfigurationType = kViews;
  info.displayTime = time;
  info.space = space_;
  auto state = blank<XrViewState>(XR_TYPE_VIEW_STATE);
  std::vector<XrView> views(eyes_.size(), blank<XrView>(XR_TYPE_VIEW));
  std::uint32_t count = 0;
  CHECKED(xrLocateViews, session_, &info, &state, static_cast<std::uint32_t>(views.size()), &count, views.data());
  constexpr XrViewStateFlags kKnown = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  if ((state.viewStateFlags & kKnown) != kKnown || count != views.size()) views.clear();
  return views;
}

void Session::end_frame(const XrFrameState& frame, const std::vector<XrView>& views) {
  std::array<XrCompositionLayerProjectionView, 2> shown{};
  auto projection = blank<XrCompositionLayerProjection>(XR_TYPE_COMPOSITION_LAYER_PROJECTION);
  if (!views.empty()) {
    for (std::size_t k = 0; k < shown.size(); ++k) {
      shown[k] = blank<XrCompositionLayerProjectionView>(XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
      shown[k].pose = views[k].pose;
      shown[k].fov = views[k].fov;
      shown[k].subImage.swapchain = eyes_[k].swapchain;
      shown[k].subImage.imageRect.extent = {static_cast<std::int32_t>(extent_.width),
                                            static_cast<std::int32_t>(extent_.height)};
    }
    projection.space = space_;
    projection.viewCount = static_cast<std::uint32_t>(shown.size());
    projection.views = shown.data();
  }
  const auto* layer = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection);
  auto info = blank<XrFrameEndInfo>(XR_TYPE_FRAME_END_INFO);
  info.displayTime = frame.predictedDisplayTime;
  info.environmentBlendMode = blend_;
  info.layerCount = views.empty() ? 0 : 1;
  info.layers = &layer;
  CHECKED(xrEndFrame, session_, &info);
}

Hands::Hands(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  capsules_ = xr.has(XR_FB_HAND_TRACKING_CAPSULES_EXTENSION_NAME);
  locate_ = xr.function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
  for (const Side side : {Side::Left, Side::Right}) {
    auto info = blank<XrHandTrackerCreateInfoEXT>(XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT);
    info.hand = side == Side::Left ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT;
    info.handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT;
    xr.check(xr.call("xrCreateHandTrackerEXT", session.handle(), &info, &trackers_[static_cast<std::size_t>(side)]),
             "xrCreateHandTrackerEXT");
  }
}

Hands::~Hands() {
  for (const XrHandTrackerEXT t : trackers_)
    if (t != XR_NULL_HANDLE) session_.instance().call("xrDestroyHandTrackerEXT", t);
}

std::optional<assets::RecordedHand> Hands::at(Side side, XrTime time) const {
  auto info = blank<XrHandJointsLocateInfoEXT>(XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT);
  info.baseSpace = session_.space();
  info.time = time;
  auto shapes = blank<XrHandTrackingCapsulesStateFB>(XR_TYPE_HAND_TRACKING_CAPSULES_STATE_FB);
  std::array<XrHandJointLocationEXT, XR_HAND_JOINT_COUNT_EXT> joints{};
  auto found = blank<XrHandJointLocationsEXT>(XR_TYPE_HAND_JOINT_LOCATIONS_EXT);
  // The headers of 1.0.20 chain this struct to the input; the specification chains it to the output.
  found.next = capsules_ ? &shapes : nullptr;
  found.jointCount = static_cast<std::uint32_t>(joints.size());
  found.jointLocations = joints.data();
  session_.instance().check(locate_(trackers_[static_cast<std::size_t>(side)], &info, &found), "xrLocateHandJointsEXT");
  if (found.isActive != XR_TRUE) return std::nullopt;
  assets::RecordedHand hand;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (!is_known(joints[k].locationFlags)) return std::nullopt;
    hand.joints[k] = joint(joints[k].pose, joints[k].radius);
  }
  if (capsules_)
    for (std::size_t k = 0; k < hand.capsules.size(); ++k)
      hand.capsules[k] = {three(shapes.capsules[k].points[0]), three(shapes.capsules[k].points[1]),
                          shapes.capsules[k].radius};
  if (!assets::usable(hand)) return std::nullopt;
  return hand;
}

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
  *fence_.create(device_->handle()) = vulkan::make_fence(*device_);
  if (device_->has_timestamps()) *queries_.create(device_->handle()) = vulkan::make_timestamps(*device_, 2);
  commands_ = vulkan::make_commands(*device_);
}

Painter::~Painter() {
  vkDeviceWaitIdle(device_->handle());
  for (const Eye& eye : session_.eyes())
    for (const VkImage image : eye.images) renderer_.forget(image);
  vkFreeCommandBuffers(device_->handle(), device_->command_pool(), 1, &commands_);
}

void Painter::wait() {
  if (!in_flight_) return;
  const VkFence fence = fence_;
  check(vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, kTimeout_ns), "vkWaitForFences");
  in_flight_ = false;
  check(vkResetFences(device_->handle(), 1, &fence), "vkResetFences");
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
  record(index, views);
  vulkan::submit(*device_, commands_, fence_);
  in_flight_ = true;
  for (const Eye& eye : session_.eyes()) {
    auto release = blank<XrSwapchainImageReleaseInfo>(XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO);
    xr.check(xr.xr().xrReleaseSwapchainImage(eye.swapchain, &release), "xrReleaseSwapchainImage");
  }
}

void Painter::record(const std::array<std::uint32_t, 2>& index, const std::vector<XrView>& views) {
  vulkan::begin(commands_);
  if (queries_ != VK_NULL_HANDLE) {
    vkCmdResetQueryPool(commands_, queries_, 0, 2);
    vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries_, 0);
  }
  std::vector<render::Drawing> drawings;
  for (std::size_t k = 0; k < 2; ++k)
    drawings.push_back({session_.eyes()[k].images.at(index[k]), session_.extent(),
                        view_of(views[k].pose, renderer_.origin()), projection_of(views[k].fov, kNear_m, kFar_m)});
  renderer_.record(commands_, drawings);
  if (queries_ != VK_NULL_HANDLE) vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, 1);
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

}  // namespace clothbench::xr
