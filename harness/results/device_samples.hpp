#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "clothbench/record.hpp"

namespace clothbench {

/// What a device reported while it ran: frame rate, bandwidth, clocks, temperature, each series at the rate of whoever
/// measured it and under the name that has there. `samples.json` of scripts/quest_run.py, format 1 (results/README.md).
class DeviceSamples {
 public:
  /// Throws Error naming the file and the JSON pointer.
  explicit DeviceSamples(const std::filesystem::path& file);

  /// Stores as /device_samples what was sampled from 5 s before the run's first trial to 5 s after its last
  /// (everything where the trials' times are not known), with the trial each sample lies in as a whole. From those
  /// inside trials: `sampled_…` in the summary. Whether the run may count, and why not, goes into the environment.
  void attach_to(RunRecord&) const;

 private:
  nlohmann::json all_;
};

}  // namespace clothbench
