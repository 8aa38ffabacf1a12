// Collision kernels of `paper` against the same method in double on the CPU, and uploads per frame. A freely flying
// sheet satisfies all constraints: its predicted positions are known, and only contact moves them.
#include <Eigen/Dense>
#include <algorithm>

#include "contact_scenes.hpp"
#include "runner/solver_run.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Vector = Eigen::Vector3d;

Vector vector(const Vec3& v) { return {v[0], v[1], v[2]}; }

struct Contact {
  double mesh_depth = 0.03, hand_depth = 0.01;  // defaults of the solver
  bool slows = false;                           // friction on velocities
  Vector removed = Vector::Zero();              // displacement that does not count in the velocity of a particle
  long touched = 0;

  void touch(Vector& at, const Vector& from, const Vector& normal, double push, double friction) {
    at += push * normal;
    const Vector way = at - from, taken = std::min(friction, 1.0) * (way - way.dot(normal) * normal);
    (slows ? removed : at) += slows ? taken : Vector(-taken);
    ++touched;
  }
  void ball(Vector& at, const Vector& from, const Vector& center, double reach, double friction) {
    const Vector d = at - center;
    if (d.norm() < reach) touch(at, from, d.normalized(), reach - d.norm(), friction);
  }
  void box(Vector& at, const Vector& from, const Collider& c) {
    double least = 1e300;
    Vector normal = Vector::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = (at - vector(c.center_m)).dot(vector(c.axes[k]));
      const double depth = c.half_extent_m[k] + c.margin_m - std::abs(along);
      if (depth <= 0) return;
      if (depth < least) {
        least = depth;
        normal = (along < 0 ? -1 : 1) * vector(c.axes[k]);
      }
    }
    touch(at, from, normal, least, c.friction);
  }
  void capsule(Vector& at, const Vector& from, const Capsule& c, const Collider& of) {
    const Vector a = vector(c.a_m), ab = vector(c.b_m) - a;
    const double t = ab.squaredNorm() > 0 ? std::clamp((at - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
    ball(at, from, a + t * ab, c.radius_m + of.margin_m, of.friction);
  }
  void mesh(Vector& at, const Vector& from, const Collider& c, const std::vector<double>& x, double depth) {
    for (const auto& t : c.mesh->triangles) {
      const Vector a = Vector::Map(&x[3 * t[0]]), b = Vector::Map(&x[3 * t[1]]), d = Vector::Map(&x[3 * t[2]]);
      const Vector normal = (b - a).cross(d - a).normalized();
      const double height = (at - a).dot(normal);
      // Barycentric coordinates of the projection, from the 3 x 3 system of its definition.
      Eigen::Matrix3d m;
      m << b - a, d - a, normal;
      const Vector s = m.inverse() * (at - a);
      if (height < c.margin_m && height > -depth && s[0] >= 0 && s[1] >= 0 && s[0] + s[1] <= 1)
        touch(at, from, normal, c.margin_m - height, c.friction);
    }
  }
  void all(Vector& at, const Vector& from, const Scene& s, const FrameMotion* end) {
    using Shape = Collider::Shape;
    const auto each = [&](Shape shape, bool moves, auto fn) {
      for (std::size_t k = 0; k < s.colliders.size(); ++k)
        if (s.colliders[k].shape == shape && s.colliders[k].moves() == moves) fn(s.colliders[k], k);
    };
    each(Shape::Sphere, false, [&](const Collider& c, std::size_t) {
      ball(at, from, vector(c.center_m), c.radius_m + c.margin_m, c.friction);
    });
    each(Shape::Box, false, [&](const Collider& c, std::size_t) { box(at, from, c); });
    each(Shape::Mesh, false, [&](const Collider& c, std::size_t) { mesh(at, from, c, c.mesh->positions, mesh_depth); });
    each(Shape::Mesh, true, [&](const Collider& c, std::size_t k) {
      mesh(at, from, c, posed_positions(*c.mesh, end->colliders[k]), hand_depth);
    });
    each(Shape::Capsules, true, [&](const Collider& c, std::size_t k) {
      for (const Capsule& one : end->colliders[k].capsules) capsule(at, from, one, c);
    });
  }
};

/// A sheet that flies through the colliders' positions in its first frame.
Scene flying(int columns, int rows) {
  Scene s = sheet(columns, rows);
  s.cloth.initial_velocity_m_per_s = {0.7, -0.9, 0.4};
  return s;
}

class PaperContacts : public Gpu {
 protected:
  /// Runs one frame; returns the number of contacts.
  long expect_as_in_double(const Scene& s, const std::string& what,
                           const nlohmann::json& settings = nlohmann::json::object()) {
    const auto solver = make("paper", settings);
    solver->load(s);
    const ClothState state = after(*solver, s, 1);
    const std::vector<double> x = initial_positions(s);
    const double h = s.time.dt();
    Contact contact;
    contact.slows = settings.value("friction_on", "") == "velocity";
    const bool previous = settings.value("projection", "") == "previous";
    for (std::size_t i = 0; i < s.cloth.vertex_count(); ++i) {
      const Vector from = Vector::Map(&x[3 * i]);
      const bool pinned = std::count(s.pins.vertices.begin(), s.pins.vertices.end(), i) != 0;
      Vector at = pinned
                      ? from
                      : Vector(from + h * (vector(s.cloth.initial_velocity_m_per_s) + h * vector(s.gravity_m_per_s2)));
      Vector tested = previous ? from : at;
      contact.removed.setZero();
      if (!pinned) contact.all(tested, from, s, s.motion_after(0));
      at = previous ? Vector(at + tested - from) : tested;
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(state.position[3 * i + static_cast<std::size_t>(k)], at[k], 2e-6) << what << " vertex " << i;
        EXPECT_NEAR(state.velocity[3 * i + static_cast<std::size_t>(k)], (at - from - contact.removed)[k] / h, 2e-6 / h)
            << what;
      }
    }
    return contact.touched;
  }
};

