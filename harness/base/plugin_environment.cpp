#include "base/plugin_environment.hpp"

#include <cstdlib>

namespace clothbench {
namespace {

constexpr char kInProcess[] = "CLOTHBENCH_IN_PROCESS";

}  // namespace

bool plugins_in_process() { return std::getenv(kInProcess) != nullptr; }

void run_plugins_in_process() { setenv(kInProcess, "1", 1); }

}  // namespace clothbench
