#include "scenario/material_patches.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kDensity_kg_per_m2 = 0.2;
constexpr double kStiffness_N_per_m = 1000;
constexpr double kHangGravity = 50;    // rho g L/Y = 1 % on 1 m
constexpr double kShearGravity = 150;  // slope rho g L/2G = 1 % on 0.25 m, G = 3/8 Y
constexpr double kBendGravity = 9.81;

json material(double y, double b, bool shear) {
  return {{"membrane_stiffness_N_per_m", y},
          {"bending_rigidity_N_m", b},
          {"damping_per_s", kPatchDamping_per_s},
          {"shear", shear}};
}

json scenario(Patch patch, json cloth, json of_material, json pins, json gravity) {
  cloth["areal_density_kg_per_m2"] = kDensity_kg_per_m2;
  cloth["sides"] = "single";
  return {{"name", std::string("patch-") + patch_name(patch)},
          {"why", "A patch test of the effective moduli: its shape at rest gives one modulus."},
          {"cloth", std::move(cloth)},
          {"material", std::move(of_material)},
          {"pins", std::move(pins)},
          {"gravity_m_per_s2", std::move(gravity)},
          {"time", {{"frame_rate_hz", 60}, {"duration_s", 3}}}};
}

/// 1 m x 0.25 m, 32 x 8 cells, hanging along u, or with u and v exchanged along v.
json hang(Patch patch, double y, bool along_v, bool shear) {
  const json down = {0, -1, 0}, across = {0, 0, 1};
  json cloth = {
      {"grid", along_v ? json{9, 33} : json{33, 9}},
      {"size_m", along_v ? json{0.25, 1.0} : json{1.0, 0.25}},
      {"pose", {{"center_m", {0, -0.5, 0}}, {"axis_u", along_v ? across : down}, {"axis_v", along_v ? down : across}}}};
  return scenario(patch, std::move(cloth), material(y, 0, shear), json::array({{{"edge", along_v ? "v0" : "u0"}}}),
                  {0, -kHangGravity, 0});
}

/// 0.25 m between the held edges, 2 m along them: the effect of the ends decays to e^-7 in the middle.
json shear() {
  json cloth = {{"grid", {9, 65}},
                {"size_m", {0.25, 2.0}},
                {"pose", {{"center_m", {0, 0, 0}}, {"axis_u", {0, 0, 1}}, {"axis_v", {0, -1, 0}}}}};
  return scenario(Patch::Shear, std::move(cloth), material(kStiffness_N_per_m, 0, true),
                  json::array({{{"edge", "u0"}}, {{"edge", "u1"}}}), {0, -kShearGravity, 0});
}

/// A free length of 0.2 m, 32 cells, after one clamped cell; 8 cells wide.
json bend(Patch patch, double stiffer, bool along_v) {
  constexpr double kCell = 0.2 / 32, kLength = 0.2, kGamma = 0.5, kStiff = 1e3;
  const double b = stiffer * kDensity_kg_per_m2 * kBendGravity * kLength * kLength * kLength / kGamma;
  const json out = {1, 0, 0}, across = {0, 0, 1};
  json cloth = {
      {"grid", along_v ? json{9, 34} : json{34, 9}},
      {"size_m", along_v ? json{8 * kCell, 33 * kCell} : json{33 * kCell, 8 * kCell}},
      {"pose",
       {{"center_m", {16.5 * kCell, 0, 0}}, {"axis_u", along_v ? across : out}, {"axis_v", along_v ? out : across}}}};
  return scenario(patch, std::move(cloth), material(kStiff, b, true), json::array({{{"clamp", along_v ? "v0" : "u0"}}}),
                  {0, -kBendGravity, 0});
}

/// Large and stiff, so that its deflection is a thousandth of the band's width, too little to stretch it.
json bend_diagonal() {
  constexpr int kSide = 25, kHalfBand = 3;
  constexpr double kSize = 3, kRigidity = 10;
  json held = json::array();
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i)
      if (std::abs(i - j) > kHalfBand) held.push_back(j * kSide + i);
  json cloth = {{"grid", {kSide, kSide}},
                {"size_m", {kSize, kSize}},
                {"pose", {{"center_m", {0, 0, 0}}, {"axis_u", {1, 0, 0}}, {"axis_v", {0, 0, 1}}}}};
  return scenario(Patch::BendDiagonal, std::move(cloth), material(kStiffness_N_per_m, kRigidity, true),
                  json::array({{{"vertices", held}}}), {0, -kBendGravity, 0});
}

/// HangU's sheet as triangles.
json hang_mesh(Patch patch, double turned_deg, int seed) {
  json cloth = {
      {"mesh",
       {{"drawn",
         {{"size_m", {1.0, 0.25}}, {"cells", 12}, {"turned_deg", turned_deg}, {"share", 0.3}, {"seed", seed}}}}},
      {"pose", {{"center_m", {0, -0.5, 0}}, {"axis_u", {0, -1, 0}}, {"axis_v", {0, 0, 1}}}}};
  return scenario(patch, std::move(cloth), material(kStiffness_N_per_m, 0, true), json::array({{{"group", "u0"}}}),
                  {0, -kHangGravity, 0});
}

json scenario_of(Patch patch) {
  switch (patch) {
    case Patch::HangU:
      return hang(patch, kStiffness_N_per_m, false, true);
    case Patch::HangV:
      return hang(patch, kStiffness_N_per_m, true, true);
    case Patch::HangStiffer:
      return hang(patch, 2 * kStiffness_N_per_m, false, true);
    case Patch::HangStrip:
      return hang(patch, kStiffness_N_per_m, false, false);
    case Patch::Shear:
      return shear();
    case Patch::BendU:
      return bend(patch, 1, false);
    case Patch::BendV:
      return bend(patch, 1, true);
    case Patch::BendStiffer:
      return bend(patch, 2, false);
    case Patch::Mesh0:
      return hang_mesh(patch, 0, 1);
    case Patch::Mesh45:
      return hang_mesh(patch, 45, 2);
    case Patch::Mesh90:
      return hang_mesh(patch, 90, 3);
    case Patch::BendDiagonal:
      break;
  }
  return bend_diagonal();
}

}  // namespace

const char* patch_name(Patch patch) {
  constexpr const char* kNames[] = {"hang-u", "hang-v",       "hang-stiffer",  "hang-strip", "shear",   "bend-u",
                                    "bend-v", "bend-stiffer", "bend-diagonal", "mesh-0",     "mesh-45", "mesh-90"};
  return kNames[static_cast<std::size_t>(patch)];
}

Scene patch_scene(Patch patch) {
  return scene_from_json(scenario_of(patch), std::string("effective moduli, patch ") + patch_name(patch));
}

std::vector<Patch> patches(bool full) {
  if (!full) return {Patch::HangU, Patch::HangStrip, Patch::BendU};
  return {Patch::HangU, Patch::HangV, Patch::HangStiffer, Patch::HangStrip,   Patch::Shear,
          Patch::BendU, Patch::BendV, Patch::BendStiffer, Patch::BendDiagonal};
}

std::vector<Patch> mesh_patches() { return {Patch::Mesh0, Patch::Mesh45, Patch::Mesh90}; }

}  // namespace clothbench
