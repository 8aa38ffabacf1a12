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

/// Input of a summary's scalars: one run of one scene, as far as it was computed.
struct RunView {
  RunView(const Scene&, const AccuracyPass&, Outcome = {});
  /// For a run with its trials; `plan` must outlive this.
  RunView(const Scene&, const RunRecord&, const Plan& plan, bool on_gpu);

  const Scene& scene;
  const AccuracyPass& pass;
  const Outcome outcome;
  const RunRecord* run = nullptr;  ///< null: no times are known
  const Plan* plan = nullptr;      ///< the same
  bool on_gpu = false;

  /// Whether the pass reaches the scene's end.
  bool whole() const;
  /// One value per frame, or null if there is no series of that name.
  const std::vector<double>* series(const std::string& name) const;
  /// First frame of the last half second, including the one at its beginning.
  std::size_t settled_from() const;
  /// The check of the positions; empty without positions, or where this build cannot measure the scene's contact.
  std::span<const motion_check::Finding> findings() const;
  /// One of them by the name of its statistic; null if it is not among them.
  const motion_check::Finding* finding(std::string_view name) const;
  /// Only for a scene that states a truth.
  const truth::ReferenceCase& reference_case() const;
  /// The same.
  const ExactBound& exact_bound() const;

 private:
  mutable std::optional<truth::ReferenceCase> case_;
  mutable std::optional<std::vector<motion_check::Finding>> findings_;
  mutable std::optional<ExactBound> bound_;
};

/// How a number is computed from a run.
struct Reduction {
  std::vector<std::string> series;  ///< metrics it depends on; empty: it is measured otherwise
  std::string how;                  ///< "maximum of all frames"; for a custom rule, its whole description
  std::function<double(const RunView&)>
      value;               ///< NaN: not defined or not known. Null: added by the code that executed the run
  std::string units = "";  ///< empty: the unit of its one series, and `how` describes the reduction of that series
};

/// Unit of an absolute slack: 1, or the shorter side L of the cloth [m].
enum class SlackUnit { One, Length };

/// How `check` compares a scalar with its baseline: less is better, and a value above baseline plus slack fails.
struct Gate {
  double absolute = 0;  ///< in `unit`
  SlackUnit unit = SlackUnit::One;
  double relative = 0;           ///< share of the baseline's value, added
  bool zero_stays_zero = false;  ///< a baseline of exactly 0 has no slack
  const char* why = "";
};

/// For errors: one solver differs between lavapipe and an H200 by at most 3.1e-7 (paper, in the Table 3 study).
inline constexpr Gate kErrorGate{1e-6, SlackUnit::One, 0.1, false,
                                 "three times the largest difference seen between devices"};

enum class Better { Less, More, Neither };
const char* name_of(Better);

enum class Expect { No, Yes };  ///< whether a scene's `expect` may bound a scalar

/// One number of a run's summary. Values of the machine, or that may grow without a worse result, have no gate.
struct Scalar {
  std::string name;  ///< a '*' at its end stands for any text
  Reduction from;
  Expect expect = Expect::No;
  const Gate* gate = nullptr;                             ///< null: not checked
  std::function<bool(const RunView&)> present = nullptr;  ///< null: in every summary, NaN if it has no value
  std::string units = "", doc = "";                       ///< a plain phrase; both set by the registry
  Better better = Better::Less;
  bool of_machine = false;  ///< a time, or a value that depends on times: it measures the machine too
};

/// The metrics that one file of measures/ defines.
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

/// Whether a value of a result's summary, or the outcome of a bound on it, depends on the machine and its load.
bool is_of_machine(const std::string& summary_name);

/// Names of the series of series.csv, in its order.
std::vector<std::string> series_columns();

/// All scalars present in the run's summary whose names begin with `start`.
std::map<std::string, double> scalars_of(const RunView&, const std::string& start = "");

/// Prefix of summary values that are the outcome of a bound: 1 pass, 0 fail, NaN not measured.
inline const std::string kExpect = "expect.";
/// Prefix of the statistics of metrics/motion_check: each over its tolerance.
inline const std::string kMotionCheck = "motion_check.";

/// Suffix of the bound on a scalar that a scene with an exact solution expects.
inline const std::string kBound = "_bound";

/// The scalars that have such a bound.
inline constexpr const char* kExactlyBounded[] = {"truth_e2", "truth_quantity_error"};

/// Reductions of one series. The result is NaN if any frame is NaN or the series is missing.
Reduction greatest(const char* series);
Reduction least(const char* series);
Reduction last(const char* series);
Reduction sum(const char* series);
Reduction greatest_settled(const char* series);  ///< over the scene's last half second; NaN unless the pass is complete
Reduction greatest_last_second(const char* series);  ///< the same over its last second
Reduction mean_last_second(const char* series);
/// A reduction by a custom rule.
inline Reduction own(std::vector<std::string> series, std::string what, std::function<double(const RunView&)> value,
                     std::string units) {
  return {std::move(series), std::move(what), std::move(value), std::move(units)};
}

/// Maximum from index `from` on; NaN if any value is NaN, or if there are none.
double greatest_of(const std::vector<double>* values, std::size_t from = 0);

class ColliderContact;
class StabilityJudge;
class TruthJudge;

/// The metrics of one accuracy pass over one run: those that apply to its scene, each evaluated once per frame. Keeps
/// state between frames (such as the vertices that touched), so frames must be added in order.
class MetricPass {
 public:
  /// The objects that `context` refers to must outlive the pass.
  explicit MetricPass(const MetricContext& context);
  ~MetricPass();
  MetricPass(const MetricPass&) = delete;
  MetricPass& operator=(const MetricPass&) = delete;

  /// State at the end of the next frame; the first call is frame 0, the initial state.
  void add(const ClothState&);
  /// Whether the run cannot recover from a stability class: not finite, or speed or energy out of bounds.
  bool lost() const { return lost_; }

  /// One series per metric, in the order of metrics().
  std::vector<MetricSeries> take() { return std::move(series_); }

 private:
  MetricContext context_;
  std::vector<const Metric*> wanted_;
  std::vector<MetricSeries> series_;
  std::unique_ptr<ColliderContact> contact_;             ///< null if the scene has no collider
  std::unique_ptr<TruthJudge> judge_;                    ///< null where the scene states no truth
  std::unique_ptr<StabilityJudge> stability_;            ///< null where the scene is not judged
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< empty where the cloth does not touch itself
  bool lost_ = false;
  int frame_ = 0;
};

}  // namespace clothbench
