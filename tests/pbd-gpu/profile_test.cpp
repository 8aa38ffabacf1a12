#include "vulkan/profile.hpp"

#include <numeric>

#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Profiles = Gpu;

const vulkan::Profile& adreno() { return vulkan::find_profile("adreno-like"); }

TEST(Profile, UnknownNamesTheKnown) {
  try {
    vulkan::find_profile("adreno");
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("adreno-like"), std::string::npos) << e.what();
  }
}

TEST(Profile, NeedsAreReadFromTheCode) {
  const vulkan::ShaderNeeds plain = vulkan::needs_of(shader("update_positions").code, {96});
  EXPECT_EQ(plain.group[0], 96u) << "the specialized size, not the default";
  EXPECT_EQ(plain.group[1], 1u);
  EXPECT_EQ(plain.shared_memory_B, 0u);
  EXPECT_FALSE(plain.float_atomics);
  using vulkan::Access;
  EXPECT_EQ(plain.bindings, (std::map<std::uint32_t, Access>{{BIND_POSITIONS, Access::ReadWrite},
                                                             {BIND_VELOCITIES, Access::Write},
                                                             {BIND_PREDICTED, Access::Read}}));
  // Arrays as long as a product of constants: 32 rows of 34 words, six of them, a word a row, and one exchanged value a
  // thread.
  const vulkan::ShaderNeeds lines = vulkan::needs_of(shader("line_frame").code, {256, 8, 4, 32, 32, 256});
  EXPECT_EQ(lines.shared_memory_B, 6u * 32 * 34 * 4 + 32 * 4 + 256 * 16);
  EXPECT_TRUE(vulkan::needs_of(shader("project_constraint_deltas_native").code, {64}).float_atomics);
}

/// A module of nothing but what the reader looks at: workgroup memory of vec4[n] and of a struct {uint; float[2]}.
std::vector<std::uint32_t> module_with_shared(std::uint32_t n) {
  const auto op = [](std::uint32_t code, std::vector<std::uint32_t> operands) {
    operands.insert(operands.begin(), code | static_cast<std::uint32_t>(operands.size() + 1) << 16);
    return operands;
  };
  std::vector<std::uint32_t> words = {0x07230203, 0x00010300, 0, 100, 0};
  for (const auto& instruction :
       {op(16, {1, 17, 8, 4, 2}), op(22, {10, 32}), op(21, {11, 32, 0}), op(23, {12, 10, 4}), op(43, {11, 13, n}),
        op(43, {11, 14, 2}), op(28, {15, 12, 13}), op(28, {16, 10, 14}), op(30, {17, 11, 16}), op(32, {18, 4, 15}),
        op(32, {19, 4, 17}), op(32, {20, 12, 15}), op(59, {18, 21, 4}), op(59, {19, 22, 4}), op(59, {20, 23, 12})})
    words.insert(words.end(), instruction.begin(), instruction.end());
  return words;
}

TEST(Profile, SharedMemoryAndShapeAreCounted) {
  const auto words = module_with_shared(100);
  const vulkan::ShaderNeeds needs = vulkan::needs_of({words.data(), words.size() * 4}, {});
  EXPECT_EQ(needs.shared_memory_B, 100 * 16 + 12u) << "storage buffers (class 12) are not shared memory";
  EXPECT_EQ(needs.group[0], 8u);
  EXPECT_EQ(needs.group[2], 2u);
  EXPECT_THROW(vulkan::needs_of({words.data(), words.size() * 4 - 4}, {}), Error);
}

TEST(Profile, EachBreachIsNamed) {
  const auto text = [](vulkan::ShaderNeeds n) { return vulkan::breach(adreno(), n); };
  EXPECT_EQ(text({{256, 1, 1}, 32 * 1024, false}), "");
  EXPECT_NE(text({{257, 1, 1}, 0, false}).find("257"), std::string::npos);
  EXPECT_NE(text({{8, 8, 1}, 0, false}).find("one-dimensional"), std::string::npos);
  EXPECT_NE(text({{64, 1, 1}, 32 * 1024 + 1, false}).find("shared memory"), std::string::npos);
  EXPECT_NE(text({{64, 1, 1}, 0, true}).find("float atomics"), std::string::npos);
}

TEST_F(Profiles, LimitsAreCutAndAtomicsAreGone) {
  const auto device = vulkan::Device::get({-1, true, "adreno-like"});
  EXPECT_NE(device, device_);
  EXPECT_LE(device->limits().maxComputeSharedMemorySize, 32u * 1024);
  EXPECT_LE(device->limits().maxComputeWorkGroupInvocations, 256u);
  EXPECT_EQ(device->limits().maxComputeWorkGroupSize[1], 1u);
  EXPECT_FALSE(device->has_float_atomics());
  const nlohmann::json settings = complete_settings(paper_info(), {{"atomics", "native"}});
  const auto solver = make_paper(settings, {-1, true, "adreno-like"});
  const Scene s = sheet(5, 5);
  EXPECT_THROW(solver->load(s), Error);
  EXPECT_EQ(device->messages(), std::vector<std::string>{});
}

TEST_F(Profiles, TheEnvironmentForcesItWhereNothingElseIsSaid) {
  ASSERT_EQ(setenv("CLOTHBENCH_DEVICE_PROFILE", "adreno-like", 1), 0);
  const auto forced = vulkan::Device::get(options());
  setenv("CLOTHBENCH_DEVICE_PROFILE", "no-such-profile", 1);
  EXPECT_THROW(vulkan::Device::get(options()), Error);
  EXPECT_EQ(vulkan::Device::get({-1, true, "adreno-like"}), forced) << "what is said comes first";
  unsetenv("CLOTHBENCH_DEVICE_PROFILE");
  ASSERT_NE(forced->profile(), nullptr);
  EXPECT_EQ(forced->profile()->name, "adreno-like");
  EXPECT_EQ(vulkan::Device::get(options()), device_);
}

TEST_F(Profiles, AKernelThatWouldNotRunThereIsRefused) {
  const auto device = vulkan::Device::get({-1, true, "adreno-like"});
  vulkan::Buffer buffer(device, "velocities", 1024, vulkan::Buffer::Place::Device);
  const auto make = [&](std::uint32_t group) {
    return vulkan::Kernel(device, "forces", shader("apply_external_forces").code, {group}, {{BIND_VELOCITIES, &buffer}},
                          sizeof(PaperConstants));
  };
  make(256);
  try {
    make(512);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("forces"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("adreno-like"), std::string::npos) << e.what();
  }
}

/// More than 64 dispatches a frame, whatever a frame of the solver takes by itself.
TEST_F(Profiles, LongFramesAreSplitAndComeOutTheSame) {
  const Scene s = with_pins(with_damping(with_bending(sheet(9, 7))));
  const nlohmann::json settings =
      complete_settings(xpbd_info(), {{"substeps", 40}, {"one_dispatch", false}, {"stage_times", false}});
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
