#include "render/motion.hpp"

#include "results/store.hpp"
#include "results/stored_motion.hpp"

namespace clothbench::render {
namespace {

void tell(Motion& m, const RunHeader& header, const Outcome& outcome) {
  m.name = run_name(header);
  m.title = header.scene + " · " + header.solver;
  if (header.setting != "default") m.title += " " + header.setting;
  if (outcome.status != "ok") m.outcome = outcome.status;
}

}  // namespace

std::vector<double> Motion::at(std::size_t frame) const {
  const std::size_t count = 3 * scene.cloth.vertex_count();
  const auto from = position.begin() + static_cast<std::ptrdiff_t>(frame * count);
  return {from, from + static_cast<std::ptrdiff_t>(count)};
}

Motion stored_motion(const std::filesystem::path& path) {
  const RunRecord record = read_run_summary(path);
  StoredMotion stored = read_motion(path);
  Motion m = motion_of(stored.scene, record.header, record.outcome, {std::move(stored.time_s), {}, {}});
  m.position = std::move(stored.position);
  return m;
}

Motion motion_of(const Scene& scene, const RunHeader& header, const Outcome& outcome, AccuracyPass pass) {
  Motion m;
  m.scene = scene;
  m.held = !scene.colliders.empty() || !scene.grips.vertices.empty() || !scene.pins.vertices.empty();
  tell(m, header, outcome);
  m.time_s = std::move(pass.time_s);
  m.position = std::move(pass.position);
  return m;
}

}  // namespace clothbench::render
