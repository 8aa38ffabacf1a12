#pragma once
#include <filesystem>
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// Sidecar that lets ParaView before 5.12 open the trajectory, and the meshes that stand still with it: one grid a
/// frame over /frames/NNNNNN of `h5_name`, a collection of the cloth and these meshes where there are any.
void write_xdmf(const std::filesystem::path&, const std::string& h5_name, const RunRecord&);

}  // namespace clothbench
