// The faults, one per row. It is an error if a kernel no longer contains the text to replace; then adapt the row.
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "trial.hpp"

namespace clothbench {
namespace {

/// Applies the same change to all colliders of some shape.
template <class Change>
std::function<void(Scene&)> colliders(Change change) {
  return [change](Scene& s) {
    for (Collider& c : s.colliders) change(c);
  };
}

template <class Change>
std::function<void(Scene&)> mesh(Change change) {
  return colliders([change](Collider& c) {
    auto other = std::make_shared<ColliderMesh>(*c.mesh);
    change(*other);
    c.mesh = other;
  });
}

void without_every_100th(ColliderMesh& m) {
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (t % 100 != 50) kept.push_back(m.triangles[t]);
  m.triangles = kept;
}

std::function<void(AccuracyPass&)> series(const std::string& name, std::function<void(std::vector<double>&)> change) {
  return [=](AccuracyPass& pass) {
    for (MetricSeries& m : pass.metrics)
      if (m.name == name) change(m.values);
  };
}

void a_frame_late(std::vector<double>& v) {
  std::rotate(v.rbegin(), v.rbegin() + 1, v.rend());
  v[0] = 0;
}

/// A fault that sets only this member of Fault.
template <class Place>
Fault in(Place Fault::*place, const char* name, const char* stage, std::type_identity_t<Place> what) {
  Fault f{name, stage};
  f.*place = std::move(what);
  return f;
}

Fault kernel(const char* name, const char* stage, const char* file, const char* is, const char* is_to_be) {
  return in(&Fault::shader, name, stage, ShaderFault{file, is, is_to_be});
}

}  // namespace

std::vector<Fault> faults() {
  return {
      kernel("one colour of lines skipped", "pulled", "xpbd/lines/line_frame.comp", "colour = colours - 1u - turn;",
             "colour = max(colours - 1u - turn, 1u);"),
      kernel("border with the inner stretch compliance", "heavy", "xpbd/lines/grid_lines.glsl",
             "chain + 1u == chain_count()) ? 2.0 : 1.0;", "chain + 1u == chain_count()) ? 1.0 : 1.0;"),
      kernel("bending with the wrong sign", "cantilever", "xpbd/lines/grid_lines.glsl",
             "w[k] * (last - 2.0 * lambda[k] + next)", "w[k] * (2.0 * lambda[k] - last - next)"),
      kernel("damping halved in the kernel", "fall", "xpbd/time/substep.glsl",
             "gain -= p.damping_fraction * (velocity + change);",
             "gain -= 0.5 * p.damping_fraction * (velocity + change);"),
      kernel("gravity 1 % weak in the kernel", "fall", "xpbd/time/substep.glsl", "vec3 gain = p.gravity_h.xyz,",
             "vec3 gain = 0.99 * p.gravity_h.xyz,"),
      kernel("grips forgotten by the kernel", "pulled", "xpbd/lines/line_frame.comp", "if (GRIPS > 0u) move_held(s);",
             "if (GRIPS > 999999u) move_held(s);"),
      // A fault in every phase of contact. In "struck", planes keep the cloth out even if responses are wrong; in
      // "wrapped", only responses determine a rope's friction on a drum.
      kernel("points of shapes do not move within the frame", "struck",
             "xpbd/contact/broad_phase/contact_update_shapes.comp", "ShapePoint(c.b0, c.b1)", "ShapePoint(c.b0, c.b0)"),
      kernel("a hundredth of the motion bound", "struck", "xpbd/contact/displacement_filter/contact_motion_bounds.glsl",
             "motion_bounds[i] = vec4(at.xyz, bound);", "motion_bounds[i] = vec4(at.xyz, 0.01 * bound);"),
      kernel("one pair in three not listed", "struck", "xpbd/contact/broad_phase/contact_broad_phase.glsl", "return n;",
             "return n - n / 3u;"),
      kernel("half of each primitive's pairs lost", "struck", "xpbd/contact/contact.comp",
             "ranges[k] = uvec4(at, room, 0u, 0u);", "ranges[k] = uvec4(at, room / 2u, 0u, 0u);"),
      kernel("wrong start of the substep", "struck", "xpbd/contact/displacement_filter/contact_vertex_step.glsl",
             "at.xyz += p.h * (vel ", "at.xyz += -9.0 * p.h * (vel "),
      kernel("no friction on half-spaces", "ramp", "xpbd/contact/response/contact_accumulate.glsl",
             "at.xyz - start, s.friction)", "at.xyz - start, 0.0)"),
      kernel("normal of the nearest points flipped", "struck", "xpbd/contact/narrow_phase/contact_nearest_points.glsl",
             "s.normal = vec4(r.n, gap);", "s.normal = vec4(-r.n, gap);"),
      kernel("friction along the slip", "wrapped", "xpbd/contact/response/friction.glsl", "by -= min(1.0, friction",
             "by += min(1.0, friction"),
      kernel("struck vertices fixed in the line solve", "struck", "xpbd/contact/response/contact_accumulate.glsl",
             "at.w / (1.0 + held)", "0.0"),
      kernel("a hull that misses a corner", "struck", "xpbd/contact/narrow_phase/contact_distance.glsl",
             "uint first = 0u; first < shape.count;", "uint first = 1u; first < shape.count;"),
      kernel("planes a millimetre inside the shape", "struck",
             "xpbd/contact/displacement_filter/contact_select_plane.glsl", "dot(n, around) + smallest);",
             "dot(n, around) + smallest - 1e-3);"),
      kernel("planes forgotten", "struck", "xpbd/contact/displacement_filter/contact_project.glsl",
             "if (proposed.w > 0.0 && !(smallest >= 0.0)) at = project_to_feasible(at, from.w);", ""),
      // Faults in self-contact.
      kernel("boxes of a tenth of the size", "heaped", "xpbd/contact/broad_phase/self_aabb.glsl",
             "return b.low_0.xyz +", "return 0.9 * b.high_0.xyz + 0.1 * b.low_0.xyz +"),
      kernel("triangles whose numbers differ by few not paired", "heaped",
             "xpbd/contact/broad_phase/self_broad_phase.glsl", "if (a[c] == b.x ",
             "if (abs(int(a[c]) - int(b.x)) < 60 "),
      kernel("half of each triangle's pairs lost", "heaped", "xpbd/contact/narrow_phase/self_active_pairs.glsl",
             "end = range.x + range.y;", "end = range.x + range.y / 2u;"),
      kernel("contacts pushed a centimetre too far", "heaped", "xpbd/contact/response/self_correction.glsl",
             "s.normal.w - dot(n, apart)", "s.normal.w + 0.01 - dot(n, apart)"),
      kernel("normal of the nearest points flipped", "heaped", "xpbd/contact/narrow_phase/self_nearest_points.glsl",
             "self_active[k].plane = normal;", "self_active[k].plane = vec4(-normal.xyz, normal.w);"),
      kernel("planes of the second triangle on its wrong side", "heaped",
             "xpbd/contact/displacement_filter/self_select_plane.glsl", "vec4(-n, half_m - offset)",
             "vec4(-n, half_m - offset - 0.01)"),
      kernel("planes of the cloth with itself forgotten", "heaped",
             "xpbd/contact/displacement_filter/contact_project.glsl", "if (!has_plane[m]) continue;",
             "if (true) continue;"),
      in(&Fault::scene, "gravity 9.7", "swing",
         [](Scene& s) {
           s.gravity_m_per_s2 = {0, -9.7, 0};
         }),
      in(&Fault::scene, "friction skipped", "slope", colliders([](Collider& c) { c.friction = 0; })),
      in(&Fault::scene, "every 100th triangle ignored", "tiles", mesh(without_every_100th)),
      in(&Fault::scene, "bending a fifth too soft", "cantilever",
         [](Scene& s) { s.material.bending_rigidity_N_m *= 0.8; }),
      in(&Fault::scene, "one pin lost", "swing", [](Scene& s) { s.pins.vertices.pop_back(); }),
      in(&Fault::scene, "one vertex ten times as heavy", "heavy",
         [](Scene& s) {
           s.cloth.mass_factors.assign(s.cloth.vertex_count(), 1);
           s.cloth.mass_factors[s.cloth.vertex_count() / 2] = 10;
         }),
      in(&Fault::scene, "collider 1 cm elsewhere", "ball", colliders([](Collider& c) { c.center_m[1] -= 0.01; })),
      in(&Fault::scene, "one grip never held", "pulled",
         [](Scene& s) {
           for (FrameMotion& m : s.motion) m.grip_held.back() = 0;
         }),
      in(&Fault::input, "collider a frame late", "pushed",
         [](const Scene& s, FrameInput& i) { i.motion = s.motion_after(i.index - 1); }),
      in(&Fault::input, "frames 1 % too long", "swing", [](const Scene&, FrameInput& i) { i.dt_s *= 1.01; }),
      in(&Fault::state, "NaN in one vertex at frame 50", "fall",
         [](int frame, ClothState& s) {
           if (frame == 50) s.position[30] = std::numeric_limits<double>::quiet_NaN();
         }),
      in(&Fault::state, "one vertex stays where it was", "swing",
         [first = std::vector<double>()](int frame, ClothState& s) mutable {
           if (frame == 0) first = s.position;
           std::copy_n(first.begin() + 300, 3, s.position.begin() + 300);
         }),
      in(&Fault::state, "state read a frame late", "swing",
         [before = ClothState()](int, ClothState& s) mutable {
           std::swap(before, s);
           if (s.position.empty()) s = before;
         }),
      in(&Fault::state, "positions in whole millimetres", "fall",
         [](int, ClothState& s) {
           for (double& x : s.position) x = std::round(x * 1e3) / 1e3;
         }),
      in(&Fault::state, "velocities not written", "undamped",
         [](int, ClothState& s) { std::fill(s.velocity.begin(), s.velocity.end(), 0.0); }),
      in(&Fault::status, "gives up at frame 10", "fall",
         [](int frame) { return frame == 10 ? StepStatus::Diverged : StepStatus::Ok; }),
      in(&Fault::plan, "a kernel that the scene does not need", "fall",
         [](Plan& p) {
           p.stages.push_back({"mesh contact", {Feature::StaticMesh}, 1, 0, 0});
         }),
      in(&Fault::plan, "every dispatch recorded twice", "fall",
         [](Plan& p) {
           for (StagePlan& s : p.stages) s.dispatches *= 2;
         }),
      in(&Fault::plan, "a feature of the scene left out", "ball",
         [](Plan& p) {
           for (StagePlan& s : p.stages) s.serves = s.serves - FeatureSet{Feature::Friction};
         }),
      in(&Fault::settings, "a quarter of the substeps", "swing",
         [](nlohmann::json& s) { s["substeps"] = std::max(1, s["substeps"].get<int>() / 4); }),
      in(&Fault::metrics, "a stale metric: contour of the frame before", "pressed",
         series("contact_length_m", a_frame_late)),
      in(&Fault::metrics, "depth not measured", "rising",
         series("depth_m", [](std::vector<double>& v) { std::fill(v.begin(), v.end(), 0.0); })),
      in(&Fault::metrics, "self-contact of the frame before", "crossed", series("self_contact_length_m", a_frame_late)),
      in(&Fault::metric_scene, "metric sees the collider a frame late", "rising",
         [](Scene& s) {
           s.motion.insert(s.motion.begin(), s.motion.front());
           s.motion.pop_back();
         }),
      in(&Fault::record, "a trial repeated", "fall", [](RunRecord& r) { r.trials[1] = r.trials[0]; }),
      in(&Fault::record, "another scene under the same name", "fall",
         [](RunRecord& r) { r.header.scenario_sha256[3] ^= 1; }),
      in(&Fault::record, "a value lost on the way to the file", "swing",
         [](RunRecord& r) { r.summary.erase("stretch_max"); }),
      in(&Fault::record, "a failed expectation not reported", "ball",
         [](RunRecord& r) { r.summary["expect.depth_max_m"] = kMissing; }),
  };
}

}  // namespace clothbench
