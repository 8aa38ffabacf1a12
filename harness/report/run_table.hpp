#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/interval.hpp"
#include "base/words.hpp"
#include "clothbench/record.hpp"
#include "results/store.hpp"

namespace clothbench {

/// The scenario of a run; an empty object for a planned run whose scene is not known.
nlohmann::json scenario_of(const RunRecord&);
/// The environment's value of `key`; null if there is none.
nlohmann::json environment_of(const RunRecord&, const char* key);
/// The environment's text of `key`; empty if there is none.
std::string environment_text(const RunRecord&, const char* key);

/// Engine that the run's plugin wraps, as the plugin states it: "NvCloth"; empty if it states none, or is no plugin.
std::string engine_of(const RunRecord&);

extern const char* const kPublishedTable3;  ///< results/paper-table3.json
extern const char* const kSolverRoles;      ///< solvers.json

/// Roles of solvers in comparisons and colours of figures by label, from solvers.json.
const nlohmann::json& solver_roles();
/// The harness without a cloth model: its times are the harness's cost, and its motion proves nothing.
inline bool is_floor(const std::string& solver) { return contains(solver_roles().at("floor"), solver); }
/// The model that errors are compared with; it is not ranked.
inline bool is_baseline(const std::string& solver) { return contains(solver_roles().at("baseline"), solver); }
/// The solver that times are relative to, whoever else is present.
inline std::string time_baseline() { return solver_roles().at("times_relative_to"); }
/// Parts of the names of scenes that lead a report, the first one first, and the place of a scene's name among them.
inline const nlohmann::json& leading_scenes() { return solver_roles().at("leading_scenes"); }
std::size_t place_of_scene(const std::string& scene);

/// NaN without values.
double median(std::vector<double>);

/// Quantile of a sorted list by the nearest rank; NaN if it is empty.
double nearest_rank(const std::vector<double>& sorted, double q);

/// "diverged at 12" (the failed frame), or only the status if no frame failed.
std::string ending(const Outcome&);
/// "diverged (F1)"; only the status if it has no class.
std::string status_with_class(const Outcome&);
/// "llvmpipe" of "llvmpipe (LLVM 15.0.6, 256 bits)".
inline std::string short_name(const std::string& device) { return device.substr(0, device.find(" (")); }
/// " (text)"; nothing for an empty text.
inline std::string in_brackets(const std::string& text) { return text.empty() ? "" : " (" + text + ")"; }
/// "–" for an empty text.
inline std::string or_dash(const std::string& text) { return text.empty() ? "–" : text; }
/// "xpbd substeps=4": the solver, and the setting if it is not the default.
std::string label_of(const RunRecord&);

/// Names of the summary values that violate a bound of the run's scene; "outcome" if the run did not end as it should.
std::vector<std::string> violated_bounds(const RunRecord&);

inline constexpr const char* kNoVerdict = "–";

/// Verdict on a run: "pass", "fail", "not measured"; kNoVerdict if there are no bounds; "ignored" if the bounds hold
/// but the scene has contact and the solver ignores all of it, which proves nothing; its ending if it did not end well.
std::string verdict(const RunRecord&);

/// Bounds that the run's scene sets on a value, and the check of its motion; only `"outcome": "ok"` is none.
std::size_t bounds_of(const RunRecord&);

/// Counted by `verdict`, of the runs whose scene has a bound. Missing runs are not counted.
struct VerdictCounts {
  std::size_t runs = 0, passed = 0, ignored = 0, unsupported = 0, not_measured = 0;
  /// Failed a bound, or did not end well.
  std::size_t failed() const { return runs - passed - ignored - unsupported - not_measured; }
  /// "3 of 5 runs passed, 1 failed, 1 unsupported"; what there is none of is left out.
  std::string text() const;
  void add(const RunRecord&);
};

/// The one count of passed runs: consoles, tables and JSON take it from here.
VerdictCounts count_verdicts(const std::vector<RunRecord>&);

/// The first item for which `is` holds; if there is none, appends `fresh` and returns it.
template <class Item, class Is>
Item& find_or_add(std::vector<Item>& items, Is is, Item fresh) {
  const auto at = std::find_if(items.begin(), items.end(), is);
  return at == items.end() ? items.emplace_back(std::move(fresh)) : *at;
}

/// Cloth resolution. `grid` is {0, 0} for a cloth that is not a grid.
struct Resolution {
  int grid[2] = {0, 0};
  std::uint32_t vertices = 0;  ///< number of vertices of a cloth that is not a grid; 0 otherwise
  std::string label() const;   ///< "32²", "9×7", "1234 vertices", "–"
  double size() const { return static_cast<double>(grid[0]) * grid[1] + vertices; }
};

/// Frame times [s] of all timed trials of a run. Intervals: 95 %.
struct FrameTimes {
  std::vector<double> sorted;  ///< ascending
  Interval median;
  Interval rate;  ///< of the median over trials of the frames per second
  /// Nearest-rank quantile; NaN without frames.
  double at(double q) const;
  /// Share of the frames that are longer than one refresh of a display.
  double missed(double rate_hz) const;
  /// True if the interval of the median is wider than 20 % of it: the run is marked and, by its wall time, not ranked.
  bool uncertain() const;
};

/// All times of a run; `contact_…`: of the frames in which something touches the cloth.
struct RunTimes {
  FrameTimes wall, device, contact_wall, contact_device, cpu, rendered;
  double threads = kMissing;  ///< CPU time over wall time of the median frame of a CPU solver, rounded
};

/// Intervals by kIntervalMethod, with a fixed seed; fewer than 6 frames have none. Frames of one block depend on each
/// other, so they are drawn together.
RunTimes times_of(const RunRecord&);

/// The method of the intervals, as a sentence for notes of tables.
extern const char* const kIntervalMethod;

/// The section of the report that a run belongs to. None: a planned run whose scene is not known.
enum class Part { Rates, Contact, Generated, Claims, Truth, Stability, None };

/// Properties of a scene with an exact solution that all of its runs share.
struct TruthFacts {
  std::string ranking;            ///< definition of the error that ranks solvers
  double space_error = kMissing;  ///< error of this mesh's exact solution against the continuum
  double uncertainty = kMissing;  ///< U_ref over the quantity's scale
  double best_error = kMissing;   ///< smallest error of all ranked solvers that ended well; NaN if none did
  double floor() const { return 3 * uncertainty; }  ///< uncertainty floor; NaN if unknown
  /// Errors below it are not distinguished: the larger of floor() and space_error, where known; 0 if neither is.
  double rank_floor() const { return std::fmax(0, std::fmax(floor(), space_error)); }
  /// Why no solver is ranked: there is no reference, or 3 U_ref is not below the best error. Empty if solvers are.
  std::string refused() const;
};

/// A run as tables and figures see it.
struct Row {
  const RunRecord* run = nullptr;
  nlohmann::json scenario = {};
  Part part = Part::Rates;
  std::string scene = {};   ///< with the labels of axes
  std::string name = {};    ///< in the scene's file, without the labels of axes
  std::string family = {};  ///< name shared by runs whose scenes differ only in resolution and sides; "x (2)" if taken
  std::string solver = {}, setting = {}, sides = {};
  bool contact = false;  ///< the scene has colliders or hands that grip the cloth
  bool leads = false;    ///< its scene with contact stands on the first screen
  Resolution resolution = {};
  int repeat = 1;        ///< 2, 3, … where several files hold the same run
  int paper_table = 0;   ///< number of the paper's table that the scene names; 0: none
  int published = -1;    ///< column of the paper's table, for a published value; -1 for a measured run
  bool largest = false;  ///< finest resolution of its family
  bool scaled = false;   ///< a figure may show it against the resolutions of its family
  int most_frames = 0;   ///< maximum number of timed frames of a run of the scene
  std::shared_ptr<TruthFacts> truth = nullptr;
  std::shared_ptr<const RunTimes> times = nullptr;  ///< never null in a RunTable
  const Row* baseline = nullptr;                    ///< run of time_baseline() in the same scene
  /// One of many settings of a sweep, whose errors and times are under "Error against run time".
  bool in_sweep() const { return part == Part::Truth && setting.find('=') != std::string::npos; }
  bool is_best = false;  ///< settings of the cheapest point of `reproduction` where most claims hold
  int rank = 0;          ///< by wall time among the runs of the scene; 0: not ranked (RunTable)

