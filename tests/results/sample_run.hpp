#pragma once
#include <cmath>

#include "clothbench/record.hpp"

namespace clothbench {

/// A small run with every kind of content; all values differ, and some are missing.
inline RunRecord sample_run(int trials = 3, int frames = 4, std::uint32_t vertices = 6) {
  RunRecord r;
  r.header.scene = "sample";
  r.header.solver = "none";
  r.header.setting = "readback=blocking";
  r.header.settings = {{"iterations", 5}, {"mode", "a"}};
  r.header.scenario_json = R"({"name":"sample","cloth":{"grid":[3,2],"sides":"single"}})";
  r.header.scenario_sha256 = "00ff";
  r.header.stages = {{"First", {"stretch", "shear"}, 3}, {"Second", {}, 1}};
  r.header.plan = {{"buffers", nlohmann::json::array()}};
  r.header.environment = {
      {"gpu", "none"}, {"driver", "µ"}, {"gpu_is_software", true}, {"created", "2026-01-01T00:00:00Z"}};
  r.header.vertices = vertices;
  r.header.triangles = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  r.header.load_s = 0.25;
  for (int t = 0; t < trials; ++t) {
    TimedTrial trial;
    trial.index = t;
    if (t != 1) trial.pipelined_wall_s = 8e-4 * (1 + t);
    if (t != 0) trial.jobs = 1 + 10 * t;
    if (t != 2) trial.start_unix_s = 1.7e9 + 10 * t;
    if (t != 2) trial.end_unix_s = trial.start_unix_s + 4.125;
    for (int f = 0; f < frames; ++f) {
      trial.frame_wall_s.push_back(1e-3 * (1 + t) + 1e-5 * f);
      if (t != 1) trial.frame_cpu_s.push_back(1.1e-3 * (1 + t) + 1e-7 * f);
      if (t == 0 && f < 3) trial.frame_rendered_s.push_back(2e-3 + 1e-5 * f);  // fewer than frames
      trial.frame_device_s.push_back(t == 1 ? kMissing : 9e-4 + 1e-6 * f);
      for (int s = 0; s < 2; ++s) {
        trial.stage_device_s.push_back(f < 2 ? 1e-4 * (s + 1) : kMissing);
        trial.stage_read_B.push_back(100 * (s + 1) + f);
        trial.stage_write_B.push_back(50 * (s + 1) + f);
      }
    }
    r.trials.push_back(trial);
  }
  r.accuracy.metrics = {{"stretch_max", "1", "greatest strain", {}}, {"speed_max", "m s-1", "greatest speed", {}}};
  for (int f = 0; f <= frames; ++f) {
    r.accuracy.time_s.push_back(f / 72.0);
    for (std::uint32_t k = 0; k < 3 * vertices; ++k)
      r.accuracy.position.push_back(static_cast<float>(f) + 0.01f * static_cast<float>(k));
    r.accuracy.metrics[0].values.push_back(f == 0 ? kMissing : 0.1 * f);
    r.accuracy.metrics[1].values.push_back(9.81 * f / 72);
  }
  r.replay = {{"colliders", {{"count", 2}, {"frame_rate_hz", 72.0}}, {}},
              {"colliders/0", {{"shape", "capsules"}, {"normal", {0.0, 1.0, 0.1}}}, {}},
              {"colliders/1", {{"shape", "mesh"}}, {}}};
  StoredArray capsules{"capsules", "m", "ends and radius", {"frame", "capsule", "value"}, {2, 3, 7}, false, {}};
  StoredArray triangles{"triangles", "1",  "vertices of each triangle", {"triangle", "corner"},
                        {2, 3},      true, {0, 1, 2, 0, 2, 3}};
  for (int k = 0; k < 42; ++k) capsules.values.push_back(0.1 * k);
  StoredArray corners{
      "position_m", "m", "vertices", {"vertex", "xyz"}, {4, 3}, false, {0, -1, 0, 1, -1, 0, 1, -1, 1, 0, -1, 1}};
  r.replay[1].arrays = {capsules, triangles};
  r.replay[2].arrays = {corners, triangles};
  r.outcome = {"diverged", "F0", 3, "a message with \"quotes\" and µ", "fail: stretch_max 2 > 1"};
  r.summary = {{"fps_median", 123.4567890123}, {"read_B_per_frame", kMissing}};
  return r;
}

/// NaN equals NaN; everything else is bit-identical.
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))) return false;
  return true;
}

inline bool same(const TimedTrial& a, const TimedTrial& b) {
  return a.index == b.index &&
         same(std::vector{a.pipelined_wall_s, a.start_unix_s, a.end_unix_s, a.jobs},
              std::vector{b.pipelined_wall_s, b.start_unix_s, b.end_unix_s, b.jobs}) &&
         same(a.frame_wall_s, b.frame_wall_s) && same(a.frame_device_s, b.frame_device_s) &&
         same(a.frame_cpu_s, b.frame_cpu_s) && same(a.frame_rendered_s, b.frame_rendered_s) &&
         same(a.stage_device_s, b.stage_device_s) && same(a.stage_read_B, b.stage_read_B) &&
         same(a.stage_write_B, b.stage_write_B);
}

}  // namespace clothbench
