#include "runner/nvml.hpp"

#include <dlfcn.h>

#include "clothbench/record.hpp"

namespace clothbench {
namespace {

/// Functions of nvml.h; no header of the vendor is needed to build. They return 0 on success.
class Library {
 public:
  Library() {
    void* library = dlopen("libnvidia-ml.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return;
    const auto load = [library](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(library, name));
      return function != nullptr;
    };
    int (*init)() = nullptr;
    works_ = load(init, "nvmlInit_v2") && load(by_uuid_, "nvmlDeviceGetHandleByUUID") &&
             load(clock_, "nvmlDeviceGetClockInfo") && load(temperature_, "nvmlDeviceGetTemperature") &&
             load(energy_, "nvmlDeviceGetTotalEnergyConsumption") && load(limit_, "nvmlDeviceGetEnforcedPowerLimit") &&
             load(ecc_, "nvmlDeviceGetEccMode") && init() == 0;
  }

  nlohmann::json state(const std::string& uuid) const {
    constexpr double kMega = 1e6, kMilli = 1e-3;
    constexpr int kSmClock = 1, kGpuSensor = 0;
    nlohmann::json j = nlohmann::json::object();
    void* const device = find(uuid);
    if (device == nullptr) return j;
    unsigned value = 0, pending = 0;
    if (clock_(device, kSmClock, &value) == 0) j["frequency_Hz"] = kMega * value;
    if (temperature_(device, kGpuSensor, &value) == 0) j["temperature_C"] = value;
    if (limit_(device, &value) == 0) j["power_limit_W"] = kMilli * value;
    if (ecc_(device, &value, &pending) == 0) j["ecc"] = value != 0;
    return j;
  }

  double energy_J(const std::string& uuid) const {
    constexpr double kMilli = 1e-3;
    unsigned long long energy_mJ = 0;
    void* const device = find(uuid);
    const bool known = device != nullptr && energy_(device, &energy_mJ) == 0;
    return known ? kMilli * static_cast<double>(energy_mJ) : kMissing;
  }

 private:
  /// Null if there is no such GPU.
  void* find(const std::string& uuid) const {
    void* device = nullptr;
    if (!works_) return device;
    std::string name = "GPU-" + uuid;
    for (const std::size_t dash : {12u, 17u, 22u, 27u}) name.insert(dash, "-");
    return by_uuid_(name.c_str(), &device) == 0 ? device : nullptr;
  }

  bool works_ = false;
  int (*by_uuid_)(const char*, void**) = nullptr;
  int (*clock_)(void*, int, unsigned*) = nullptr;
  int (*temperature_)(void*, int, unsigned*) = nullptr;
  int (*energy_)(void*, unsigned long long*) = nullptr;
  int (*limit_)(void*, unsigned*) = nullptr;
  int (*ecc_)(void*, unsigned*, unsigned*) = nullptr;
};

bool is_uuid(const std::string& uuid) { return uuid.size() == 32; }  // empty: no GPU, so nothing is loaded

const Library& library() {
  static const Library loaded;
  return loaded;
}

}  // namespace

nlohmann::json nvidia_state(const std::string& uuid) {
  return is_uuid(uuid) ? library().state(uuid) : nlohmann::json::object();
}

double nvidia_energy_J(const std::string& uuid) { return is_uuid(uuid) ? library().energy_J(uuid) : kMissing; }

}  // namespace clothbench
