#pragma once
#include <vulkan/vulkan.h>

#include <map>
#include <string>
#include <vector>

/// A layer between pbd-gpu and Vulkan, only in this program: the linker puts it in the way of every call
/// (-Wl,--wrap, vulkan_calls.def). It counts, makes one call fail, and knows which objects are alive.
namespace clothbench::faults {

/// From the next call on: call number `call` (0 is the next) gives `result` instead of being made, and every later one
/// too where `sticky`; -1: none. Resets the count.
void arm(int call, VkResult result, bool sticky);
void disarm();

int calls();                          ///< that could fail, since arm
const std::string& failed_call();     ///< the first that was made to fail since arm; "" if none was
std::map<std::string, long> alive();  ///< objects made and not unmade, by kind; kinds of which there are none left out
std::vector<std::string> names();     ///< of all calls in the table

}  // namespace clothbench::faults
