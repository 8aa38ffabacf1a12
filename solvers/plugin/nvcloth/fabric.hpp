/// The cloth's constraints, cooked by the engine's own cooker.
#pragma once

#include "nvcloth/engine.hpp"

namespace clothbench::nvcloth {

struct FabricOptions {
  bool tethers = true;
  double iteration_s = 0;             ///< time step of one solver iteration [s]
  double stiffness_frequency_hz = 0;  ///< the frequency at which stiffnesses are stated
};

struct Cooked {
  nv::cloth::Fabric* fabric = nullptr;         ///< one reference, the caller's
  std::vector<nv::cloth::PhaseConfig> phases;  ///< phases that the scene needs, with their stiffness
};

/// Cooks the sheet at rest. `NvClothExt`'s cooker sorts constraints into phases: vertical and horizontal edges,
/// diagonals, and pairs two edges apart for bending; tethers go to the pins. Phases without a spring of the scene are
/// left out. A constraint's stiffness is the share of its error that one iteration removes, W k h^2 / (1 + W k h^2)
/// with the sum W of inverse masses and the spring k: an iteration is a step of its own here, and then this is the
/// constraint's compliance (Macklin et al., XPBD, 2016, eq. 18 with lambda = 0).
Cooked cook(nv::cloth::Factory&, const ClothbenchScene&, const std::vector<double>& inverse_mass, const FabricOptions&);

}  // namespace clothbench::nvcloth
