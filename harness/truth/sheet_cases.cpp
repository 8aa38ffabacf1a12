// Reference cases of sheets whose rows feel one another: the answer is a position for every vertex.
#include <memory>

#include "truth/case_strip.hpp"
#include "truth/pull_wave.hpp"
#include "truth/spring_sheet.hpp"

namespace clothbench::truth {
namespace {

using Frames = std::vector<std::vector<double>>;

/// Positions in every frame, computed when first asked for.
std::function<std::vector<double>(int)> sheet_motion(const Strip& s) {
  const auto frames = std::make_shared<Frames>();
  return [s, frames](int frame) {
    if (frames->empty()) {
      const Scene& scene = s.scene;
      const Cloth& c = scene.cloth;
      SpringSheet sheet{c.columns,
                        c.rows,
                        c.width_m,
                        c.height_m,
                        c.areal_density_kg_per_m2,
                        s.need_stiffness(),
                        scene.gravity_m_per_s2,
                        scene.pins.vertices};
      sheet.held.insert(sheet.held.end(), scene.grips.vertices.begin(), scene.grips.vertices.end());
      const std::vector<double> start = initial_positions(scene);
      const auto held = [&](std::size_t k, std::size_t f) {
        const std::size_t pins = scene.pins.vertices.size(), x = 3 * std::size_t{sheet.held[k]};
        if (k >= pins) return scene.motion.at(f).grip_position_m.at(k - pins);
        return Vec3{start[x], start[x + 1], start[x + 2]};
      };
      *frames = move_sheet(sheet, start, s.times_s(), held);
    }
    return frames->at(static_cast<std::size_t>(frame));
  };
}

/// The requirements and the answer that all sheets share.
ReferenceCase sheet_case(const Strip& s) {
  s.need((s.scene.needs & FeatureSet{Feature::UnevenGrid, Feature::Regions, Feature::Spin, Feature::ClothMesh}).empty(),
         "an even grid and no spin");
  s.need(s.scene.needs.has(Feature::Shear), "a material that shears");
  s.need((s.scene.needs & kColliderFeatures).empty() && !s.scene.needs.has(Feature::SelfCollision), "no collider");
  s.need_flat();
  s.need_rest();
  s.need_no_bending();
  s.need_damping(false);
  s.need_even_masses();
  s.need_stiffness();
  ReferenceCase known = s.reference_case();
  known.vertices = sheet_motion(s);
  known.columns = [s, vertices = known.vertices](int frame) { return column_means(s.scene.cloth, vertices(frame)); };
  return known;
}

}  // namespace

ReferenceCase swing_sheet(const Strip& s) {
  s.need_level();
  s.need_pins(s.edge("u0"), "edge u0 pinned and nothing else held");
  ReferenceCase known = sheet_case(s);
  const double horizon_s = 0.5 * std::sqrt(s.length_m * 9.81 / s.g);
  s.need(s.time_s(s.scene.time.frames()) <= horizon_s * (1 + 1e-9),
         "a duration of at most 0.5 s sqrt(L/1 m 9.81/g): then comes chaos");
  known.quantity_name = "distance of the free edge from the wall";
  known.quantity = [start = s.start, along = s.along](const Columns& c) { return dot(c.back() - start, along); };
  return known;
}

ReferenceCase pulled_sheet(const Strip& s) {
  s.need(s.g == 0, "no gravity");
  s.need(s.links >= 4, "5 columns or more");
  const TwoHandPull hands = bars_of(s);
  ReferenceCase known = sheet_case(s);
  known.speed_scale_m_per_s = hands.hand_speed_m_per_s;
  // Not the greatest strain: where the front of a wave is decides it, and its error has no clear order.
  known.quantity_name = "strain of the first quarter";
  known.quantity_scale = hands.hand_speed_m_per_s / wave_speed_m_per_s(hands);
  known.quantity = [quarter = static_cast<std::size_t>(s.links / 4), cell = s.length_m / s.links](const Columns& c) {
    return length(c[quarter] - c[0]) / (static_cast<double>(quarter) * cell) - 1;
  };
  return known;
}

}  // namespace clothbench::truth