  std::string label() const;  ///< "xpbd substeps=4 (2)"
  int frames() const { return run->trials.empty() ? 0 : run->trials.front().frames(); }
  /// "first 36 frames" where the run timed fewer frames than another run of its scene; otherwise empty.
  std::string frames_mark() const;
  double value(const std::string& scalar) const { return summary_value(*run, scalar); }
  std::string status() const { return run->outcome.status; }
  double frame_rate_hz() const;
  /// Wall time [ms] per simulated second; pipelined where the solver supports it.
  double wall_ms_per_s() const;
  /// The same, from submission to fence, waiting for each frame; and by the device's clock, NaN on a CPU.
  double fenced_ms_per_s() const { return 1e3 * frame_rate_hz() * value("frame_wall_median_s"); }
  double device_ms_per_s() const { return 1e3 * frame_rate_hz() * value("frame_device_median_s"); }
  double error() const { return value("truth_error"); }
  /// The run ended well and has an error and a time.
  bool counts() const { return status() == "ok" && std::isfinite(error()) && std::isfinite(wall_ms_per_s()); }
  /// Why this run is shown but not ranked: the scene depends on a stiffness that the solver leaves out. Empty if
  /// ranked.
  std::string not_ranked() const;
  /// Minimum and maximum contact offset [m]: the solver's own, otherwise the scene's margin; NaN without colliders.
  std::pair<double, double> offset_m() const;
  /// Conditions of the timed trials, as the file states them: "alone", "alone, throttled (1980 to 1400 MHz)", …
  std::string trust() const;
  /// Parameters of a randomly generated scene; null for any other.
  nlohmann::json drawn() const;
};

/// Sets Row::is_best. Rows must not move any more.
void mark_best_points(std::vector<Row>&);

/// True if the run's scene has colliders or hands that grip the cloth.
bool has_contact(const RunRecord&);

/// results/paper-table3.json, as it was at build time.
inline nlohmann::json published_table3() { return nlohmann::json::parse(kPublishedTable3); }

/// All runs of a report as typed rows. Rows point into the table, so it must not be copied or moved.
class RunTable {
 public:
  explicit RunTable(std::vector<RunRecord> runs);
  RunTable(const RunTable&) = delete;
  RunTable& operator=(const RunTable&) = delete;

  const std::vector<RunRecord>& runs() const { return runs_; }
  /// In the order of tables: scenes in the order of first appearance; then by solver, setting and sides, by ascending
  /// resolution. Includes the published values if a run has paper_table 3, after its scene's runs.
  const std::vector<Row>& rows() const { return rows_; }

 private:
  void add_published();

  std::vector<RunRecord> runs_;
  std::deque<RunRecord> published_;
  std::vector<Row> rows_;
};

}  // namespace clothbench
