#include "render/stereo.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clothbench/vector.hpp"
#include "common/gpu_solver.hpp"
#include "render/offscreen.hpp"

namespace clothbench::render {
namespace {

class StereoDrawer : public FrameDrawer {
 public:
  StereoDrawer(const Scene& scene, const ClothSolver& solver, const DeviceOptions& options, VkExtent2D eye)
      : scene_(scene),
        solver_(solver),
        renderer_(vulkan::Device::get(options), Offscreen::kFormat),
        images_(vulkan::Device::get(options), eye, 2) {
    near_ = Bounds::none();
    const std::vector<double> start = initial_positions(scene);
    for (std::size_t v = 0; v < scene.cloth.vertex_count(); ++v) near_.add(vertex_at(start, v));
    Vec3 middle{};
    for (std::size_t k = 0; k < 3; ++k) middle[k] = (near_.low[k] + near_.high[k]) / 2;
    const double size = std::max({scene.cloth.width_m, scene.cloth.height_m, near_.diagonal()});
    near_.grow(size);
    cameras_ = eyes(middle, size, 0.05 * size, 100 * size);
    renderer_.set_cloth(scene.cloth, middle);
    if (solver.info().on_gpu) {
      const auto* gpu = dynamic_cast<const pbd_gpu::GpuSolver*>(&solver);
      if (gpu == nullptr) throw Error("solver " + solver.info().name + ": rendering has no access to its positions");
      renderer_.use_positions(gpu->position_buffer(), gpu->origin_m());
    } else {
      upload_ = true;
    }
    // What nothing holds falls out of sight; the eyes fall with it, on the device.
    if (scene.pins.vertices.empty() && scene.grips.vertices.empty() && scene.colliders.empty()) {
      const auto v = static_cast<std::uint32_t>((scene.cloth.rows / 2) * scene.cloth.columns + scene.cloth.columns / 2);
      renderer_.follow(v, vertex_at(start, v));
    }
    renderer_.set_surfaces(surfaces(scene, 0, near_));
  }

  void draw(int frame) override {
    if (upload_) {
      solver_.read_state(state_);
      renderer_.write_positions(state_.position);
    }
    if (!scene_.motion.empty()) renderer_.set_surfaces(surfaces(scene_, frame, near_));
    images_.draw(renderer_, cameras_);
  }

 private:
  const Scene& scene_;
  const ClothSolver& solver_;
  ClothState state_;
  Bounds near_;
  std::array<Camera, 2> cameras_;
  bool upload_ = false;
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
