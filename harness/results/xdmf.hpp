#pragma once
#include <filesystem>
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// Sidecar that lets ParaView before 5.12 open the trajectory: one grid a frame over /frames/NNNNNN of `h5_name`.
void write_xdmf(const std::filesystem::path&, const std::string& h5_name, const CellRecord&);

}  // namespace clothbench
