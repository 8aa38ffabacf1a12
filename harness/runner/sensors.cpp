#include "runner/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::optional<std::string> line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) return std::nullopt;
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.pop_back();
  if (line.empty()) return std::nullopt;
  return line;
}

std::optional<double> number_of(const fs::path& file) {
  const auto line = line_of(file);
  if (!line) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(line->c_str(), &end);
  if (end == line->c_str() || !std::isfinite(value)) return std::nullopt;
  return value;
}

void put_number(json& into, const char* key, const fs::path& file, double scale) {
  if (const auto value = number_of(file)) into[key] = *value * scale;
}

void put_text(json& into, const char* key, const fs::path& file) {
  if (const auto text = line_of(file)) into[key] = *text;
}

/// Folders "<prefix><number>" in numerical order.
std::vector<std::pair<int, fs::path>> numbered(const fs::path& folder, const std::string& prefix) {
  std::vector<std::pair<int, fs::path>> found;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder, ec)) {
    const std::string name = entry.path().filename().string();
    if (name.size() <= prefix.size() || name.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string digits = name.substr(prefix.size());
    if (digits.size() < 6 &&
        std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
      found.emplace_back(std::stoi(digits), entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

double greatest(const json& list, const char* key) {
  double most = kMissing;
  for (const json& item : list)
    if (const double v = item.value(key, kMissing); !(v <= most) && std::isfinite(v)) most = v;
  return most;
}

}  // namespace

json read_sensors(const fs::path& root) {
  constexpr double kKiloHertz = 1e3, kMilliDegree = 1e-3;
  json all = {{"cpus", json::array()}, {"gpu", json::object()}, {"temperatures", json::array()}};
  for (const auto& [number, folder] : numbered(root / "sys/devices/system/cpu", "cpu")) {
    json cpu;
    put_number(cpu, "frequency_Hz", folder / "cpufreq/scaling_cur_freq", kKiloHertz);
    put_number(cpu, "min_Hz", folder / "cpufreq/scaling_min_freq", kKiloHertz);
    put_number(cpu, "max_Hz", folder / "cpufreq/scaling_max_freq", kKiloHertz);
    put_text(cpu, "governor", folder / "cpufreq/scaling_governor");
    if (cpu.is_null()) continue;
    cpu["cpu"] = number;
    all["cpus"].push_back(std::move(cpu));
  }
  const fs::path adreno = root / "sys/class/kgsl/kgsl-3d0";
  put_text(all["gpu"], "model", adreno / "gpu_model");
  put_number(all["gpu"], "frequency_Hz", adreno / "gpuclk", 1);
  put_number(all["gpu"], "max_Hz", adreno / "max_gpuclk", 1);
  put_text(all["gpu"], "governor", adreno / "devfreq/governor");
  put_number(all["gpu"], "temperature_C", adreno / "temp", kMilliDegree);
  for (const auto& [number, folder] : numbered(root / "sys/class/thermal", "thermal_zone")) {
    json zone;
    // A zone that is switched off answers with an error, or with a value below absolute zero.
    put_number(zone, "temperature_C", folder / "temp", kMilliDegree);
    if (zone.is_null() || !(zone["temperature_C"].get<double>() > -273.15)) continue;
    zone["zone"] = number;
    put_text(zone, "type", folder / "type");
    all["temperatures"].push_back(std::move(zone));
  }
  return all;
}

void summarise_sensors(const json& sensors, const std::string& when, std::map<std::string, double>& summary) {
  summary["cpu_clock_" + when + "_Hz"] = greatest(sensors.value("cpus", json::array()), "frequency_Hz");
  summary["gpu_clock_" + when + "_Hz"] = sensors.value("gpu", json::object()).value("frequency_Hz", kMissing);
  json zones = sensors.value("temperatures", json::array());
  zones.push_back(sensors.value("gpu", json::object()));
  summary["temperature_" + when + "_C"] = greatest(zones, "temperature_C");
}

std::string clock_policy(const json& sensors) {
  std::string policy;
  for (const json& cpu : sensors.value("cpus", json::array()))
    if (cpu.contains("governor")) {
      policy = "cpu governor " + cpu["governor"].get<std::string>();
      break;
    }
  if (const json gpu = sensors.value("gpu", json::object()); gpu.contains("governor"))
    policy += (policy.empty() ? "" : ", ") + ("gpu governor " + gpu["governor"].get<std::string>());
  return policy.empty() ? "not readable" : policy;
}

}  // namespace clothbench
