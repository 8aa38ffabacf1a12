#include "runner/environment.hpp"

#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <map>
#include <thread>

#include "base/json_text.hpp"
#include "base/sha256.hpp"
#include "runner/build_info.hpp"
#include "runner/jobs.hpp"
#include "runner/sensors.hpp"

namespace clothbench {
namespace {

std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0 || line.rfind("Hardware", 0) == 0) {
      const auto colon = line.find(':');
      if (colon != std::string::npos && colon + 2 <= line.size()) return line.substr(colon + 2);
    }
  return "unknown";
}

std::string operating_system() {
  utsname u{};
  if (uname(&u) != 0) return "unknown";
  return std::string(u.sysname) + " " + u.release + " " + u.machine;
}

}  // namespace

std::string utc_now() {
  const std::time_t t = std::time(nullptr);
  std::tm tm{};
  gmtime_r(&t, &tm);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &tm);
  return text;
}

nlohmann::json describe_features(const SolverInfo& info) {
  nlohmann::json j = {{"supports", nlohmann::json::array()},
                      {"ignores", nlohmann::json::array()},
                      {"only_with", nlohmann::json::array()}};
  info.supports.for_each([&](Feature f) { j["supports"].push_back(name_of(f)); });
  info.ignores.for_each([&](Feature f) { j["ignores"].push_back(name_of(f)); });
  for (const auto& [feature, beside] : info.only_with) j["only_with"].push_back({name_of(feature), name_of(beside)});
  return j;
}

void describe_solver(const SolverInfo& info, nlohmann::json& environment) {
  environment["solver_features"] = describe_features(info);
  environment["solver_version"] = info.version;
  environment["precision"] = info.precision;
  if (!is_external(info)) return;
  static std::map<std::string, std::string> hashes;  // by path; a loaded library stays the one that it was
  const std::string path = info.folder.substr(std::string(kPluginPrefix).size());
  const auto [at, is_new] = hashes.try_emplace(path);
  if (is_new) at->second = sha256(read_text(path));
  environment["plugin"] = {{"path", path}, {"sha256", at->second}, {"summary", info.summary}};
  if (!info.engine.empty()) environment["plugin"]["engine"] = info.engine;
}

nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol) {
  nlohmann::json e;
  e["gpu"] = device.name;
  e["driver"] = device.driver;
  e["api"] = device.api;
  e["gpu_is_software"] = device.is_software;
  e["gpu_properties"] = nlohmann::json::parse(device.properties_json, nullptr, false);
  e["device_profile"] = e["gpu_properties"].value("device_profile", std::string("none"));
  e["cpu"] = cpu_model();
  e["cpu_threads"] = std::thread::hardware_concurrency();
  e["os"] = operating_system();
  e["compiler"] = build_info::kCompiler;
  e["shader_compiler"] = build_info::kShaderCompiler;
  e["build_type"] = build_info::kBuildType;
  e["version"] = build_info::kVersion;
  e["git_commit"] = build_info::kGitCommit;
  e["git_dirty"] = build_info::kGitDirty;
  e["source_sha256"] = build_info::kSourceSha256;
  e["created"] = utc_now();
  e["sensors"] = read_sensors();
  e["clock_policy"] = clock_policy(e["sensors"]);
  e["protocol"] = protocol;
  e["jobs"] = jobs_now();
  if (double load = 0; std::ifstream("/proc/loadavg") >> load) e["load_average"] = load;
  return e;
}

}  // namespace clothbench
