#include "contact_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "metrics/contact/contact_probe.hpp"
#include "metrics/motion_check/motion_check.hpp"

namespace clothbench::pbd_gpu {
namespace {

using contact::ContactProbe;

/// Boxes and planes have no probe; their depth is a formula. Spheres are capsules without length.
double depth_in(const Collider& c, const double* x) {
  double deepest = -std::numeric_limits<double>::infinity();
  if (c.shape == Collider::Shape::Plane) {
    deepest = 0;
    for (std::size_t k = 0; k < 3; ++k) deepest += c.normal[k] * (x[k] - c.center_m[k]);
  } else {
    for (const Vec3& axis : c.axes) {
      double along = 0;
      for (std::size_t k = 0; k < 3; ++k) along += axis[k] * (x[k] - c.center_m[k]);
      deepest = std::max(deepest, std::abs(along) - c.half_extent_m[static_cast<std::size_t>(&axis - c.axes.data())]);
    }
  }
  return std::max(0.0, -deepest);
}

std::vector<contact::Capsule> shapes(const Collider& c, const FrameMotion* motion, std::size_t index) {
  std::vector<contact::Capsule> all;
  const auto point = [](const Vec3& p) { return contact::Point<3>(p[0], p[1], p[2]); };
  if (c.shape == Collider::Shape::Sphere) all.push_back({point(c.center_m), point(c.center_m), c.radius_m});
  if (c.shape == Collider::Shape::Capsules)
    for (const Capsule& s : motion->colliders.at(index).capsules)
      all.push_back({point(s.a_m), point(s.b_m), s.radius_m});
  return all;
}

double largest_stretch(const Scene& scene, const ClothState& s) {
  double most = 0;
  for (const Edge& e : edges(scene.cloth, EdgeKind::Structural)) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = s.position[3 * e.b + k] - s.position[3 * e.a + k];
      squared += d * d;
    }
    most = std::max(most, std::sqrt(squared) / e.rest_m - 1);
  }
  return most;
}

class Watch {
 public:
  explicit Watch(const Scene& scene) : scene_(scene), triangles_(triangles(scene.cloth)) {
    const std::vector<double> rest = initial_positions(scene);
    const contact::TriangleMeshView cloth{rest, triangles_};
    for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
      const Collider& c = scene.colliders[k];
      const FrameMotion* start = scene.motion.empty() ? nullptr : &scene.motion.front();
      std::optional<ContactProbe>& probe = probes_.emplace_back();
      if (c.shape == Collider::Shape::Mesh) {
        const std::vector<double> at =
            posed_positions(*c.mesh, start != nullptr ? start->colliders.at(k) : ColliderPose{});
        probe.emplace(cloth, contact::TriangleMeshView{at, c.mesh->triangles});
      } else if (c.shape == Collider::Shape::Sphere || c.shape == Collider::Shape::Capsules) {
        probe.emplace(cloth, shapes(c, start, k));
      }
    }
  }

  void look(const ClothState& s, const FrameMotion* motion, bool settled, ContactRun& run) {
    for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
      const Collider& c = scene_.colliders[k];
      if (!probes_[k]) {
        for (std::size_t i = 0; i < s.position.size(); i += 3)
          run.depth_m = std::max(run.depth_m, depth_in(c, &s.position[i]));
        continue;
      }
      if (c.shape == Collider::Shape::Capsules) probes_[k]->move_shapes(shapes(c, motion, k));
      if (c.shape == Collider::Shape::Mesh && c.moves())
        probes_[k]->move_object(posed_positions(*c.mesh, motion->colliders.at(k)));
      const contact::ContactSample sample = probes_[k]->probe(s.position);
      run.contour_m = std::max(run.contour_m, sample.contour_length_m);
      if (settled) run.settled_contour_m = std::max(run.settled_contour_m, sample.contour_length_m);
      if (probes_[k]->has_inside()) run.depth_m = std::max(run.depth_m, sample.depth_max_m);
    }
  }

 private:
  const Scene& scene_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::optional<ContactProbe>> probes_;
};

}  // namespace

ContactRun run_contact(ClothSolver& solver, const Scene& scene, int frames) {
  if (frames == 0) frames = scene.time.frames();
  ContactRun run;
  Watch watch(scene);
  const double dt = scene.time.dt();
  ClothState before;
  std::vector<double> time_s = {0};
  std::vector<float> position;
  for (const double x : initial_positions(scene)) position.push_back(static_cast<float>(x));
  double wall_s = 0;
  for (int f = 0; f < frames; ++f) {
    const auto begin = std::chrono::steady_clock::now();
    if (solver.step({f, (f + 1) * dt, dt, scene.motion_after(f)}) != StepStatus::Ok) run.finite = false;
    wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    solver.read_state(run.end);
    for (double x : run.end.position) run.finite = run.finite && std::isfinite(x);
    if (!run.finite) return run;
    time_s.push_back(scene.time.at(f + 1));
    for (const double x : run.end.position) position.push_back(static_cast<float>(x));
    const bool settled = (frames - f) * dt <= 0.5;
    watch.look(run.end, scene.motion_after(f), settled, run);
    run.stretch = std::max(run.stretch, largest_stretch(scene, run.end));
    if (settled && before.position.empty()) before = run.end;
  }
  for (const motion_check::Finding& found :
       motion_check::verify(scene, {time_s, position}, solver.plan().contact_margins_m))
    if (std::string_view(found.statistic->name) == "crossing")
      run.crossings = motion_check::kCrossingTolerance * found.ratio;
  run.step_s = wall_s / frames;
  run.stretch_end = largest_stretch(scene, run.end);
  const std::vector<double> mass = vertex_masses(scene);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    double squared = 0, moved = 0;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
      squared += run.end.velocity[k] * run.end.velocity[k];
      moved += std::pow(run.end.position[k] - before.position[k], 2);
    }
    run.kinetic_end_J += mass[i] * squared / 2;
    run.drift_end_m_per_s = std::max(run.drift_end_m_per_s, std::sqrt(moved) / 0.5);
  }
  return run;
}

}  // namespace clothbench::pbd_gpu
