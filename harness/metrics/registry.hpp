#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// What the scalars of a summary are computed from: one run of one scene, as far as it came.
struct RunView {
  RunView(const Scene&, const AccuracyPass&, Outcome = {});
  /// Of a run with its trials; `plan` outlives this.
  RunView(const Scene&, const RunRecord&, const Plan& plan, bool on_gpu);

  const Scene& scene;
  const AccuracyPass& pass;
  const Outcome outcome;
  const RunRecord* run = nullptr;  ///< null: nothing is known of times
  const Plan* plan = nullptr;      ///< the same
  bool on_gpu = false;

  /// Whether the pass reaches the scene's end.
  bool whole() const;
  /// One value a frame, or null where there are none of that name.
  const std::vector<double>* series(const std::string& name) const;
  /// First frame of the last half second, the one at its beginning included.
  std::size_t settled_from() const;
  /// Of a scene that states a truth.
  const truth::ReferenceCase& reference_case() const;

 private:
  mutable std::optional<truth::ReferenceCase> case_;
};

/// How a number comes of a run.
struct Reduction {
  std::vector<std::string> series;  ///< metrics that it hangs on; none: it is measured otherwise
  std::string how;                  ///< "greatest of all frames"; of a rule of its own what it is, whole
  std::function<double(const RunView&)>
      value;               ///< NaN: not defined or not known. Null: the code that executed the run adds it
  std::string units = "";  ///< empty: that of its one series, and it is that series' `how`
};

/// What an absolute slack is a multiple of: 1, the shorter side L of the cloth [m], or its square.
enum class SlackUnit { One, Length, Area };

/// How `check` holds a scalar to its baseline: less is better, and more than baseline and slack fails.
struct Gate {
  double absolute = 0;  ///< in `unit`
  SlackUnit unit = SlackUnit::One;
  double relative = 0;           ///< share of the baseline's value, added
  bool zero_stays_zero = false;  ///< a baseline of exactly 0 has no slack
  const char* why = "";
};

/// Error: the greatest difference of one solver between lavapipe and an H200 in the Table 3 study is 3.1e-7 (paper).
inline constexpr Gate kErrorGate{1e-6, SlackUnit::One, 0.1, false,
                                 "three times the greatest difference seen between devices"};

enum class Expect { No, Yes };  ///< whether a scene's `expect` may bound a scalar

/// One number a run, a value of its result's summary. What depends on the machine has no gate, nor has what may grow
/// without a result getting worse.
struct Scalar {
  std::string name;  ///< a '*' at its end stands for any text
  Reduction from;
  Expect expect = Expect::No;
  const Gate* gate = nullptr;                 ///< null: not checked
  int column = 0;                             ///< place among the columns of penetration.csv; 0: none
  bool (*present)(const RunView&) = nullptr;  ///< null: in every summary, NaN where it has no value
  std::string units = "", doc = "";           ///< a plain phrase; both set by the registry
};

/// What one file of this folder has to tell; the file is a line in CMakeLists.txt.
struct MetricGroup {
  std::vector<Metric> series;
  std::vector<Scalar> scalars;
  std::string source = "";  ///< the file; set by the registry
};

const std::vector<MetricGroup>& metric_groups();

/// All metrics and scalars, group by group.
const std::vector<Metric>& metrics();
const std::vector<Scalar>& scalars();

/// Null if there is none of that name.
const Scalar* find_scalar(const std::string& name);

/// Names of the columns of penetration-series.csv and of penetration.csv, in their order.
std::vector<std::string> series_columns();
const std::vector<std::string>& penetration_columns();

/// One scalar a stage of a run's plan, named after it.
std::map<std::string, double> stage_scalars(const RunView&);

/// Every scalar that is present in the run's summary, of those whose names begin so.
std::map<std::string, double> scalars_of(const RunView&, const std::string& start = "");

/// Version of the rule of a metric of this program; 0 if it has none of that name.
int metric_version(const std::string& name);

/// The metrics that a value of a result's summary is computed from, "expect.<value>" as the value itself; none for what
/// is measured otherwise (times, bytes, counts).
std::vector<std::string> metrics_behind(const std::string& summary_name);

/// What names of summary values that are a bound's outcome begin with: 1 pass, 0 fail, NaN not measured.
inline const std::string kExpect = "expect.";

}  // namespace clothbench
