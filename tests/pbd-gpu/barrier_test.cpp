// The validation layer (1.3.239) does not detect a missing barrier between kernels that update a buffer in place, and
// lavapipe, which runs dispatches one after another, hides it. So this test checks the recorded commands: accesses from
// the kernels' own code, barriers with the masks that were recorded.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "contact_scenes.hpp"
#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr VkAccessFlags kAnyAccess = ~VkAccessFlags{0};

/// One event on the queue's or the host's time line.
struct Event {
  enum class Kind { Access, Barrier } kind = Kind::Access;
  std::string name;
  // Access:
  VkPipelineStageFlags stage = 0;
  struct Touch {
    const vulkan::Buffer* buffer;
    bool read, written;
  };
  std::vector<Touch> touches;
  VkAccessFlags read_access = 0, write_access = 0;
  // Barrier:
  VkPipelineStageFlags before = 0, after = 0;
  VkAccessFlags made_available = 0, made_visible = 0;
  std::pair<const vulkan::Program*, std::size_t> source{nullptr, 0};  ///< the recorded barrier; null for implicit ones
};

Event implicit_barrier(const char* name, VkPipelineStageFlags before, VkPipelineStageFlags after,
                       VkAccessFlags available, VkAccessFlags visible) {
  Event e;
  e.kind = Event::Kind::Barrier;
  e.name = name;
  e.before = before;
  e.after = after;
  e.made_available = available;
  e.made_visible = visible;
  return e;
}

Event work(const vulkan::Program::Recorded& r) {
  Event e;
  if (r.kernel == nullptr) {
    e.name = "copy " + r.from->name() + " -> " + r.to->name();
    e.stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    e.read_access = VK_ACCESS_TRANSFER_READ_BIT;
    e.write_access = VK_ACCESS_TRANSFER_WRITE_BIT;
    e.touches = {{r.from, true, false}, {r.to, false, true}};
    return e;
  }
  e.name = r.kernel->name();
  e.stage = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
  e.read_access = VK_ACCESS_SHADER_READ_BIT;
  e.write_access = VK_ACCESS_SHADER_WRITE_BIT;
  for (const vulkan::Binding& b : r.kernel->bindings())
    e.touches.push_back({b.buffer, b.access != vulkan::Access::Write, b.access != vulkan::Access::Read});
  return e;
}

/// Host event: writes the buffers that are copied from, reads the buffers that are copied to.
Event host(const std::set<const vulkan::Buffer*>& filled, const std::set<const vulkan::Buffer*>& fetched) {
  Event e;
  e.name = "host";
  e.stage = VK_PIPELINE_STAGE_HOST_BIT;
  e.read_access = VK_ACCESS_HOST_READ_BIT;
  e.write_access = VK_ACCESS_HOST_WRITE_BIT;
  for (const vulkan::Buffer* b : filled) e.touches.push_back({b, false, true});
  for (const vulkan::Buffer* b : fetched) e.touches.push_back({b, true, false});
  return e;
}

/// Whether barrier b orders `first` before `second` and makes the writes of `first` visible.
bool orders(const Event& b, const Event& first, const Event& second, const Event::Touch& f, const Event::Touch& s) {
  if ((b.before & first.stage) == 0 || (b.after & second.stage) == 0) return false;
  if (!f.written) return true;  // write after read: execution order is enough
  const VkAccessFlags next = (s.read ? second.read_access : 0) | (s.written ? second.write_access : 0);
  return (b.made_available & first.write_access) != 0 && (b.made_visible & next) == next;
}

/// Time line of programs that are submitted one after another, each with a wait. The host accesses their host buffers
/// before the first and after each.
std::vector<Event> time_line(const std::vector<const vulkan::Program*>& submitted) {
  std::set<const vulkan::Buffer*> filled, fetched;
  for (const vulkan::Program* p : submitted)
    for (const auto& r : p->recorded()) {
      if (r.from != nullptr && r.from->place() == vulkan::Buffer::Place::Host) filled.insert(r.from);
      if (r.to != nullptr && r.to->place() == vulkan::Buffer::Place::Host) fetched.insert(r.to);
      if (r.kernel == nullptr) continue;
      for (const vulkan::Binding& b : r.kernel->bindings())  // a kernel's counters in host memory
        if (b.access != vulkan::Access::Read && b.buffer->place() == vulkan::Buffer::Place::Host)
          fetched.insert(b.buffer);
    }
  constexpr VkPipelineStageFlags kEverything = ~VkPipelineStageFlags{0};
  std::vector<Event> events = {host(filled, fetched)};
  for (const vulkan::Program* p : submitted) {
    // vkQueueSubmit makes host writes visible to the device; it does not order earlier submissions.
    events.push_back(
        implicit_barrier("submit", VK_PIPELINE_STAGE_HOST_BIT, kEverything, VK_ACCESS_HOST_WRITE_BIT, kAnyAccess));
    std::size_t barriers = 0;
    for (const auto& r : p->recorded()) {
      if (!r.is_barrier) {
        events.push_back(work(r));
        continue;
      }
      events.push_back(implicit_barrier("recorded", r.stages_before, r.stages_after, r.written, r.next));
      events.back().source = {p, barriers++};
    }
    // Waiting for the fence orders execution, but makes nothing visible to the host.
    events.push_back(implicit_barrier("fence", kEverything, VK_PIPELINE_STAGE_HOST_BIT, 0, 0));
    events.push_back(host(filled, fetched));
  }
  return events;
}

