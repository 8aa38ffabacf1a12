// Tells lies of right motions and counts those that the check of motions sees.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ctime>

#include "clothbench/error.hpp"
#include "metrics/metric_pass.hpp"
#include "metrics/motion_check/bodies.hpp"
#include "scenario/load.hpp"
#include "trial.hpp"

namespace clothbench::liars {
namespace {

/// Time [ms] of this process, which other processes do not lengthen.
double now_ms() { return 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Shortest of five times [ms] per frame.
template <class Work>
double time_ms(std::size_t frames, Work work) {
  double least = INFINITY;
  for (int i = 0; i < 5; ++i) {
    const double start = now_ms();
    work();
    least = std::min(least, now_ms() - start);
  }
  return least / static_cast<double>(frames);
}

/// What the check costs, and all other metrics of the same run.
void print_cost(const std::string& name, const std::string& solver) {
  const auto scene = std::make_shared<const Scene>(load_scene(name));
  const std::optional<Motion> m = run(scene, {solver, "{}"});
  if (!m) throw Error(name + ": a step of the solver failed");
  const nlohmann::json settings = complete_settings(find_solver(solver).info, nlohmann::json::object());
  const double others = time_ms(m->frames(), [&] {
    MetricPass pass({*scene, find_solver(solver), settings, m->contact_offsets_m});
    ClothState state;
    state.velocity.assign(3 * m->vertices(), 0);
    for (std::size_t k = 0; k < m->frames(); ++k) {
      const auto from = m->position.begin() + static_cast<std::ptrdiff_t>(3 * m->vertices() * k);
      state.position.assign(from, from + static_cast<std::ptrdiff_t>(3 * m->vertices()));
      pass.add(state);
    }
  });
  const motion_check::Frames frames{m->time_s, m->position};
  const double all = time_ms(m->frames(), [&] { (void)motion_check::verify(*scene, frames, m->contact_offsets_m); });
  fmt::print("{} by {}, {} vertices, ms per frame\n", name, solver, m->vertices());
  std::vector<double> part_ms(motion_check::parts().size(), INFINITY);
  for (int i = 0; i < 5; ++i) {
    const motion_check::Motion motion(*scene, frames);
    motion_check::Bodies bodies(motion, m->contact_offsets_m);
    motion_check::Findings found;
    for (std::size_t p = 0; p < part_ms.size(); ++p) {
      const double start = now_ms();
      motion_check::parts()[p].run(motion, bodies, found);
      part_ms[p] = std::min(part_ms[p], (now_ms() - start) / static_cast<double>(m->frames()));
    }
  }
  for (std::size_t p = 0; p < part_ms.size(); ++p)
    fmt::print("  {:<11} {:.3f}\n", motion_check::parts()[p].name, part_ms[p]);
  fmt::print("  together {:.3f}, other metrics {:.3f}: all metrics cost {:.2f} times as much as the others\n", all,
             others, (all + others) / others);
}

}  // namespace
}  // namespace clothbench::liars

int main(int argc, char** argv) {
  using namespace clothbench::liars;
  CLI::App app{"Wrong motions, and which of them the check of motions fails."};
  Matrix matrix;
  std::string cost;
  bool json = false, list = false;
  app.add_option("--seed", matrix.seed, "of the first motion; each motion has the next");
  app.add_option("--motions", matrix.motions, "number of right motions")->check(CLI::NonNegativeNumber);
  app.add_option("--kind", matrix.kinds, "kinds of scenes; default: all");
  app.add_option("--solver", matrix.solver, "this solver alone, such as \"xpbd accurate\"");
  app.add_option("--lie", matrix.only_lie, "this lie alone");
  app.add_option("--motion-cache", matrix.motion_cache, "folder that keeps motions between calls");
  app.add_option("--store", matrix.store, "folder for the plugin that replays the motions");
  app.add_option("--cost", cost, "time the check on this scene instead, with --solver or bullet-soft");
  app.add_flag("--json", json, "every trial with every ratio");
  app.add_flag("--list", list, "names of kinds and lies");
  CLI11_PARSE(app, argc, argv);
  try {
    if (list) {
      for (const std::string& kind : scene_kinds()) fmt::print("kind {}\n", kind);
      for (const Lie& lie : lies()) fmt::print("{} {}\n", lie.right ? "control" : "lie", lie.name);
      return 0;
    }
    if (!cost.empty()) {
      print_cost(cost, matrix.solver.empty() ? "bullet-soft" : matrix.solver);
      return 0;
    }
    const auto trials = tell_all(matrix, [](const std::string& line) { fmt::print(stderr, "{}\n", line); });
    fmt::print("{}\n", json ? as_json(trials).dump() : as_text(trials));
  } catch (const clothbench::Error& e) {
    fmt::print(stderr, "liars: {}\n", e.what());
    return 2;
  }
}
