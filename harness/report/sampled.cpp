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
  constexpr Unit kMegahertz{"MHz", 1e-6};
  static const auto rates = [](const std::string& of) {
    return [=](const RunRecord& c) {
      return paired(1e-9 * summary_value(c, "sampled_" + of + "_peak_B_per_s"),
                    1e-9 * summary_value(c, "sampled_" + of + "_mean_B_per_s"), " / ", 3);
    };
  };
  std::vector<RunRecord> sampled = runs;
  std::erase_if(sampled, [](auto& c) { return !std::isfinite(summary_value(c, "sampled_valid")); });
  return Columns<RunRecord>{
      {"", "scene", [](auto& c) { return c.header.scene; }},
      {"", "solver", label_of},
      {"", "FPS", summary("sampled_fps_mean"), digits(3)},
      {"", "read peak / mean [GB/s]", rates("read")},
      {"", "written peak / mean [GB/s]", rates("write")},
      {"", "GPU", summary("sampled_gpu_clock_mean_Hz"), digits(4), kMegahertz},
      {"", "CPU", summary("sampled_cpu_clock_mean_Hz"), digits(4), kMegahertz},
      {"", "hottest [°C]", summary("sampled_temperature_max_C"), digits(3)},
      {"", "valid", [](auto& c) { return summary_value(c, "sampled_valid") == 1 ? "yes" : "no"; }}}
      .table({"The device's own counters during the trials",
              "FPS: frames that the display showed. Read and written: memory traffic of the whole device, which is "
              "neither that of the app alone nor the computed bytes of the other tables. Peak: greatest 1 s sample "
              "in windows of 5 s. –: no sample lies within a trial.",
              {}},
             sampled);
}

}  // namespace clothbench
