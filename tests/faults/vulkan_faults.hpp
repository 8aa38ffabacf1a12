#pragma once
#include <vulkan/vulkan.h>

#include <map>
#include <string>
#include <vector>

/// A layer between pbd-gpu and Vulkan, only in this program: the linker redirects every call to it (-Wl,--wrap,
/// vulkan_calls.def). It counts calls, makes one fail, and tracks which objects are alive.
namespace clothbench::faults {

/// Resets the count of calls. From now on, call number `call` (0 is the next) returns `result` without being executed;
/// if `sticky`, all later calls too. -1: no call fails.
void arm(int call, VkResult result, bool sticky);
void disarm();

int calls();                          ///< number of calls since arm that could fail
const std::string& failed_call();     ///< the first call since arm that was made to fail; "" if none
std::map<std::string, long> alive();  ///< objects created and not destroyed, by kind; only kinds with such objects
std::vector<std::string> names();     ///< of all calls in the table

}  // namespace clothbench::faults
