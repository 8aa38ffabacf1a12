// Meshes that do not fit a device: one error that says what is needed, before anything is allocated.
#include "drawn_sheet.hpp"
#include "mesh_membrane.hpp"

namespace clothbench::pbd_gpu {
namespace {

TEST(Room, IsForTheLargestBufferAndForAll) {
  const std::vector<BufferNeed> needs = {{"a", 3u << 20}, {"b", 2u << 20}};
  EXPECT_EQ(breach(needs, 3u << 20, 5u << 20), "");
  EXPECT_EQ(breach(needs, (3u << 20) - 1, 5u << 20), "buffer \"a\" of at least 3.0 MiB, and its largest has 3.0 MiB");
  EXPECT_EQ(breach(needs, 3u << 20, (5u << 20) - 1), "buffers of at least 5.0 MiB, and it has 5.0 MiB");
}

using RoomOf = Gpu;

/// What is required beforehand is never more than what is made.
TEST_F(RoomOf, MeshesIsWhatTheirBuffersTake) {
  for (const bool bends : {false, true})
    for (const bool elastic : {false, true}) {
      Scene s = drawn_sheet(1, 0.5, 12, 0.5, 0.3, 5);
      if (!elastic) s.material.membrane_stiffness_N_per_m.reset();
      if (bends) {
        s.material.bending_rigidity_N_m = 1e-4;
        s.needs.add(Feature::Bend);
      }
      const auto solver = make("xpbd");
      solver->load(s);
      for (const BufferNeed& need : mesh_needs(s, elastic)) {
        const auto& buffers = solver->plan().buffers;
        const auto made =
            std::find_if(buffers.begin(), buffers.end(), [&](const auto& b) { return b.name == need.name; });
        ASSERT_NE(made, buffers.end()) << need.name;
        EXPECT_LE(need.bytes, made->bytes) << need.name;
        if (need.name != "chain entries" && need.name != "bending entries") {  // those are counted whole
          EXPECT_EQ(need.bytes, made->bytes) << need.name;
        }
      }
    }
}

/// A sheet of so many squares, halved.
Scene large_sheet(int cells) {
  std::vector<Vec3> x;
  std::vector<std::array<std::uint32_t, 3>> t;
  const auto n = static_cast<std::uint32_t>(cells + 1);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) x.push_back({1.0 * i / cells, 1.0 * j / cells, 0});
  for (std::uint32_t j = 0; j + 1 < n; ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = j * n + i, b = a + 1, c = a + n, d = c + 1;
      t.push_back({a, b, d});
      t.push_back({a, d, c});
    }
  return of_mesh(cloth_mesh(std::move(x), std::move(t), "sheet"), {0});
}

/// Of a device that binds at most 128 MiB at a time, the corners of a million triangles are more. What fits, runs.
TEST_F(RoomOf, AMillionTrianglesIsThereOrAnError) {
  Scene s = large_sheet(708);
  s.source = "a million triangles";
  const auto solver = make("xpbd", {{"tuning", {{"membrane", "always"}}}});
  const auto needs = mesh_needs(s, true);
  if (breach(needs, device_->limits().maxStorageBufferRange, device_->memory_B()).empty())
    GTEST_SKIP() << "the device has room for them";
  try {
    solver->load(s);
    ADD_FAILURE();
  } catch (const Error& e) {
    const std::string text = e.what();
    for (const char* part : {"a million triangles: /cloth/mesh: 502681 vertices and 1002528 triangles do not fit",
                             "buffer \"triangle corners\" of at least", "its largest has"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_TRUE(solver->plan().buffers.empty()) << "something was allocated";
}

}  // namespace
}  // namespace clothbench::pbd_gpu
