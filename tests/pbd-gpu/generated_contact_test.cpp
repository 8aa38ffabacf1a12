// Contact by planes over drawn scenes: at every step every pair of a triangle and a convex shape whose boxes meet is
// certified in double. CLOTHBENCH_DRAWN_SCENES and CLOTHBENCH_DRAWN_SEED give their number and the first seed.
#include <fmt/format.h>

#include <random>

#include "contact_check.hpp"
#include "contact_scenes.hpp"

namespace clothbench::pbd_gpu {
namespace {

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
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

/// A sheet thrown at one to three colliders; frames are steps. Kinematic shapes goes 10 mm a step, at up to 13 m/s.
Scene drawn(unsigned seed) {
  Draw draw(seed);
  Scene s = sheet(12, 10);
  s.name = "drawn " + std::to_string(seed);
  s = two_sided(s);
  s.cloth.center_m = {0, 0.35, 0};
  s.cloth.initial_velocity_m_per_s = {draw.between(-2, 2), draw.between(-6, -1), draw.between(-2, 2)};
  s.time = {draw.between(300, 1300), 0.15};
  for (int count = 1 + draw.below(3); count > 0; --count) s = with_collider(s, draw.collider(draw.below(6)));
  const bool moves = std::any_of(s.colliders.begin(), s.colliders.end(), [](const Collider& c) { return c.moves(); });
  return moves ? moving(s) : s;
}

/// A sheet of any direction that turns in the air, is thrown at what `drawn` has in its way, and falls onto itself.
Scene random_heap(unsigned seed) {
  Scene s = drawn(seed);
  s.name = "drawn heap " + std::to_string(seed);
  Draw draw(seed + 1000000);
  const double angle = draw.between(0, 6.28), cosine = std::cos(angle), sine = std::sin(angle);
  s.cloth.axis_u = {cosine, sine, 0};
  s.cloth.axis_v = {-sine * 0.6, cosine * 0.6, 0.8};
  s.cloth.center_m = {0, 0.75, 0};
  s.cloth.spin_rad_per_s = {draw.between(-8, 8), draw.between(-8, 8), draw.between(-8, 8)};
  s.needs.add(Feature::Spin);
  s.cloth.self_collision = {draw.between(0.05, 0.5) * s.cloth.least_height_m(), draw.between(0, 0.6)};
  s.needs.add(Feature::SelfCollision);
  Collider floor = half_space({0, -0.2, 0}, {0, 1, 0}, draw.between(0, 0.6));
  floor.margin_m = draw.between(0.002, 0.02);
  s = with_collider(s, floor);
  s.time.duration_s = 0.4;
  if (s.motion.empty()) return s;
  s.motion.clear();
  return moving(s);
}

class GeneratedContacts : public Gpu {
 protected:
  /// Scenes by number, their pass rate printed. `min_own`: pairs of the cloth with itself that a scene should have.
  static void expect_to_pass(Scene (*scene_of)(unsigned), int usual, long min_own);
};

void GeneratedContacts::expect_to_pass(Scene (*scene_of)(unsigned), int usual, long min_own) {
  const int count = from_environment("CLOTHBENCH_DRAWN_SCENES", usual),
            first = from_environment("CLOTHBENCH_DRAWN_SEED", 1);
  int passed = 0;
  long pairs = 0, own_pairs = 0;
  std::string failed;
  for (int k = 0; k < count; ++k) {
    const Scene s = scene_of(static_cast<unsigned>(first + k));
    const auto solver = make("xpbd", {{"substeps", 1}});
    const std::string fault = fault_of(*solver, s, pairs, own_pairs);
    passed += fault.empty();
    if (!fault.empty()) failed += fmt::format("\n  {}: {}", s.name, fault);
  }
  fmt::print("{} of {} scenes pass, {} pairs with convex shapes and {} of the cloth with itself{}\n", passed, count,
             pairs, own_pairs, failed);
  EXPECT_GT(pairs, 1000L * count) << "something must come near for this to say anything";
  EXPECT_TRUE(own_pairs >= min_own * count);
  EXPECT_EQ(passed, count) << failed;
}

TEST_F(GeneratedContacts, PassNothing) { expect_to_pass(drawn, 24, 0); }

TEST_F(GeneratedContacts, OfClothThatFallsOntoItselfPassNothing) { expect_to_pass(random_heap, 8, 1000); }

}  // namespace
}  // namespace clothbench::pbd_gpu
