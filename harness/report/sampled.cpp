#include <cmath>

#include "report/report.hpp"

namespace clothbench {

const std::vector<std::string>& sampled_names() {
  static const std::vector<std::string> names = {"sampled_valid",
                                                 "sampled_fps_mean",
                                                 "sampled_read_peak_B_per_s",
                                                 "sampled_read_mean_B_per_s",
                                                 "sampled_read_samples",
                                                 "sampled_write_peak_B_per_s",
                                                 "sampled_write_mean_B_per_s",
                                                 "sampled_write_samples",
                                                 "sampled_cpu_clock_mean_Hz",
                                                 "sampled_gpu_clock_mean_Hz",
                                                 "sampled_temperature_max_C"};
  return names;
}

Table sampled_table(const std::vector<RunRecord>& runs) {
  Table t{"The device's own counters during the trials",
          "FPS: frames that the display showed. Read and written: memory traffic of the whole device, which is "
          "neither that of the app alone nor the computed bytes of the other tables. Peak: greatest 1 s sample "
          "in windows of 5 s. –: no sample lies within a trial.",
          {{"scene", "solver", "FPS", "read peak / mean [GB/s]", "written peak / mean [GB/s]", "GPU [MHz]", "CPU [MHz]",
            "hottest [°C]", "valid"}}};
  for (const RunRecord& c : runs) {
    const auto v = [&](const char* name) { return summary_value(c, name); };
    const double valid = v("sampled_valid");
    if (!std::isfinite(valid)) continue;
    t.rows.push_back({c.header.scene, label_of(c), significant(v("sampled_fps_mean"), 3),
                      paired(1e-9 * v("sampled_read_peak_B_per_s"), 1e-9 * v("sampled_read_mean_B_per_s"), " / ", 3),
                      paired(1e-9 * v("sampled_write_peak_B_per_s"), 1e-9 * v("sampled_write_mean_B_per_s"), " / ", 3),
                      significant(1e-6 * v("sampled_gpu_clock_mean_Hz"), 4),
                      significant(1e-6 * v("sampled_cpu_clock_mean_Hz"), 4),
                      significant(v("sampled_temperature_max_C"), 3), valid == 1 ? "yes" : "no"});
  }
  return t;
}

}  // namespace clothbench
