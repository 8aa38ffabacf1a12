#include "runner/environment.hpp"

#include <sys/utsname.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "clothbench/record.hpp"
#include "runner/nvml.hpp"

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
  static std::map<std::string, std::string> hashes;  // by path; a loaded library keeps its first hash
  const std::string path = info.folder.substr(std::string(kPluginPrefix).size());
  const auto [at, is_new] = hashes.try_emplace(path);
  if (is_new) at->second = sha256(read_text(path, std::uintmax_t{1} << 30));
  environment["plugin"] = {{"path", path}, {"sha256", at->second}, {"summary", info.summary}};
  if (!info.engine.empty()) environment["plugin"]["engine"] = info.engine;
}

std::string uuid_of_gpu(const nlohmann::json& environment) {
  const nlohmann::json gpu = environment.value("gpu_properties", nlohmann::json());
  return gpu.is_object() ? gpu.value("uuid", "") : "";
}

nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol) {
  nlohmann::json e;
  e["gpu"] = device.name;
  e["driver"] = device.driver;
  e["api"] = device.api;
  e["gpu_is_software"] = device.is_software;
  e["gpu_properties"] = json_or_discarded(device.properties_json);
  e["device_profile"] = e["gpu_properties"].value("device_profile", std::string("none"));
  e["cpu"] = cpu_model();
  e["cpu_threads"] = std::thread::hardware_concurrency();
  e["os"] = operating_system();
  e["compiler"] = build_info::kCompiler;
  e["shader_compiler"] = build_info::kShaderCompiler;
  e["build_type"] = build_info::kBuildType;
  e["git_commit"] = build_info::kGitCommit;
  e["git_dirty"] = build_info::kGitDirty;
  e["source_sha256"] = build_info::kSourceSha256;
  e["created"] = utc_now();
  e["sensors"] = read_sensors("/", uuid_of_gpu(e));
  for (const char* stated : {"power_limit_W", "ecc"})
    if (const auto& gpu = e["sensors"]["gpu"]; gpu.contains(stated)) e[stated] = gpu[stated];
  e["clock_policy"] = clock_policy(e["sensors"]);
  e["protocol"] = protocol;
  e["jobs"] = jobs_now();
  if (double load = 0; std::ifstream("/proc/loadavg") >> load) e["load_average"] = load;
  return e;
}

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

void put_number(json& into, const char* key, const fs::path& file, double scale) {
  double value = kMissing;
  if (std::ifstream(file) >> value && std::isfinite(value)) into[key] = value * scale;
}

void put_text(json& into, const char* key, const fs::path& file) {
  if (const auto text = line_of(file)) into[key] = *text;
}

/// Folders "<prefix><number>" in numerical order; numbers may be missing.
std::vector<std::pair<int, fs::path>> numbered(const fs::path& folder, const std::string& prefix) {
  constexpr int kMost = 1024;
  std::vector<std::pair<int, fs::path>> found;
  std::error_code ec;
  for (int k = 0; k < kMost; ++k)
    if (const fs::path at = folder / (prefix + std::to_string(k)); fs::exists(at, ec)) found.emplace_back(k, at);
  return found;
}

double greatest(const json& list, const char* key) {
  double most = kMissing;
  for (const json& item : list)
    if (const double v = item.value(key, kMissing); !(v <= most) && std::isfinite(v)) most = v;
  return most;
}

}  // namespace

json read_sensors(const fs::path& root, const std::string& gpu_uuid) {
  constexpr double kKiloHertz = 1e3, kMilliDegree = 1e-3;
  json all = {{"cpus", json::array()}, {"gpu", json::object()}, {"temperatures", json::array()}};
  for (const auto& [number, folder] : numbered(root / "sys/devices/system/cpu", "cpu")) {
    json cpu;
    put_number(cpu, "frequency_Hz", folder / "cpufreq/scaling_cur_freq", kKiloHertz);
    put_text(cpu, "governor", folder / "cpufreq/scaling_governor");
    if (cpu.is_null()) continue;
    cpu["cpu"] = number;
    all["cpus"].push_back(std::move(cpu));
  }
  const fs::path adreno = root / "sys/class/kgsl/kgsl-3d0";
  put_text(all["gpu"], "model", adreno / "gpu_model");
  put_number(all["gpu"], "frequency_Hz", adreno / "gpuclk", 1);
  put_text(all["gpu"], "governor", adreno / "devfreq/governor");
  put_number(all["gpu"], "temperature_C", adreno / "temp", kMilliDegree);
  all["gpu"].update(nvidia_state(gpu_uuid));
  for (const auto& [unused, folder] : numbered(root / "sys/class/thermal", "thermal_zone")) {
    json zone;
    // A zone that is switched off gives an error or a value below absolute zero.
    put_number(zone, "temperature_C", folder / "temp", kMilliDegree);
    if (zone.is_null() || !(zone["temperature_C"].get<double>() > -273.15)) continue;
    put_text(zone, "type", folder / "type");
    all["temperatures"].push_back(std::move(zone));
  }
  return all;
}

