#pragma once
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/metric.hpp"
#include "metrics/motion_check/motion_check.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {

/// Input of the summary's scalars: the parts of one run of one scene that were computed.
struct RunView {
  RunView(const Scene&, const AccuracyPass&, Outcome = {});
  /// For a run with its trials; `plan` must outlive this object.
  RunView(const Scene&, const RunRecord&, const Plan& plan, bool on_gpu);

  const Scene& scene;
  const AccuracyPass& pass;
  const Outcome outcome;
  const RunRecord* run = nullptr;  ///< null: no timed run
  const Plan* plan = nullptr;      ///< null: no timed run
  bool on_gpu = false;

  /// Whether the pass reaches the scene's end.
  bool whole() const;
  /// One value per frame, or null if there is no series of that name.
  const std::vector<double>* series(const std::string& name) const;
  /// First frame of the last half second, including the one at its beginning.
  std::size_t settled_from() const;
  /// Findings of motion_check; empty without positions, or if this build cannot measure the scene's contact.
  std::span<const motion_check::Finding> findings() const;
  /// The finding of a statistic by name; null if there is none.
  const motion_check::Finding* finding(std::string_view name) const;
  /// Only for a scene with an exact solution.
  const truth::ReferenceCase& reference_case() const;
  /// Only for a scene with an exact solution.
  const ExactBound& exact_bound() const;

 private:
  mutable std::optional<truth::ReferenceCase> case_;
  mutable std::optional<std::vector<motion_check::Finding>> findings_;
  mutable std::optional<ExactBound> bound_;
};

/// Rule that computes a number from a run.
struct Reduction {
  std::vector<std::string> series;  ///< metrics that it reads; empty: other data
  std::string how;                  ///< "maximum of all frames"; for a custom rule, its complete description
  std::function<double(const RunView&)>
      value;               ///< NaN: not defined or not known. Null: added by the code that executed the run
  std::string units = "";  ///< empty: unit of its only series, and `how` is how this series is reduced
};

/// Unit of an absolute tolerance: 1, or the shorter side L of the cloth [m].
enum class SlackUnit { One, Length };

/// Regression rule of `check` for a scalar: smaller is better; a value above baseline plus tolerance fails.
struct Gate {
  double absolute = 0;  ///< tolerance in the scalar's unit
  SlackUnit unit = SlackUnit::One;
  double relative = 0;           ///< fraction of the baseline's value, added
  bool zero_stays_zero = false;  ///< no tolerance if the baseline is exactly 0
  const char* why = "";
};

/// For errors: runs of one solver on lavapipe and an H200 differ by at most 3.1e-7 (paper, in the Table 3 study).
inline constexpr Gate kErrorGate{1e-6, SlackUnit::One, 0.1, false,
                                 "three times the largest difference seen between devices"};

enum class Better { Less, More, Neither };
const char* name_of(Better);

enum class Expect { No, Yes };  ///< whether a scene's `expect` may set a bound on a scalar

/// One number of a run's summary. Values that depend on the machine or may grow in a good run have no regression rule.
struct Scalar {
  std::string name;  ///< a trailing '*' stands for any text
  Reduction from;
  Expect expect = Expect::No;
  const Gate* gate = nullptr;                             ///< null: not checked
  std::function<bool(const RunView&)> present = nullptr;  ///< null: in every summary, NaN if undefined
  std::string units = "", doc = "";                       ///< a plain phrase; both set by the registry
  Better better = Better::Less;
  bool of_machine = false;  ///< a time, or a value that depends on times
};

/// The metrics and scalars that one file of measures/ defines.
struct MetricGroup {
  std::vector<Metric> series;
  std::vector<Scalar> scalars;
  std::string source = "";  ///< that file; set by the registry
};

const std::vector<MetricGroup>& metric_groups();

/// All metrics and scalars, group by group.
const std::vector<Metric>& metrics();
const std::vector<Scalar>& scalars();

/// The scalar of that name; null if none.
const Scalar* find_scalar(const std::string& name);

/// Whether a summary value, or the result of a bound on it, depends on the machine and its load.
bool is_of_machine(const std::string& summary_name);

/// Names of the series in series.csv, in column order.
std::vector<std::string> series_columns();

/// All scalars present in the run's summary whose names begin with `start`. Those that need no timed run are copied
/// from the record's summary if it has them.
std::map<std::string, double> scalars_of(const RunView&, const std::string& start = "");

/// Prefix of the results of bounds in a summary: 1 pass, 0 fail, NaN not measured.
inline const std::string kExpect = "expect.";
/// Prefix of the statistics of metrics/motion_check, each divided by its tolerance.
inline const std::string kMotionCheck = "motion_check.";

/// Suffix of the upper bound that the exact solution sets on a scalar.
inline const std::string kBound = "_bound";

/// The scalars with a bound from the exact solution.
inline constexpr const char* kExactlyBounded[] = {"truth_e2", "truth_quantity_error"};

/// Reductions of one series. The result is NaN if any frame is NaN or the series is missing.
Reduction greatest(const char* series);
Reduction least(const char* series);
Reduction last(const char* series);
Reduction sum(const char* series);
Reduction greatest_settled(const char* series);      ///< over the last half second; NaN if the pass ends early
Reduction greatest_last_second(const char* series);  ///< over the last second
Reduction mean_last_second(const char* series);
/// A reduction by a custom rule.
inline Reduction own(std::vector<std::string> series, std::string what, std::function<double(const RunView&)> value,
                     std::string units) {
  return {std::move(series), std::move(what), std::move(value), std::move(units)};
}

/// Maximum from index `from` on; NaN if any value is NaN or there are no values.
double greatest_of(const std::vector<double>* values, std::size_t from = 0);

class ColliderContact;
class StabilityJudge;
class TruthJudge;

/// The metrics of one accuracy pass over one run: the ones that apply to its scene, evaluated once per frame. Keeps
/// state between frames (such as the vertices that touched), so add frames in order.
class MetricPass {
 public:
  /// The objects that `context` refers to must outlive the pass.
  explicit MetricPass(const MetricContext& context);
  ~MetricPass();
  MetricPass(const MetricPass&) = delete;
  MetricPass& operator=(const MetricPass&) = delete;

  /// Adds the state at the end of the next frame; the first call adds frame 0, the initial state.
  void add(const ClothState&);
  /// Whether the run has failed for good: not finite, or speed or energy out of bounds.
  bool lost() const { return lost_; }

  /// One series per metric, in the order of metrics().
  std::vector<MetricSeries> take() { return std::move(series_); }

 private:
  MetricContext context_;
  std::vector<const Metric*> wanted_;
  std::vector<MetricSeries> series_;
  std::unique_ptr<ColliderContact> contact_;             ///< null if the scene has no collider
  std::unique_ptr<TruthJudge> judge_;                    ///< null if the scene names no exact solution
  std::unique_ptr<StabilityJudge> stability_;            ///< null if the scene has no stability rules
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< empty if the cloth has no self-collision
  bool lost_ = false;
  int frame_ = 0;
};

}  // namespace clothbench