TEST_F(PaperContacts, AgreeWithDoublePrecisionKindByKind) {
  const auto kinds = [](double friction) {
    return std::vector<std::pair<const char*, Collider>>{
        {"sphere", sphere({-0.11, -0.05, 0.07}, 0.3, friction)},
        {"box", box({0.13, 0.03, -0.09}, {0.3, 0.08, 0.21}, friction)},
        {"capsules", capsules({0.05, 0.017, -0.1}, friction)},
        {"open sheet", open_sheet({0.03, -0.006, 0.01}, 0.323, friction)},
        {"closed mesh", octahedron({0.013, 0.007, 0.021}, 0.16, false, friction)},
        {"hand", octahedron({-0.023, 0.009, 0.034}, 0.171, true, friction)}};
  };
  for (const auto& [columns, rows] : {std::pair{7, 5}, {33, 17}, {64, 64}})
    for (double friction : {0.0, kContactFriction, 1.7})
      for (const auto& [name, collider] : kinds(friction)) {
        Scene s = moving(with_collider(flying(columns, rows), collider));
        if (collider.shape == Collider::Shape::Mesh) s = doubled(s);
        EXPECT_GT(expect_as_in_double(s, name), columns * rows / 50) << name << ": nothing was touched";
      }
}

TEST_F(PaperContacts, AgreeWithDoublePrecisionInEveryReadingOfTheText) {
  const nlohmann::json previous = {{"projection", "previous"}}, velocity = {{"friction_on", "velocity"}};
  const Collider ball = sphere({-0.11, -0.05, 0.07}, 0.3, kContactFriction),
                 mesh = octahedron({0.013, 0.007, 0.021}, 0.16, false, kContactFriction);
  for (const Scene& s : {moving(with_collider(flying(33, 17), ball)), doubled(with_collider(flying(33, 17), mesh))})
    for (const nlohmann::json& settings : {previous, velocity})
      EXPECT_GT(expect_as_in_double(s, settings.dump(), settings), 10);
}

TEST_F(PaperContacts, OtherReadingsMoveTheClothElsewhere) {
  const Scene s = with_collider(doubled(with_damping(sheet(9, 9, 0.2, 0.2))),
                                open_sheet({0.003, -0.05, 0.004}, 0.4, kContactFriction));
  const auto end = [&](const nlohmann::json& settings) {
    const auto solver = make("paper", settings);
    solver->load(s);
    return after(*solver, s, 20).position;
  };
  const auto standard = end({});
  EXPECT_EQ(end({{"relaxation", 1.0}, {"collisions", "after"}, {"second_layer", "same"}}), standard);
  for (const nlohmann::json& settings :
       {nlohmann::json{{"relaxation", 1.4}}, {{"collisions", "inside"}}, {{"second_layer", "opposite"}}})
    EXPECT_NE(end(settings), standard) << settings;
}

TEST_F(PaperContacts, AFallenSheetStaysOnAMesh) {
  // 0.3 m of fall give 2.4 m/s, and 34 mm per frame at 72 Hz.
  Scene s = with_collider(doubled(with_damping(sheet(9, 9, 0.2, 0.2))),
                          open_sheet({0.003, -0.3, 0.004}, 0.4, kContactFriction));
  const auto solver = make("paper"), thin = make("paper", {{"mesh_depth_m", 0.001}});
  solver->load(s);
  thin->load(s);
  const ClothState caught = after(*solver, s, 72), lost = after(*thin, s, 72);
  for (std::size_t i = 0; i < s.cloth.vertex_count(); ++i) {
    EXPECT_NEAR(caught.position[3 * i + 1], -0.28, 0.02);
    EXPECT_LT(lost.position[3 * i + 1], -1) << "a vertex that passes the depth in one frame falls through";
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
