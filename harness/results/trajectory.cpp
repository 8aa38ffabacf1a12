#include "results/trajectory.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/sha256.hpp"
#include "results/hdf5_file.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// The first frame and vertex whose position is not finite, or nothing.
std::string fault_of_values(const AccuracyPass& pass, std::size_t vertices) {
  for (std::size_t k = 0; k < pass.position.size(); ++k)
    if (!std::isfinite(pass.position[k]))
      return fmt::format("the position of vertex {} in frame {} is not finite", k / 3 % vertices, k / 3 / vertices);
  for (std::size_t f = 0; f < pass.time_s.size(); ++f)
    if (!std::isfinite(pass.time_s[f]) || (f > 0 && !(pass.time_s[f] > pass.time_s[f - 1])))
      return fmt::format("the time of frame {} is not after the frame before", f);
  return "";
}

/// A run without vertices has no positions, and live sessions store only their end.
bool needs_motion(const RunRecord& r) {
  const nlohmann::json& e = r.header.environment;
  const bool live = e.is_object() && e.value("protocol", "") == "xr";
  return r.outcome.status == "ok" && r.header.vertices > 0 && !live;
}

}  // namespace

std::string trajectory_sha256(const AccuracyPass& pass) {
  if (pass.time_s.empty()) return "";
  std::string bytes;
  append(bytes, pass.time_s);
  append(bytes, pass.position);
  return sha256(bytes);
}

std::string trajectory_fault(const std::filesystem::path& path) {
  const RunRecord r = read_run(path);
  const AccuracyPass& pass = r.accuracy;
  if (pass.time_s.empty() && pass.position.empty()) return needs_motion(r) ? "the file has no positions" : "";
  const std::size_t expected = pass.time_s.size() * r.header.vertices * 3;
  if (pass.position.size() != expected)
    return fmt::format("expected {} coordinates of {} frames with {} vertices; found {}", expected, pass.time_s.size(),
                       r.header.vertices, pass.position.size());
  for (const MetricSeries& m : pass.metrics)
    if (m.values.size() != pass.time_s.size())
      return fmt::format("{} frames have positions, {} have {}", pass.time_s.size(), m.values.size(), m.name);
  if (r.outcome.status == "ok")
    if (std::string fault = fault_of_values(pass, r.header.vertices); !fault.empty()) return fault;
  if (std::filesystem::is_directory(path)) return "";  // its frames have checksums of their own
  const std::string stored = read_hdf5_trajectory_sha256(path), found = trajectory_sha256(pass);
  if (stored == found) return "";
  return fmt::format("its positions are not the motion that its outcome is of (SHA-256 {}, stored {})",
                     found.substr(0, 12), stored.empty() ? "none" : stored.substr(0, 12));
}

}  // namespace clothbench
