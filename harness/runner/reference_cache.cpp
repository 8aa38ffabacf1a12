#include "runner/reference_cache.hpp"

#include <fmt/format.h>

#include <fstream>

#include "base/files.hpp"
#include "base/sha256.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json to_json(const json& key, const ReferenceResult& r) {
  json j = {{"key", key}, {"scale", r.scale}, {"least_substeps", r.least_substeps}};
  for (const auto& [name, value] : r.scalars()) j[name] = value;  // NaN becomes null
  return j;
}

double number(const json& j, const char* key) { return j.at(key).is_null() ? kMissing : j.at(key).get<double>(); }

ReferenceResult from_json(const json& j) {
  ReferenceResult r;
  r.scale = number(j, "scale");
  r.least_substeps = j.at("least_substeps");
  r.truth = number(j, "truth_value");
  r.value = number(j, "reference_value");
  r.uncertainty = number(j, "reference_uncertainty");
  r.order_bdf2 = number(j, "reference_order_bdf2");
  r.order_conservative = number(j, "reference_order_conservative");
  r.truth_distance = number(j, "reference_truth_distance");
  r.space_error = number(j, "truth_space_error");
  return r;
}

/// The scene first, so that a person finds its file; then what else the key says, shortened. The file has the whole
/// key.
fs::path cache_file(const fs::path& folder, const json& key) {
  return folder /
         fmt::format("{}-{}.json", key.at("scenario_sha256").get<std::string>(), sha256(key.dump()).substr(0, 16));
}

}  // namespace

json reference_key(const Scene& scene, const ReferenceRules& rules) {
  const SolverInfo& info = find_solver("reference").info;
  json settings = json::array();
  for (const char* integrator : {"bdf2", "conservative"})
    settings.push_back(complete_settings(info, {{"integrator", integrator}, {"tolerance", rules.tolerance}}));
  // The substeps of the runs follow from the rules and the scene.
  for (json& s : settings) s.erase("substeps");
  return {{"scenario_sha256", scene.sha256},
          {"solver_version", info.version},
          {"solver_settings", settings},
          {"moving_steps", rules.moving_steps},
          {"settling_substeps", rules.settling_substeps},
          {"code_sha256", kReferenceCode}};
}

std::optional<ReferenceResult> read_reference(const fs::path& folder, const json& key) {
  std::ifstream in(cache_file(folder, key));
  const json j = in ? json::parse(in, nullptr, false) : json();
  if (!j.is_object() || j.value("key", json()) != key) return std::nullopt;
  try {
    return from_json(j);
  } catch (const json::exception&) {  // not whole: it is computed again
    return std::nullopt;
  }
}

void write_reference(const fs::path& folder, const json& key, const ReferenceResult& r) {
  write_file_atomically(cache_file(folder, key), to_json(key, r).dump(2) + "\n");
}

}  // namespace clothbench
