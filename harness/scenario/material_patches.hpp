#pragma once
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Patch tests of a material: scenes whose shape at rest gives one modulus in closed form, so that the
/// effective Y and B of a solver can be measured through scenes and positions alone. All hang or bend under gravity
/// with the damping of `kPatchDamping_per_s` and end at rest; harness/metrics/material_patch.hpp turns the last
/// positions into moduli.
///
/// HangU, HangV        a sheet 4 : 1 hangs by its short edge, along the grid's u or v: uniaxial stretch, 1 % at the
/// top.
///                     Y of it at 0 and 90 degrees, Poisson's ratio
/// HangStiffer         HangU with twice the Y: does the solver listen to it?
/// HangStrip           HangU with `shear: false`: strips of Y each
/// Shear               a band 1 : 8 held along both long edges slides between them: the shear modulus, slope 1 %.
///                     45 degrees: a grid can't be cut at an angle, but with the grid's lines as axes of symmetry
///                     4/E_45 = 1/E_0 + 1/E_90 - 2 nu/E_0 + 1/G (orthotropic compliance, turned)
/// BendU, BendV        a strip clamped along a short edge, Gamma = rho g L^3/B = 0.5: B at 0 and 90 degrees
/// BendStiffer         BendU with twice the B
/// BendDiagonal        all vertices held but those of a band along the diagonal, gravity across the sheet: in the
/// band's
///                     middle it bends to a cylinder at 45 degrees, w'''' = rho g/B_45 whatever happens at its edges
enum class Patch { HangU, HangV, HangStiffer, HangStrip, Shear, BendU, BendV, BendStiffer, BendDiagonal };

inline constexpr double kPatchDamping_per_s = 20;

const char* patch_name(Patch);

/// Throws nothing: the scenes are the program's own.
Scene patch_scene(Patch);

/// Of a full measured, in the order in which they are run; and of a short one: HangU, HangStrip, BendU.
std::vector<Patch> patches(bool full);

}  // namespace clothbench
