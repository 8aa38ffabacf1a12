#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

TEST(Groups, RoundUpAndTurnIntoRowsPastTheLimit) {
  using vulkan::Groups, vulkan::groups_for;
  EXPECT_EQ(groups_for(1, 64), (Groups{1, 1}));
  EXPECT_EQ(groups_for(64, 64), (Groups{1, 1}));
  EXPECT_EQ(groups_for(65, 64), (Groups{2, 1}));
  EXPECT_EQ(groups_for(65535ull * 64, 64), (Groups{65535, 1}));
  EXPECT_EQ(groups_for(65535ull * 64 + 1, 64), (Groups{32768, 2}));
  for (std::uint64_t items : {1ull << 22, (1ull << 27) + 3, (1ull << 31) + 77}) {
    const Groups g = groups_for(items, 64);
    EXPECT_LE(g.x, 65535u);
    EXPECT_GE(64ull * g.x * g.y, items);
    EXPECT_LT(64ull * g.x * g.y, items + 64ull * (g.y + 1)) << "less than one unused group per row";
  }
  EXPECT_THROW(groups_for(1ull << 33, 64), Error);
  EXPECT_THROW(groups_for(~0ull, 64), Error);
}

TEST_F(Gpu, RowsOfGroupsReachEveryItemOnce) {
  using vulkan::Buffer;
  constexpr std::uint32_t kItems = 15 * 64 - 7, kBeyond = 9;
  const auto buffer =
      std::make_unique<Buffer>(device_, "velocities", (kItems + kBeyond) * sizeof(vec4), Buffer::Place::Host);
  auto* v = static_cast<vec4*>(buffer->mapped());
  for (std::uint32_t i = 0; i < kItems + kBeyond; ++i) v[i] = {static_cast<float>(i), 0, 0, 1};
  const vulkan::Kernel kernel(device_, "forces", shader("apply_external_forces"), {64},
                              {{BIND_VELOCITIES, buffer.get()}}, sizeof(PaperConstants));
  vulkan::Program program(device_);
  PaperConstants c{};
  c.gravity = {0, 1, 0, 0};
  c.particles = kItems;
  c.h = 1;
  program.dispatch(0, kernel, {4, 4}, c);
  program.record(false);
  program.run(10);
  program.run(10);
  for (std::uint32_t i = 0; i < kItems + kBeyond; ++i) {
    EXPECT_EQ(v[i].x, static_cast<float>(i));
    EXPECT_EQ(v[i].y, i < kItems ? 2.0f : 0.0f) << i;
  }
}

TEST_F(Gpu, MessagesAreOfTheSolverThatCausedThem) {
  // A separate device, so that its messages do not count against another test.
  const DeviceOptions own{0, true};
  const auto device = vulkan::Device::get(own);
  ASSERT_NE(device, device_);
  const int before = device->validation_messages();
  const Scene s = sheet(5, 4);
  const nlohmann::json settings = complete_settings(xpbd_info(), nlohmann::json::object());
  const auto first = make_xpbd(settings, own), second = make_xpbd(settings, own);
  first->load(s);
  second->load(s);
  const FrameInput frame{0, s.time.dt(), s.time.dt(), nullptr};
  ASSERT_EQ(first->step(frame), StepStatus::Ok);
  device->note_message("of the first solver's frame");
  device->note_message("of the first solver's picture");
  ASSERT_EQ(second->step(frame), StepStatus::Ok);
  EXPECT_EQ(first->validation_messages(), 2);
  EXPECT_EQ(second->validation_messages(), 0);
  ClothState state;
  first->read_state(state);
  device->note_message("of the first solver's state");
  const auto third = make_xpbd(settings, own);
  third->load(s);
  EXPECT_EQ(first->validation_messages(), 3);
  EXPECT_EQ(second->validation_messages(), 0);
  EXPECT_EQ(third->validation_messages(), 0) << "made after all of them";
  EXPECT_EQ(device->validation_messages(), before + 3);
}

TEST_F(Gpu, AFrameThatTakesTooLongIsTimedOutAndWaitedForLater) {
  vulkan::Program copy(device_);
  const vulkan::Buffer a(device_, "a", 1u << 26, vulkan::Buffer::Place::Device),
      b(device_, "b", 1u << 26, vulkan::Buffer::Place::Device);
  for (int k = 0; k < 8; ++k) copy.copy(0, a, b);
  copy.record(false);
  try {
    copy.run(0);
    ADD_FAILURE() << "half a gigabyte copied in no time";
  } catch (const vulkan::Failure& e) {
    EXPECT_EQ(e.result(), VK_TIMEOUT);
  }
  copy.run(10);
}

TEST_F(Gpu, ListIsNotEmptyAndBadIndexIsNoDevice) {
  ASSERT_FALSE(vulkan::Device::list().empty());
  const auto properties = nlohmann::json::parse(vulkan::Device::list().front().properties_json);
  EXPECT_GE(properties["limits"]["maxComputeWorkGroupCount"][0], 65535);
  EXPECT_GT(properties["limits"]["timestampPeriod"], 0);
  EXPECT_FALSE(properties["memory_heaps"].empty());
  try {
    vulkan::Device::get({1000, false});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::NoDevice);
  }
}

TEST(Room, IsForTheLargestBufferAndForAll) {
  EXPECT_EQ(why_no_room("a", 3u << 20, 5u << 20, 3u << 20, 5u << 20), "");
  EXPECT_EQ(why_no_room("a", 3u << 20, 5u << 20, (3u << 20) - 1, 5u << 20),
            "buffer \"a\" of 3.0 MiB, but the device's limit is 3.0 MiB");
  EXPECT_EQ(why_no_room("a", 3u << 20, 5u << 20, 3u << 20, (5u << 20) - 1),
            "buffers of at least 5.0 MiB, but the device has 5.0 MiB");
}

TEST(Kernels, AccessesAreReadFromTheCode) {
  using vulkan::Access;
  EXPECT_EQ(vulkan::accesses_of(shader("update_positions")),
            (std::map<std::uint32_t, Access>{{BIND_POSITIONS, Access::ReadWrite},
                                             {BIND_VELOCITIES, Access::Write},
                                             {BIND_PREDICTED, Access::Read},
                                             {BIND_SLIP, Access::ReadWrite}}));
  const vulkan::SpirV code = shader("update_positions");
  // The header has five words, and the first instruction (OpCapability) has two.
  EXPECT_THROW(vulkan::accesses_of({code.words, 6 * sizeof(std::uint32_t)}), Error) << "code that is cut off";
}

TEST_F(Gpu, ProfilesCutLimitsAndRefuseLargerWorkgroups) {
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

TEST_F(Gpu, BadSettingsAreRefused) {
  for (const auto& given : {nlohmann::json{{"iterations", 0}}, {{"stiffness", 1.5}}, {{"readback", "maybe"}}})
    EXPECT_THROW(make("paper", given), Error) << given;
  for (const char* solver : {"paper", "xpbd"})
    for (int substeps : {-3, 5000}) EXPECT_THROW(make(solver, {{"substeps", substeps}}), Error);
  EXPECT_THROW(make("paper", {{"substeps", 0}}), Error);
  EXPECT_THROW(make("xpbd", {{"quality", "best"}}), Error);
  for (int vertices : {-1, 1, 3, 64})
    EXPECT_THROW(make("xpbd", {{"tuning", {{"vertices_a_thread", vertices}}}}), Error);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