/// The first pair of accesses that no barrier orders, as text; empty if there is none. Barriers in `without` are
/// treated as absent.
std::string hazard(const std::vector<Event>& events,
                   std::pair<const vulkan::Program*, std::size_t> without = {nullptr, 0}) {
  for (std::size_t j = 0; j < events.size(); ++j) {
    std::vector<const Event*> between;
    for (std::size_t i = j; events[j].kind == Event::Kind::Access && i-- > 0;) {
      const Event& first = events[i];
      if (first.kind == Event::Kind::Barrier) {
        if (first.source.first == nullptr || first.source != without) between.push_back(&first);
        continue;
      }
      // Host accesses are in program order.
      if (first.stage == VK_PIPELINE_STAGE_HOST_BIT && events[j].stage == VK_PIPELINE_STAGE_HOST_BIT) continue;
      for (const auto& f : first.touches)
        for (const auto& s : events[j].touches) {
          if (f.buffer != s.buffer || !((f.written && (s.read || s.written)) || (f.read && s.written))) continue;
          const bool ordered = std::any_of(between.begin(), between.end(),
                                           [&](const Event* b) { return orders(*b, first, events[j], f, s); });
          if (!ordered)
            return fmt::format("{} then {} on \"{}\" (events {} and {})", first.name, events[j].name, f.buffer->name(),
                               i, j);
        }
    }
  }
  return "";
}

struct SolverRun {
  std::string solver;
  nlohmann::json settings;
  Scene scene;
};

std::vector<SolverRun> runs() {
  const Scene plain = sheet(7, 5), full = with_pins(with_damping(with_bending(sheet(7, 5))));
  return {{"paper", {{"iterations", 2}}, plain},
          {"paper", {{"iterations", 2}, {"substeps", 2}}, full},
          {"paper", {{"iterations", 2}, {"readback", "blocking"}}, doubled(full)},
          {"paper", {{"iterations", 2}, {"substeps", 2}}, everything(full)},
          {"paper", {{"iterations", 2}, {"substeps", 2}}, moving(doubled(full), {3, 20}, 2)},
          {"xpbd", {{"substeps", 2}}, plain},
          {"xpbd", {{"substeps", 2}}, full},
          {"xpbd", {{"substeps", 2}}, with_pins(sheet(33, 5))},
          {"xpbd", {{"substeps", 2}}, everything(full)},
          {"xpbd", {{"substeps", 2}}, folded(full, 0.1, kContactFriction)},
          {"xpbd", {{"substeps", 2}}, mesh_sheet(7)},
          {"xpbd", {{"substeps", 2}}, with_bending(mesh_sheet(7))},
          {"xpbd", {{"substeps", 2}}, everything(mesh_sheet(7))},
          {"xpbd", {{"substeps", 2}}, everything(with_bending(mesh_sheet(7)))},
          {"xpbd", {{"substeps", 2}}, folded(with_pins(sheet(9, 7)), 0.1, 0.3)},
          {"xpbd", {{"substeps", 2}}, everything(folded(with_pins(sheet(9, 7))))},
          {"xpbd", {{"substeps", 2}}, with_pins(with_damping(uneven(sheet(17, 5), 3, 1e-3)))},
          {"xpbd", {{"substeps", 2}}, moving(with_collider(full, sphere({0, 0, 0}, 0.1)), {3, 20}, 2)}};
}

using Barriers = Gpu;

TEST_F(Barriers, NoneIsMissingAndNoneIsThereInVain) {
  for (const SolverRun& run : runs()) {
    const auto solver = make(run.solver, run.settings);
    solver->load(run.scene);
    const vulkan::Program *up = &solver->upload_program(), *frame = &solver->frame_program(),
                          *down = &solver->download_program();
    const std::vector<Event> events = time_line({up, down, frame, frame, down, frame, up, frame, down});
    EXPECT_EQ(hazard(events), "") << run.solver << run.settings;
    int overflow = 0;
    for (const vulkan::Program* p : {up, frame, down}) {
      const auto& recorded = p->recorded();
      const auto barriers = std::count_if(recorded.begin(), recorded.end(), [](const auto& r) { return r.is_barrier; });
      ASSERT_GT(barriers, 0);
      for (std::size_t k = 0; k < static_cast<std::size_t>(barriers); ++k, ++overflow)
        EXPECT_NE(hazard(events, {p, k}), "")
            << run.solver << run.settings << ": without barrier " << k << " of " << barriers;
    }
    EXPECT_GE(overflow, 4) << "one at the start of each program, and one for the host";
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