void store_sensors(const json& sensors, TimedTrial& t) {
  t.cpu_clock_Hz = greatest(sensors.value("cpus", json::array()), "frequency_Hz");
  t.gpu_clock_Hz = sensors.value("gpu", json::object()).value("frequency_Hz", kMissing);
  json zones = sensors.value("temperatures", json::array());
  zones.push_back(sensors.value("gpu", json::object()));
  t.temperature_C = greatest(zones, "temperature_C");
}

void summarise_sensors(const TimedTrial& t, const std::string& when, std::map<std::string, double>& summary) {
  summary["cpu_clock_" + when + "_Hz"] = t.cpu_clock_Hz;
  summary["gpu_clock_" + when + "_Hz"] = t.gpu_clock_Hz;
  summary["temperature_" + when + "_C"] = t.temperature_C;
}

namespace {

/// Energy that all CPU packages have used since some moment; NaN if not readable.
double package_energy_J(const fs::path& root) {
  constexpr double kMicro = 1e-6;
  double sum = kMissing;
  for (const auto& [unused, package] : numbered(root / "sys/class/powercap", "intel-rapl:")) {
    json j;
    put_number(j, "energy_J", package / "energy_uj", kMicro);
    if (!j.is_null()) sum = (std::isnan(sum) ? 0 : sum) + j["energy_J"].get<double>();
  }
  return sum;
}

/// Power that is drawn from the battery; NaN without one, or if it is not discharging.
double battery_W(const fs::path& root) {
  constexpr double kMicro = 1e-6;
  const fs::path battery = root / "sys/class/power_supply/battery";
  json j;
  put_number(j, "A", battery / "current_now", kMicro);
  put_number(j, "V", battery / "voltage_now", kMicro);
  if (line_of(battery / "status") != "Discharging" || j.size() != 2) return kMissing;
  return std::abs(j["A"].get<double>()) * j["V"].get<double>();  // drivers differ in the sign of the current
}

}  // namespace

PowerMeter::PowerMeter(fs::path root, std::string gpu_uuid)
    : root_(std::move(root)),
      gpu_uuid_(std::move(gpu_uuid)),
      start_(std::chrono::steady_clock::now()),
      start_J_(package_energy_J(root_)),
      gpu_start_J_(nvidia_energy_J(gpu_uuid_)) {}

double PowerMeter::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double PowerMeter::mean_gpu_W() const {
  const double used_J = nvidia_energy_J(gpu_uuid_) - gpu_start_J_;
  return used_J / seconds();
}

double PowerMeter::mean_W() const {
  const double used_J = package_energy_J(root_) - start_J_;
  if (std::isnan(used_J)) return battery_W(root_);
  return used_J >= 0 ? used_J / seconds() : kMissing;
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

namespace {

constexpr const char* kProgram = "clothbench";

struct Process {
  int parent = 0;
  bool is_job = false;
};

/// Parses /proc/<pid>/stat: "pid (name) state parent …". The name may contain any text, so later fields are searched
/// from the last ')'.
Process process_of(const fs::path& stat) {
  std::ifstream in(stat);
  std::string text;
  std::getline(in, text);
  const std::size_t open = text.find('('), close = text.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close + 4 >= text.size()) return {};
  const char state = text[close + 2];
  const bool alive = state != 'Z' && state != 'X' && state != 'T';  // not dead and not stopped
  return {std::atoi(text.c_str() + close + 4), alive && text.substr(open + 1, close - open - 1) == kProgram};
}

/// Whether process `who` is a descendant of process `of`.
bool descends(const std::map<int, Process>& all, int who, int of) {
  for (std::size_t steps = 0; steps <= all.size(); ++steps) {
    if (who == of) return true;
    const auto at = all.find(who);
    if (at == all.end()) return false;
    who = at->second.parent;
  }
  return false;
}

}  // namespace

int jobs_in(const fs::path& proc, int self) {
  std::map<int, Process> all;
  std::error_code ec;
  for (fs::directory_iterator at(proc, ec), end; !ec && at != end; at.increment(ec)) {
    const std::string name = at->path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos)
      all[std::atoi(name.c_str())] = process_of(at->path() / "stat");
  }
  int jobs = 1;
  for (const auto& [pid, p] : all) jobs += p.is_job && !descends(all, pid, self) && !descends(all, self, pid);
  return jobs;
}

int jobs_now() {
  const char* given = std::getenv("CLOTHBENCH_JOBS");
  const int jobs = given == nullptr ? 0 : std::atoi(given);
  return jobs > 0 ? jobs : jobs_in("/proc", getpid());
}

}  // namespace clothbench
