// Chains with contact: what pushes a mesh strains it no more than its own tension asks for.
#include <algorithm>
#include <cmath>

#include "contact_scenes.hpp"
#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Mean strain of the edges, those that are short counted as 0.
double mean_strain(const ClothMesh& mesh, const std::vector<double>& x) {
  double sum = 0;
  for (const Edge& e : mesh.edges) {
    const double* a = &x[3 * std::size_t{e.a}];
    const double* b = &x[3 * std::size_t{e.b}];
    const double strain = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / e.rest_m - 1;
    sum += strain <= 0 ? 0 : strain;
  }
  return sum / static_cast<double>(mesh.edges.size());
}

class ChainContact : public Gpu {
 protected:
  /// A tube that hangs from its upper ring, and a capsule that comes through its side from within, aslant.
  static Scene pushed_tube(double stiffness_N_per_m, double speed_m_per_s) {
    constexpr int kAround = 48, kAlong = 20;
    Scene s = with_damping(mesh_tube(kAround, kAlong));
    s.cloth.axis_v = {0, 0, -1};  // the tube's axis is upwards
    s.material.membrane_stiffness_N_per_m = stiffness_N_per_m;
    for (std::uint32_t i = 0; i < kAround; ++i) s.pins.vertices.push_back((kAlong - 1) * kAround + i);
    s.needs.add(Feature::Pins);
    s.time = {72, 0.5};
    Collider c = touching(Collider::Shape::Capsules, 0.1);
    c.margin_m = 0.004;
    c.capsules = {{{0, 0.4, 0}, {0.05, 0.15, 0}, 0.04}};
    s = with_collider(s, c);
    for (int f = 0; f <= s.time.frames(); ++f) {
      const double way = speed_m_per_s * f / 72;
      FrameMotion m;
      m.colliders.resize(1);
      m.colliders[0].capsules = c.capsules;
      for (Capsule& q : m.colliders[0].capsules)
        for (Vec3* end : {&q.a_m, &q.b_m}) *end = {(*end)[0] + 0.6 * way, (*end)[1] - 0.3 * way, (*end)[2] + 0.1 * way};
      s.motion.push_back(m);
    }
    return s;
  }

  /// Mean over the second half of the scene, in which the capsule pushes.
  static double strain_of(const Scene& s, const nlohmann::json& settings) {
    const auto solver = make("xpbd", settings);
    solver->load(s);
    double sum = 0;
    for (int f = 0; f < s.time.frames(); ++f) {
      const std::vector<double> x = after_frame(*solver, s, f).position;
      if (2 * f >= s.time.frames()) sum += mean_strain(*s.cloth.mesh, x);
    }
    return sum / (s.time.frames() / 2);
  }
};

/// The strain that contact leaves is an error of the order in which colours and contact are solved.
TEST_F(ChainContact, IsSolvedAgainBetweenItsResponses) {
  for (const auto& [stiffness, speed] : {std::pair{1000.0, 0.5}, {5000.0, 1.0}}) {
    const Scene s = pushed_tube(stiffness, speed);
    const double once = strain_of(s, {{"tuning", {{"second_solve", "never"}}}}),
                 twice = strain_of(s, nlohmann::json::object());
    EXPECT_LE(twice, 0.8 * once) << stiffness << " N/m, " << speed << " m/s";
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
