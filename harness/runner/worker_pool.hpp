#pragma once
#include <functional>
#include <vector>

#include "runner/run_process.hpp"

namespace clothbench {

/// Runs the tasks on `jobs` threads, each with its own worker (scratch/<k>), in the order of their numbers as threads
/// become free. After an exception no further task is begun, and the first exception is thrown once all threads are
/// done.
void run_tasks(const std::vector<std::function<void(RunWorker&)>>& tasks, int jobs,
               const std::filesystem::path& program, const std::filesystem::path& scratch);

}  // namespace clothbench
