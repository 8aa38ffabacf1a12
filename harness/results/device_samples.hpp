#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "clothbench/record.hpp"

namespace clothbench {

/// Values that a device reported during runs: frame rate, bandwidth, clocks, temperature. Each series has the sampling
/// rate and the name of its source. `samples.json` of scripts/quest_run.py, format 1 (results/README.md).
class DeviceSamples {
 public:
  /// Throws Error naming the file and the JSON pointer.
  explicit DeviceSamples(const std::filesystem::path& file);

  /// Stores as /device_samples the samples from 5 s before the run's first trial to 5 s after its last (all samples if
  /// the trials' times are not known), each with the trial that contains its whole period. Samples inside trials give
  /// `sampled_…` in the summary. The environment gets whether the run is valid, and if not, why.
  void attach_to(RunRecord&) const;

 private:
  nlohmann::json all_;
};

}  // namespace clothbench
