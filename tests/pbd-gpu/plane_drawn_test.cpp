// Contact by planes over drawn scenes: at every step every pair of a triangle and a piece whose boxes meet is certified
// in double. CLOTHBENCH_DRAWN_SCENES and CLOTHBENCH_DRAWN_SEED give their number and the first seed.
#include <fmt/format.h>

#include <random>

#include "contact_scenes.hpp"
#include "plane_contact_check.hpp"

namespace clothbench::pbd_gpu {
namespace {

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

/// 95 % interval of a share (Wilson 1927).
std::pair<double, double> interval(int passed, int of) {
  constexpr double z = 1.96;
  const double n = of, p = passed / n, centre = p + z * z / (2 * n), below = 1 + z * z / n;
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {(centre - half) / below, (centre + half) / below};
}

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  /// Uniform, by whole numbers: the library's distributions differ from one to another.
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() % 1000001) / 1e6;
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }

  Vec3 place() { return {between(-0.2, 0.2), between(-0.05, 0.05), between(-0.2, 0.2)}; }

  Collider collider(int kind) {
    const double friction = between(0, 0.6);
    Collider c = kind == 0   ? sphere(place(), between(0.007, 0.15), friction)
                 : kind == 1 ? box(place(), {between(0.03, 0.3), between(0.01, 0.08), between(0.03, 0.2)}, friction)
                 : kind == 2 ? capsules(place(), friction)
                 : kind == 3 ? octahedron(place(), between(0.02, 0.12), false, friction)
                 : kind == 4 ? octahedron(place(), between(0.02, 0.12), true, friction)
                             : open_sheet(place(), between(0.05, 0.3), friction);
    c.margin_m = between(0.002, 0.02);
    return c;
  }

 private:
  std::mt19937 engine_;
};

/// A sheet thrown at one to three colliders; frames are steps. What moves goes 10 mm a step, at up to 13 m/s.
Scene drawn(unsigned seed) {
  Draw draw(seed);
  Scene s = sheet(12, 10);
  s.name = "drawn " + std::to_string(seed);
  s.cloth.sides = Sides::Double;
  s.needs.add(Feature::DoubleSided);
  s.cloth.center_m = {0, 0.35, 0};
  s.cloth.initial_velocity_m_per_s = {draw.between(-2, 2), draw.between(-6, -1), draw.between(-2, 2)};
  s.time = {draw.between(300, 1300), 0.15};
  for (int count = 1 + draw.below(3); count > 0; --count) s = with_collider(s, draw.collider(draw.below(6)));
  const bool moves = std::any_of(s.colliders.begin(), s.colliders.end(), [](const Collider& c) { return c.moves(); });
  return moves ? moving(s) : s;
}

/// What is wrong with the run of a scene; empty if nothing is.
std::string fault_of(GpuSolver& solver, const Scene& s, long& pairs) {
  solver.load(s);
  std::vector<double> before = initial_positions(s);
  for (int f = 0; f < s.time.frames(); ++f) {
    const ClothState state = after_frame(solver, s, f);
    const PairCheck check = check_pairs(s, before, state.position, f);
    if (!(check.parted == check.pairs))
      return fmt::format("{} of {} pairs in step {}", check.pairs - check.parted, check.pairs, f);
    pairs += check.pairs;
    before = state.position;
  }
  for (const SolverCount& c : solver.counts())
    if (!(c.count <= 0)) return fmt::format("{} {}", c.count, c.name);
  return {};
}

using PlaneDraws = Gpu;

TEST_F(PlaneDraws, PassNothing) {
  const int count = from_environment("CLOTHBENCH_DRAWN_SCENES", 24),
            first = from_environment("CLOTHBENCH_DRAWN_SEED", 1);
  int passed = 0;
  long pairs = 0;
  std::string failed;
  for (int k = 0; k < count; ++k) {
    const Scene s = drawn(static_cast<unsigned>(first + k));
    const auto solver = make("xpbd", {{"substeps", 1}, {kTuning, {{"contact", "planes"}}}});
    const std::string fault = fault_of(*solver, s, pairs);
    passed += fault.empty();
    if (!fault.empty()) failed += fmt::format("\n  {}: {}", s.name, fault);
  }
  const auto [low, high] = interval(passed, count);
  fmt::print("{} of {} scenes pass (95 % interval {:.3f} to {:.3f}), {} pairs certified{}\n", passed, count, low, high,
             pairs, failed);
  EXPECT_GT(pairs, 1000L * count) << "something must come near for this to say anything";
  EXPECT_EQ(passed, count) << failed;
}

}  // namespace
}  // namespace clothbench::pbd_gpu
