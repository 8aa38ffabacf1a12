#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "render/motion.hpp"
#include "runner/solver_run.hpp"

namespace clothbench::render {

/// Whether a path is a result file or the part folder of a run.
bool is_run(const std::filesystem::path&);

/// The motions that a result file or a folder of them holds; of a folder those with `wanted` in their names. Any other
/// path is a scenario, whose motion `run` makes. Throws Error if a folder leaves it open which are meant, and for a
/// motion without frames.
std::vector<Motion> motions_of(const std::string& file, const std::function<Motion(const std::string& scenario)>& run,
                               const std::string& wanted);

/// Runs a scene for its positions alone. Throws Error if the solver cannot run it.
Motion run_motion(const RunSpec&, const DeviceOptions&);

}  // namespace clothbench::render
