#include <numeric>

#include "gpu_fixture.hpp"
#include "vulkan/kernel.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Profiles = Gpu;

TEST(Kernels, AccessesAreReadFromTheCode) {
  using vulkan::Access;
  EXPECT_EQ(
      vulkan::accesses_of(shader("update_positions")),
      (std::map<std::uint32_t, Access>{
          {BIND_POSITIONS, Access::ReadWrite}, {BIND_VELOCITIES, Access::Write}, {BIND_PREDICTED, Access::Read}}));
  const vulkan::SpirV code = shader("update_positions");
  // The header has five words, and the first instruction (OpCapability) has two.
  EXPECT_THROW(vulkan::accesses_of({code.words, 6 * sizeof(std::uint32_t)}), Error) << "torn";
}

TEST_F(Profiles, CutLimitsAndRefuseLargerWorkgroups) {
  const auto device = vulkan::Device::get({-1, true, "adreno-like"});
  EXPECT_NE(device, device_);
  EXPECT_LE(device->limits().maxComputeSharedMemorySize, 32u * 1024);
  EXPECT_LE(device->limits().maxComputeWorkGroupInvocations, 256u);
  vulkan::Buffer buffer(device, "velocities", 1024, vulkan::Buffer::Place::Device);
  const auto make = [&](std::uint32_t group) {
    return vulkan::Kernel(device, "forces", shader("apply_external_forces"), {group}, {{BIND_VELOCITIES, &buffer}},
                          sizeof(PaperConstants));
  };
  make(256);
  EXPECT_THROW(make(512), Error);
  EXPECT_EQ(device->messages(), std::vector<std::string>{});
}

/// More than 64 dispatches a frame, whatever a frame of the solver takes by itself.
TEST_F(Profiles, LongFramesAreSplitAndComeOutTheSame) {
  const Scene s = with_pins(with_damping(with_bending(sheet(33, 7))));
  const nlohmann::json settings = complete_settings(xpbd_info(), {{"substeps", 40}});
  const auto whole = make_xpbd(settings, options()), split = make_xpbd(settings, {-1, true, "adreno-like"});
  whole->load(s);
  split->load(s);
  const auto& one = whole->frame_program().submits();
  const auto& several = split->frame_program().submits();
  ASSERT_EQ(one.size(), 1u);
  ASSERT_GT(one[0], 64u);
  EXPECT_EQ(several.size(), (one[0] + 63) / 64);
  for (std::uint32_t n : several) EXPECT_LE(n, 64u);
  EXPECT_EQ(std::accumulate(several.begin(), several.end(), 0u), one[0]);
  const ClothState a = after(*whole, s, 5), b = after(*split, s, 5);
  EXPECT_EQ(a.position, b.position) << "bit for bit";
  EXPECT_EQ(a.velocity, b.velocity);
  if (device_->has_timestamps()) {
    EXPECT_GT(split->last_cost().device_s, 0);
  }
  EXPECT_EQ(split->validation_messages(), 0);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
