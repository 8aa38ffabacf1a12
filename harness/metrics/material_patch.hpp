#pragma once
#include <map>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "scenario/material_patches.hpp"

namespace clothbench {

/// Moduli measured from the rest positions of one patch, over the values its scene states. NaN if the state is not
/// finite or yields no value (a sheet that does not stretch at all). A B below that of Gamma = 100 is returned as 0.
///   HangU       E_0, nu, skew          E from the middle line's stretch between L/2 and 7L/8, u' = rho g (L - s)/E;
///                                      nu from the contraction of the section at L/2; skew: shear strain there over
///                                      strain
///   HangV       E_90                   HangStiffer   E_stiffer, over its own Y, twice that of HangU
///   HangStrip   E_strip, strip_border  the latter: E of a border line over that of the middle one
///   Shear       G                      over Y: rho g s^2 over the second difference of the middle line
///   BendU, BendV  B_0, B_90            from the free end's drop by the elastica (harness/truth)
///   BendStiffer B_stiffer              BendDiagonal  B_45: rho g s^4 over the fourth difference across the band
///   Mesh0, 45, 90   mesh_E_0, mesh_E_45, mesh_E_90, mesh_nu   by least squares (mesh_patch.hpp); mesh_nu of Mesh0
/// `position` [m], xyz interleaved.
std::map<std::string, double> patch_moduli(Patch, const Scene&, const std::vector<double>& position);

/// E_45 from the combined results of HangU, HangV and Shear (see Patch::Shear), all over Y. NaN if one is missing, or
/// if the grid's lines are not axes of symmetry (|skew| above 5 %).
double modulus_at_45(const std::map<std::string, double>& moduli);

}  // namespace clothbench
