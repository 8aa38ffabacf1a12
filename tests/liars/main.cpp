// Makes lies from correct motions and counts the ones that the motion check detects.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ctime>

#include "clothbench/error.hpp"
#include "metrics/motion_check/motion.hpp"
#include "metrics/registry.hpp"
#include "scenario/load.hpp"
#include "trial.hpp"

namespace clothbench::liars {
namespace {

/// CPU time of this process per frame [ms], shortest of five.
template <class Work>
double time_ms(std::size_t frames, Work work) {
  double shortest = INFINITY;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t start = std::clock();
    work();
    shortest = std::min(shortest, 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return shortest / static_cast<double>(frames);
}

/// Cost of the motion check, part by part, and of all other metrics of the run [ms per frame].
nlohmann::json cost_of(const std::string& name, const std::string& solver) {
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
  nlohmann::json out = {{"cost", name}, {"solver", solver}, {"vertices", m->vertices()}, {"other_metrics_ms", others}};
  out["check_ms"] = time_ms(m->frames(), [&] { (void)motion_check::verify(*scene, frames, m->contact_offsets_m); });
  const motion_check::Motion motion(*scene, frames);
  const std::unique_ptr<motion_check::Bodies> bodies = motion_check::bodies_of(motion, m->contact_offsets_m);
  for (const motion_check::Part& part : motion_check::parts())
    out["parts_ms"][part.name] = time_ms(m->frames(), [&] {
      motion_check::Findings found;
      part.run(motion, *bodies, found);
    });
  return out;
}

}  // namespace
}  // namespace clothbench::liars

int main(int argc, char** argv) {
  using namespace clothbench::liars;
  CLI::App app{"Makes wrong motions and prints for each whether the motion check rejects it, as one line of JSON."};
  Matrix matrix;
  std::string cost;
  app.add_option("--seed", matrix.seed, "seed of the first motion; each later motion has the next seed");
  app.add_option("--motions", matrix.motions, "number of right motions")->check(CLI::NonNegativeNumber);
  app.add_option("--kind", matrix.kinds, "kinds of scenes; default: all");
  app.add_option("--solver", matrix.solver, "only this solver, such as \"xpbd accurate\"");
  app.add_option("--lie", matrix.only_lie, "only this lie; \"none\": only right motions");
  app.add_option("--cost", cost, "time the check on this scene instead, with --solver or bullet-soft");
  CLI11_PARSE(app, argc, argv);
  try {
    if (!cost.empty())
      fmt::print("{}\n", cost_of(cost, matrix.solver.empty() ? "bullet-soft" : matrix.solver).dump());
    else
      for (const Trial& t : tell_all(matrix)) fmt::print("{}\n", as_json(t).dump());
  } catch (const clothbench::Error& e) {
    fmt::print(stderr, "liars: {}\n", e.what());
    return 2;
  }
}
