#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// State of an NVIDIA GPU as its driver's management library reports it, without the values that it does not report:
/// frequency_Hz (streaming multiprocessors), temperature_C, power_limit_W, ecc.
/// `uuid`: 32 hexadecimal digits, as Vulkan and the library state it. Empty if there is no such library or GPU.
/// Source: NVIDIA, NVML API Reference Guide.
nlohmann::json nvidia_state(const std::string& uuid);

/// Only its energy [J] since the driver was loaded; NaN if there is no such library or GPU.
double nvidia_energy_J(const std::string& uuid);

}  // namespace clothbench
