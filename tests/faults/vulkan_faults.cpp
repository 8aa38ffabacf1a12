#include "vulkan_faults.hpp"

namespace clothbench::faults {
namespace {

struct State {
  int call = -1, count = 0;
  VkResult result = VK_SUCCESS;
  bool sticky = false;
  std::string failed;
  std::map<std::string, long> alive;
};

State& state() {
  static State& s = *new State;  // never destroyed: calls may come after static destructors
  return s;
}

VkResult next(const char* name) {
  State& s = state();
  const int now = s.count++;
  const bool fails = s.call >= 0 && (now == s.call || (s.sticky && now > s.call));
  if (!fails) return VK_SUCCESS;
  if (s.failed.empty()) s.failed = name;
  return s.result;
}

}  // namespace

void arm(int call, VkResult result, bool sticky) {
  State& s = state();
  s.call = call;
  s.count = 0;
  s.result = result;
  s.sticky = sticky;
  s.failed.clear();
}

void disarm() { arm(-1, VK_SUCCESS, false); }
int calls() { return state().count; }
const std::string& failed_call() { return state().failed; }

std::map<std::string, long> alive() {
  std::map<std::string, long> out;
  for (const auto& [kind, n] : state().alive)
    if (n != 0) out[kind] = n;
  return out;
}

}  // namespace clothbench::faults

#define FALLIBLE(name, parameters, arguments)                           \
  extern "C" VkResult __real_##name parameters;                         \
  extern "C" VkResult __wrap_##name parameters {                        \
    const VkResult injected = clothbench::faults::next(#name);          \
    return injected != VK_SUCCESS ? injected : __real_##name arguments; \
  }
// The wait is executed although it reports an error. A lost device would have stopped, but this device still runs its
// work, and the caller then destroys objects that this work uses.
#define WAITS(name, parameters, arguments)                     \
  extern "C" VkResult __real_##name parameters;                \
  extern "C" VkResult __wrap_##name parameters {               \
    const VkResult waited = __real_##name arguments;           \
    const VkResult injected = clothbench::faults::next(#name); \
    return injected != VK_SUCCESS ? injected : waited;         \
  }
#define MAKES(kind, name, parameters, arguments, made)                                             \
  extern "C" VkResult __real_##name parameters;                                                    \
  extern "C" VkResult __wrap_##name parameters {                                                   \
    const VkResult injected = clothbench::faults::next(#name);                                     \
    if (injected != VK_SUCCESS) return injected;                                                   \
    const VkResult result = __real_##name arguments;                                               \
    if (result == VK_SUCCESS) clothbench::faults::state().alive[#kind] += static_cast<long>(made); \
    return result;                                                                                 \
  }
#define UNMAKES(kind, name, parameters, arguments, given)                 \
  extern "C" void __real_##name parameters;                               \
  extern "C" void __wrap_##name parameters {                              \
    clothbench::faults::state().alive[#kind] -= static_cast<long>(given); \
    __real_##name arguments;                                              \
  }
#include "vulkan_calls.def"
#undef FALLIBLE
#undef WAITS
#undef MAKES
#undef UNMAKES

std::vector<std::string> clothbench::faults::names() {
  return {
#define FALLIBLE(name, parameters, arguments) #name,
#define WAITS(name, parameters, arguments) #name,
#define MAKES(kind, name, parameters, arguments, made) #name,
#define UNMAKES(kind, name, parameters, arguments, given) #name,
#include "vulkan_calls.def"
#undef FALLIBLE
#undef WAITS
#undef MAKES
#undef UNMAKES
  };
}
