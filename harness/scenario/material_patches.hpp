#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Patch tests of a material: scenes whose shape at rest gives one modulus in closed form. So the effective Y and B of
/// a solver are measured from positions alone. All scenes hang or bend under gravity with damping `kPatchDamping_per_s`
/// and end at rest; harness/metrics/material_patch.hpp computes the moduli from the last positions.
///
/// HangU, HangV   a sheet 4 : 1 hangs by its short edge, along the grid's u or v: uniaxial stretch, 1 % at the top.
///                Gives Y at 0 and 90 degrees, and Poisson's ratio
/// HangStiffer    HangU with twice the Y: does the solver respond to Y?
/// HangStrip      HangU with `shear: false`: each strip has stiffness Y
/// Shear          a band 1 : 8, held along both long edges, is sheared by gravity: the shear modulus, slope 1 %.
///                Gives Y at 45 degrees too, where a grid cannot be cut: with the grid lines as axes of symmetry,
///                4/E_45 = 1/E_0 + 1/E_90 - 2 nu/E_0 + 1/G (rotated orthotropic compliance)
/// BendU, BendV   a strip clamped along a short edge, Gamma = rho g L^3/B = 0.5: B at 0 and 90 degrees
/// BendStiffer    BendU with twice the B
/// BendDiagonal   all vertices are held except a band along the diagonal; gravity is normal to the sheet. The middle of
///                the band bends to a cylinder at 45 degrees, w'''' = rho g/B_45, whatever the conditions at its edges
/// Mesh0, Mesh45, Mesh90   the sheet of HangU as irregular triangles (drawn_mesh.hpp), whose lattice lies at that angle
///                to the pull: Y and Poisson's ratio
enum class Patch {
  HangU,
  HangV,
  HangStiffer,
  HangStrip,
  Shear,
  BendU,
  BendV,
  BendStiffer,
  BendDiagonal,
  Mesh0,
  Mesh45,
  Mesh90
};

inline constexpr double kPatchDamping_per_s = 20;

const char* patch_name(Patch);

/// The scene of a patch. It throws nothing, since these scenes are built in.
Scene patch_scene(Patch);

/// All patches of grids, in the order in which they run, or those of the short form: HangU, HangStrip, BendU.
std::vector<Patch> patches(bool full);

/// The patches of triangle meshes.
std::vector<Patch> mesh_patches();

}  // namespace clothbench
