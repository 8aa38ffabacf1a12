// The faults, one a row. A kernel's text that is no longer there is an error: plant the fault where it is now.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "trial.hpp"

namespace clothbench {
namespace {

/// Texts of all colliders' shapes changed alike.
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

void add_kernels(std::vector<Fault>& f) {
  const auto kernel = [&](const char* name, const char* stage, const char* file, const char* is, const char* is_to_be) {
    Fault fault{name, stage};
    fault.shader = ShaderFault{file, is, is_to_be};
    f.push_back(std::move(fault));
  };
  kernel("one family of lines skipped", "pulled", "xpbd/lines/line_frame.comp", "colour = colours - 1u - turn;",
         "colour = max(colours - 1u - turn, 1u);");
  kernel("last link of every chain missing", "swing", "xpbd/lines/grid_lines.glsl",
         "if (!on_chain(i + 1u)) return false;", "if (!on_chain(i + 2u)) return false;");
  kernel("velocity not corrected with the position", "swing", "xpbd/lines/grid_lines.glsl", "vel[k] += step * p.per_h;",
         "vel[k] += 0.9 * step * p.per_h;");
  kernel("stretch compliance of the border as inside", "heavy", "xpbd/lines/grid_lines.glsl",
         "chain + 1u == chain_count()) ? 2.0 : 1.0;", "chain + 1u == chain_count()) ? 1.0 : 1.0;");
  kernel("bending with the wrong sign", "cantilever", "xpbd/lines/grid_lines.glsl",
         "w[k] * (last - 2.0 * lambda[k] + next)", "w[k] * (2.0 * lambda[k] - last - next)");
  kernel("clamp a cell too soft", "cantilever", "xpbd/lines/grid_lines.glsl", "? 0.5 * alpha : alpha;",
         "? 2.0 * alpha : alpha;");
  kernel("damping halved in the kernel", "fall", "xpbd/time/substep.glsl",
         "gain -= p.damping_fraction * (velocity + change);",
         "gain -= 0.5 * p.damping_fraction * (velocity + change);");
  kernel("gravity 1 % weak in the kernel", "fall", "xpbd/time/substep.glsl", "vec3 gain = p.gravity_h.xyz,",
         "vec3 gain = 0.99 * p.gravity_h.xyz,");
  kernel("grips forgotten by the kernel", "pulled", "xpbd/lines/line_frame.comp", "if (GRIPS > 0u) move_held(s);",
         "if (GRIPS > 999999u) move_held(s);");
}

/// A fault in every phase of contact. Where planes hold ("struck") responses may be wrong and nothing is
/// passed; what a rope's friction on a drum is ("wrapped") they alone decide.
void add_planes(std::vector<Fault>& f) {
  const auto kernel = [&](const char* name, const char* stage, const char* file, const char* is, const char* is_to_be) {
    Fault fault{name, stage};
    fault.shader = ShaderFault{file, is, is_to_be};
    f.push_back(std::move(fault));
  };
  kernel("points of pieces stand still within the frame", "struck",
         "xpbd/contact/broad_phase/contact_update_shapes.comp", "ShapePoint(c.b0, c.b1)", "ShapePoint(c.b0, c.b0)");
  kernel("a tenth of the reach", "struck", "xpbd/contact/displacement_filter/contact_motion_bounds.glsl",
         "STORE16(motion_bounds, i, vec4(at.xyz, bound));", "STORE16(motion_bounds, i, vec4(at.xyz, 0.1 * bound));");
  kernel("one pair in three not listed", "struck", "xpbd/contact/broad_phase/contact_broad_phase.glsl", "return n;",
         "return n - n / 3u;");
  kernel("half of each element's pairs not found again", "struck", "xpbd/contact/broad_phase/prefix_sum.comp",
         "min(count, room), 0u", "min(count, room) / 2u, 0u");
  kernel("start of the substep not what it was", "struck", "xpbd/contact/displacement_filter/contact_vertex_step.glsl",
         "at.xyz += p.h * (vel ", "at.xyz += -9.0 * p.h * (vel ");
  kernel("bounds of distances do not lose the ways", "struck", "xpbd/contact/narrow_phase/contact_active_pairs.glsl",
         "bound -= max_of(e, true) + shape_displacement(pair.y);", "bound -= 0.0;");
  kernel("approach to a half-space kept in the velocity", "ramp", "xpbd/contact/response/contact_accumulate.glsl",
         "propose(c.velocity_part, c.depenetration * s.normal.xyz);",
         "propose(vec3(0.0), c.velocity_part + c.depenetration * s.normal.xyz);");
  kernel("no friction on half-spaces", "ramp", "xpbd/contact/response/contact_accumulate.glsl",
         "at.xyz - start, s.friction)", "at.xyz - start, 0.0)");
  kernel("whatever is apart taken for far", "struck", "xpbd/contact/narrow_phase/contact_active_pairs.glsl",
         "gap > approach_of(e, pair.y)", "gap > 0.0");
  kernel("normal of the nearest points flipped", "struck", "xpbd/contact/narrow_phase/contact_nearest_points.glsl",
         "s.normal = vec4(r.n, gap);", "s.normal = vec4(-r.n, gap);");
  kernel("friction along the slip", "wrapped", "xpbd/contact/response/friction.glsl", "by -= min(1.0, friction",
         "by += min(1.0, friction");
  kernel("friction half as great", "wrapped", "xpbd/contact/response/friction.glsl", "by -= min(1.0, friction",
         "by -= min(1.0, 0.5 * friction");
  kernel("responses taken from the velocity, not given to it", "wrapped",
         "xpbd/contact/response/contact_accumulate.glsl", "sum_velocity_part += l * velocity_part;",
         "sum_velocity_part -= l * velocity_part;");
  kernel("no responses of vertices", "wrapped", "xpbd/contact/response/contact_accumulate.glsl",
         "if (any_pairs) from_pairs(TRIANGLES + i, 0u, at.w);", "");
  kernel("what was struck fixed in the lines", "struck", "xpbd/contact/response/contact_accumulate.glsl",
         "at.w / (1.0 + held)", "0.0");
  kernel("a hull that misses a corner", "struck", "xpbd/contact/narrow_phase/contact_distance.glsl",
         "uint first = 0u; first < shape.count;", "uint first = 1u; first < shape.count;");
  kernel("planes a millimetre inside the piece", "struck", "xpbd/contact/displacement_filter/contact_select_plane.glsl",
         "dot(n, around) + smallest);", "dot(n, around) + smallest - 1e-3);");
  kernel("planes forgotten", "struck", "xpbd/contact/displacement_filter/contact_project.glsl",
         "if (proposed.w > 0.0 && !(smallest >= 0.0)) at = project_to_feasible(at, from.w);", "");
  kernel("planes of one lane's triangles alone", "struck", "xpbd/contact/displacement_filter/contact_project.glsl",
         "smallest = cluster_min(smallest);", "");
  kernel("near pairs without their bit", "struck", "xpbd/contact/narrow_phase/contact_active_pairs.glsl",
         "atomicOr(active_bits[ACTIVE_BITS + k / 32u], 1u << k % 32u);", "");
  kernel("what a contact pushes not marked", "wrapped", "xpbd/contact/response/contact_correction.glsl",
         "touched[CORRECTED(e[min(c, e.w - 1u)])] = 1u;", ";");
  kernel("what is behind a plane not marked", "struck", "xpbd/contact/displacement_filter/contact_select_plane.glsl",
         "touched[NEEDS_PROJECTION(e[c])] = 1u;", ";");
  kernel("projected onto all planes but those of the last triangle", "struck",
         "xpbd/contact/displacement_filter/contact_project.glsl", "first_vertex_triangle; f < end_vertex_triangle;",
         "first_vertex_triangle; f + 1u < end_vertex_triangle;");
}

/// The same of the cloth's contact with itself.
void add_self_planes(std::vector<Fault>& f) {
  const auto kernel = [&](const char* name, const char* file, const char* is, const char* is_to_be) {
    Fault fault{name, "heaped"};
    fault.shader = ShaderFault{file, is, is_to_be};
    f.push_back(std::move(fault));
  };
  kernel("boxes of a tenth of the size", "xpbd/contact/broad_phase/self_aabb.glsl", "return b.low_0.xyz +",
         "return 0.9 * b.high_0.xyz + 0.1 * b.low_0.xyz +");
  kernel("triangles whose numbers differ by few not paired", "xpbd/contact/broad_phase/self_broad_phase.comp",
         "if (a[c] == b.x ", "if (abs(int(a[c]) - int(b.x)) < 60 ");
  kernel("half of each triangle's pairs lost", "xpbd/contact/narrow_phase/self_active_pairs.comp",
         "end = range.x + range.y;", "end = range.x + range.y / 2u;");
  kernel("bounds of distances grow", "xpbd/contact/narrow_phase/self_active_pairs.comp",
         "pair[n].bound - own.x - displacement[n].x;", "pair[n].bound + 10.0 * (own.x + displacement[n].x);");
  kernel("contacts pushed a centimetre too far", "xpbd/contact/response/self_correction.glsl",
         "s.normal.w - dot(n, apart)", "s.normal.w + 0.01 - dot(n, apart)");
  kernel("normal of the nearest points flipped", "xpbd/contact/narrow_phase/self_nearest_points.comp",
         "self_active[k].plane = normal;", "self_active[k].plane = vec4(-normal.xyz, normal.w);");
  kernel("planes of the second triangle on its wrong side", "xpbd/contact/displacement_filter/self_select_plane.comp",
         "vec4(-n, half_m - offset)", "vec4(-n, half_m - offset - 0.01)");
  kernel("planes of the cloth with itself forgotten", "xpbd/contact/displacement_filter/contact_project.glsl",
         "if (!has_plane[m]) continue;", "if (true) continue;");
  kernel("projected onto the cloth's planes of all but three triangles",
         "xpbd/contact/displacement_filter/contact_project.glsl", "SELF != 0u && f < end_vertex_triangle;",
         "SELF != 0u && f + 3u < end_vertex_triangle;");
}

void add_inputs(std::vector<Fault>& f) {
  const auto scene = [&](const char* name, const char* stage, std::function<void(Scene&)> change) {
    Fault fault{name, stage};
    fault.scene = std::move(change);
    f.push_back(std::move(fault));
  };
  const auto input = [&](const char* name, const char* stage, std::function<void(const Scene&, FrameInput&)> change) {
    Fault fault{name, stage};
    fault.input = std::move(change);
    f.push_back(std::move(fault));
  };
  scene("gravity 9.7", "swing", [](Scene& s) { s.gravity_m_per_s2 = {0, -9.7, 0}; });
  scene("friction skipped", "slope", colliders([](Collider& c) { c.friction = 0; }));
  scene("friction a tenth too great", "slope", colliders([](Collider& c) { c.friction *= 1.1; }));
  scene("every 100th triangle ignored", "tiles", mesh(without_every_100th));
  scene("stiffness doubled", "heavy", [](Scene& s) { *s.material.membrane_stiffness_N_per_m *= 2; });
  scene("bending a fifth too soft", "cantilever", [](Scene& s) { s.material.bending_rigidity_N_m *= 0.8; });
  scene("damping left out", "fall", [](Scene& s) { s.material.damping_per_s = 0; });
  scene("one pin lost", "swing", [](Scene& s) { s.pins.vertices.pop_back(); });
  scene("one vertex ten times as heavy", "heavy", [](Scene& s) {
    s.cloth.mass_factors.assign(s.cloth.vertex_count(), 1);
    s.cloth.mass_factors[s.cloth.vertex_count() / 2] = 10;
  });
  scene("collider 1 cm elsewhere", "ball", colliders([](Collider& c) { c.center_m[1] -= 0.01; }));
  scene("one grip never held", "pulled", [](Scene& s) {
    for (FrameMotion& m : s.motion) m.grip_held.back() = 0;
  });
  input("collider a frame late", "pushed",
        [](const Scene& s, FrameInput& i) { i.motion = s.motion_after(i.index - 1); });
  input("collider stands still", "pushed", [](const Scene& s, FrameInput& i) { i.motion = &s.motion.front(); });
  input("frames 1 % too long", "swing", [](const Scene&, FrameInput& i) { i.dt_s *= 1.01; });
}

void add_outputs(std::vector<Fault>& f) {
  const auto state = [&](const char* name, const char* stage, std::function<void(int, ClothState&)> change) {
    Fault fault{name, stage};
    fault.state = std::move(change);
    f.push_back(std::move(fault));
  };
  state("NaN in one vertex at frame 50", "fall", [](int frame, ClothState& s) {
    if (frame == 50) s.position[30] = std::numeric_limits<double>::quiet_NaN();
  });
  state("one vertex stays where it was", "swing", [first = std::vector<double>()](int frame, ClothState& s) mutable {
    if (frame == 0) first = s.position;
    std::copy_n(first.begin() + 300, 3, s.position.begin() + 300);
  });
  state("state read a frame late", "swing", [before = ClothState()](int, ClothState& s) mutable {
    std::swap(before, s);
    if (s.position.empty()) s = before;
  });
  state("two vertices swapped on reading", "swing", [](int, ClothState& s) {
    std::swap_ranges(s.position.begin() + 300, s.position.begin() + 303, s.position.begin() + 360);
  });
  state("positions in whole millimetres", "fall", [](int, ClothState& s) {
    for (double& x : s.position) x = std::round(x * 1e3) / 1e3;
  });
  state("velocities not written", "swing",
        [](int, ClothState& s) { std::fill(s.velocity.begin(), s.velocity.end(), 0.0); });
  Fault gave_up{"gives up at frame 10", "fall"};
  gave_up.status = [](int frame) { return frame == 10 ? StepStatus::Diverged : StepStatus::Ok; };
  f.push_back(std::move(gave_up));
  Fault extra{"a kernel that the scene does not need", "fall"};
  extra.plan = [](Plan& p) { p.stages.push_back({"mesh contact", {Feature::StaticMesh}, 1, 0, 0}); };
  f.push_back(std::move(extra));
  Fault twice{"every dispatch recorded twice", "fall"};
  twice.plan = [](Plan& p) {
    for (StagePlan& s : p.stages) s.dispatches *= 2;
  };
  f.push_back(std::move(twice));
  Fault left_out{"a feature of the scene left out", "ball"};
  left_out.plan = [](Plan& p) {
    for (StagePlan& s : p.stages) s.serves = s.serves - FeatureSet{Feature::Friction};
  };
  f.push_back(std::move(left_out));
  Fault lazy{"a quarter of the substeps", "swing"};
  lazy.settings = [](nlohmann::json& s) { s["substeps"] = std::max(1, s["substeps"].get<int>() / 4); };
  f.push_back(std::move(lazy));
}

void add_metrics(std::vector<Fault>& f) {
  const auto metric = [&](const char* name, const char* stage, std::function<void(AccuracyPass&)> change) {
    Fault fault{name, stage};
    fault.metrics = std::move(change);
    f.push_back(std::move(fault));
  };
  const auto in_metrics = [&](const char* name, const char* stage, std::function<void(Scene&)> change) {
    Fault fault{name, stage};
    fault.metric_scene = std::move(change);
    f.push_back(std::move(fault));
  };
  metric("a stale metric: contour of the frame before", "pressed",
         series("contact_length_m", [](std::vector<double>& v) {
           std::rotate(v.rbegin(), v.rbegin() + 1, v.rend());
           v[0] = 0;
         }));
  metric("depth not measured", "rising",
         series("depth_m", [](std::vector<double>& v) { std::fill(v.begin(), v.end(), 0.0); }));
  metric("self-contact of the frame before", "crossed", series("self_contact_length_m", [](std::vector<double>& v) {
           std::rotate(v.rbegin(), v.rbegin() + 1, v.rend());
           v[0] = 0;
         }));
  in_metrics("metric sees the collider a frame late", "rising", [](Scene& s) {
    s.motion.insert(s.motion.begin(), s.motion.front());
    s.motion.pop_back();
  });
  in_metrics("metric takes the radius for the diameter", "pressed", colliders([](Collider& c) { c.radius_m /= 2; }));
}

void add_records(std::vector<Fault>& f) {
  const auto record = [&](const char* name, const char* stage, std::function<void(RunRecord&)> change) {
    Fault fault{name, stage};
    fault.record = std::move(change);
    f.push_back(std::move(fault));
  };
  record("a trial repeated", "fall", [](RunRecord& r) { r.trials[1] = r.trials[0]; });
  record("another scene under the same name", "fall", [](RunRecord& r) { r.header.scenario_sha256[3] ^= 1; });
  record("a value lost on the way to the file", "swing", [](RunRecord& r) { r.summary.erase("stretch_max"); });
  record("a failed expectation not reported", "ball", [](RunRecord& r) { r.summary["expect.depth_max_m"] = kMissing; });
}

}  // namespace

std::vector<Fault> faults() {
  std::vector<Fault> out;
  add_kernels(out);
  add_planes(out);
  add_self_planes(out);
  add_inputs(out);
  add_outputs(out);
  add_metrics(out);
  add_records(out);
  return out;
}

}  // namespace clothbench
