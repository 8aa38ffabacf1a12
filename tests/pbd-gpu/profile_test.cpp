#include "gpu_fixture.hpp"
#include "vulkan/kernel.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Profiles = Gpu;

TEST(Kernels, AccessesAreReadFromTheCode) {
  using vulkan::Access;
  EXPECT_EQ(vulkan::accesses_of(shader("update_positions")),
            (std::map<std::uint32_t, Access>{{BIND_POSITIONS, Access::ReadWrite},
                                             {BIND_VELOCITIES, Access::Write},
                                             {BIND_PREDICTED, Access::Read},
                                             {BIND_SLIP, Access::ReadWrite}}));
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

}  // namespace
}  // namespace clothbench::pbd_gpu
