#pragma once
#include <filesystem>

namespace clothbench {

/// Number of clothbench jobs that the machine runs now, this process included: processes named "clothbench" that share
/// processor time with this one. This process, its ancestors and its descendants are one job. At least 1; 1 where there
/// is no /proc. $CLOTHBENCH_JOBS overrides the number, for a scheduler with information that /proc does not have.
int jobs_now();

/// The same for a /proc at another path.
int jobs_in(const std::filesystem::path& proc, int self);

}  // namespace clothbench
