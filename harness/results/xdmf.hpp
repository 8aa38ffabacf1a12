#pragma once
#include <filesystem>
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// Writes a sidecar with which ParaView before 5.12 opens the trajectory and the static meshes: per frame one grid over
/// /frames/NNNNNN of `h5_name`, or a collection of the cloth and the static meshes if there are any.
void write_xdmf(const std::filesystem::path&, const std::string& h5_name, const RunRecord&);

}  // namespace clothbench
