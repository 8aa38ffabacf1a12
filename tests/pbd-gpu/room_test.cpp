// Meshes that do not fit a device: one error that says what is needed, before anything is allocated.
#include "random_sheet.hpp"
#include "xpbd/mesh/membrane.hpp"

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
      Scene s = random_sheet(1, 0.5, 12, 0.5, 0.3, 5);
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

}  // namespace
}  // namespace clothbench::pbd_gpu
