// Relations of two runs that must hold for every solver: conformance cases that need no exact solution.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "metrics/metric.hpp"
#include "runner/conformance.hpp"
#include "runner/frame_loop.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using namespace std::string_literals;

/// States before the first frame and after every frame.
using Motion = std::vector<ClothState>;

/// Continues the motion `so_far` to the scene's end. Throws SolverError if a frame fails.
Motion motion_of(ClothSolver& solver, const Scene& scene, Motion so_far = {}) {
  FrameLoop loop(solver, scene, {.first = static_cast<int>(so_far.size()), .frames = scene.time.frames()});
  solver.read_state(so_far.emplace_back());
  while (loop.next()) solver.read_state(so_far.emplace_back());
  if (loop.failed()) throw SolverError(fmt::format("frame {}: step failed", loop.index()));
  return so_far;
}

/// Overrides of scenarios/conformance/sheet.json, and how they change the motion of its sheet, which is pinned at both
/// ends of one side.
struct Relation {
  const char* name = "";
  std::vector<std::string> overrides = {};
  double at_most = 0;
  bool own_error = false, mirrored = false, transposed = false;
  double lengths = 1;  ///< factor of all lengths and of gravity; times stay
};
const Relation kRelations[] = {{"repeat", {}, 0},
                               {"restart", {}, 1e-4, true},
                               {"mirror", {"cloth.pose.axis_u=[-1,0,0]"}, 1e-4, false, true},
                               {"renumber",
                                {"cloth.grid=[13,17]", "cloth.size_m=[0.75,1]", "cloth.pose.axis_u=[0,0,1]",
                                 "cloth.pose.axis_v=[1,0,0]", R"(pins=[{"corners":["u0v0","u0v1"]}])"},
                                1e-4,
                                true,
                                false,
                                true},
                               {"no-op",
                                {R"(colliders=[{"type":"sphere","center_m":[0,100,0],"radius_m":0.5,"friction":0.5},
                    {"type":"box","center_m":[0,100,0],"size_m":[1,1,1],"friction":0.5}])"},
                                1e-6},
                               {.name = "small", .at_most = 0.01, .lengths = 0x1p-6},
                               {.name = "large", .at_most = 0.01, .lengths = 0x1p8}};

const Relation& relation_of(const std::string& name) {
  return *std::find_if(std::begin(kRelations), std::end(kRelations), [&](auto& r) { return name == r.name; });
}

/// One relation of a solver on a scene; `related` is the scene with the relation's overrides.
class RelationCheck {
 public:
  RelationCheck(const SolverEntry& entry, const json& settings, const DeviceOptions& device, const ConformanceCase& c,
                const Scene& related)
      : entry_(entry),
        settings_(settings),
        device_(device),
        case_(c),
        by_(relation_of(c.relation)),
        related_(related) {}

  ConformanceResult run() {
    const Scene scene = load_scene(case_.scene);
    const Motion base = fresh_motion(scene);
    ConformanceResult out;
    out.frames = scene.time.frames();
    const auto solver = load_solver(entry_, settings_, device_, related_);
    Motion so_far;
    if (case_.relation == "restart") {
      const std::size_t half = base.size() / 2;
      if (!solver->restart_at(base[half], frame_input(scene, static_cast<int>(half) - 1))) {
        out.unsupported = entry_.info.name + ": positions and velocities are not its whole state";
        return out;
      }
      so_far = {base.begin(), base.begin() + static_cast<std::ptrdiff_t>(half)};
    }
    expect(base, motion_of(*solver, related_, std::move(so_far)), scene, out);
    if (case_.relation != "repeat") return out;
    solver->reset();
    expect(base, motion_of(*solver, related_), scene, out);
    return out;
  }

 private:
  Motion fresh_motion(const Scene& s) const { return motion_of(*load_solver(entry_, settings_, device_, s), s); }

  void expect(const Motion& base, const Motion& found, const Scene& scene, ConformanceResult& out) const {
    double at_most = by_.at_most;
    if (case_.relation == "repeat" && entry_.info.name == "paper") at_most = 1e-6;
    const double distance = distance_of(base, found, scene, by_);
    const bool bits = at_most > 0 || std::equal(base.begin(), base.end(), found.begin(), found.end(),
                                                [](const ClothState& a, const ClothState& b) {
                                                  return a.position == b.position && a.velocity == b.velocity;
                                                });
    if (bits && !(distance <= at_most) && by_.own_error) at_most = std::max(at_most, own_error(base, scene));
    if (!bits || !(distance <= at_most))
      out.faults.push_back(
          fmt::format("a vertex is {:.4g} of the longer side from its expected position, more than {:.4g}{}", distance,
                      at_most, at_most > 0 ? "" : ", or not bit-identical"));
  }

  /// Largest distance over vertices and frames, divided by the longer side of the cloth; NaN if any position is NaN.
  static double distance_of(const Motion& base, const Motion& found, const Scene& scene, const Relation& by = {}) {
    const std::size_t columns = static_cast<std::size_t>(scene.cloth.columns);
    const std::size_t rows = static_cast<std::size_t>(scene.cloth.rows);
    double worst = 0;
    for (std::size_t f = 0; f < base.size(); ++f)
      for (std::size_t v = 0; 3 * v < base[f].position.size(); ++v) {
        Vec3 expected = vertex_at(base[f].position, static_cast<std::uint32_t>(v));
        if (by.mirrored) expected[0] = -expected[0];
        const std::size_t at = by.transposed ? v % columns * rows + v / columns : v;
        const Vec3 x = vertex_at(found[f].position, static_cast<std::uint32_t>(at));
        worst = max_or_nan(worst, length(minus(x, scaled(by.lengths, expected))) / by.lengths);
      }
    return worst / std::max(scene.cloth.width_m, scene.cloth.height_m);
  }

  /// Change of the motion if frames are half as long.
  double own_error(const Motion& base, const Scene& scene) const {
    const Scene finer = load_scene(case_.scene, {fmt::format("time.frame_rate_hz={}", 2 * scene.time.frame_rate_hz)});
    const Motion all = fresh_motion(finer);
    Motion found;
    for (std::size_t f = 0; f < all.size(); f += 2) found.push_back(all[f]);
    return distance_of(base, found, scene);
  }

  const SolverEntry& entry_;
  const json& settings_;
  const DeviceOptions& device_;
  const ConformanceCase& case_;
  const Relation& by_;
  const Scene& related_;
};

}  // namespace

std::vector<std::string> relations_of(const std::string& scene, bool scaled) {
  const bool drop = scene == "conformance/drop", sheet = scene == "conformance/sheet";
  std::vector<std::string> all;
  for (const Relation& r : kRelations)
    if ((sheet || (drop && (r.name == "repeat"s || r.name == "restart"s || r.lengths != 1))) &&
        (scaled || r.lengths == 1))
      all.emplace_back(r.name);
  return all;
}

Scene related_scene(const std::string& scene, const std::string& relation) {
  const Relation& by = relation_of(relation);
  Scene related = load_scene(scene, by.overrides);
  if (by.lengths == 1) return related;
  json copy = json_from(related.json);
  scale_units(copy, by.lengths, 1);
  return scene_from_json(copy, related.source);
}

ConformanceResult run_relation(const SolverEntry& entry, const json& settings, const DeviceOptions& device,
                               const Scene& related, const ConformanceCase& c) {
  return RelationCheck(entry, settings, device, c, related).run();
}

}  // namespace clothbench
