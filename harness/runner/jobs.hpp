#pragma once
#include <filesystem>

namespace clothbench {

/// How many clothbench jobs the machine runs now, this process included: processes named "clothbench" whose processor
/// time this one has to share. Those that this one was started by or has started are one job with it. At least 1; 1
/// where there is no /proc. $CLOTHBENCH_JOBS says how many instead, for a scheduler that knows what /proc doesn't show.
int jobs_now();

/// The same of a /proc that lies elsewhere.
int jobs_in(const std::filesystem::path& proc, int self);

}  // namespace clothbench
