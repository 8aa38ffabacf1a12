#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "base/interval.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/record.hpp"
#include "results/store.hpp"

namespace clothbench {

/// The scenario of a run; an empty object for a planned run whose scene is unknown.
nlohmann::json scenario_of(const RunRecord&);
/// The environment's value for `key`, null if missing; its text, empty if missing.
nlohmann::json environment_of(const RunRecord&, const char* key);
std::string environment_text(const RunRecord&, const char* key);
/// The run's GPU, or the CPU of a solver without one; its commit, with a remark on local changes; its result folder.
std::string device_of(const RunRecord&), commit_of(const RunRecord&), folder_of(const RunRecord&);
/// Engine that the run's plugin wraps, as the plugin declares: "NvCloth"; empty if there is no plugin or it names none.
std::string engine_of(const RunRecord&);
extern const char* const kPublishedTable3;  ///< results/paper-table3.json
extern const char* const kSolverRoles;      ///< solvers.json
extern const char* const kNotes;            ///< notes.json

/// Roles of solvers in comparisons, and their colours in figures, by label; from solvers.json.
const nlohmann::json& solver_roles();
/// Whether the solver has no cloth model: its times are the harness's own cost, and its motion proves nothing.
inline bool is_floor(const std::string& solver) { return contains(solver_roles().at("floor"), solver); }
/// Whether errors are compared with this solver; it is not ranked.
inline bool is_baseline(const std::string& solver) { return contains(solver_roles().at("baseline"), solver); }
/// The solver to which times are relative, whichever solvers are present.
inline std::string time_baseline() { return solver_roles().at("times_relative_to"); }
/// Words in the names of scenes that come first in a report, in order of priority.
inline const nlohmann::json& leading_scenes() { return solver_roles().at("leading_scenes"); }
/// Index of the first of these words that the scene's name contains; their number if it contains none.
std::size_t place_of_scene(const std::string& scene);
/// Quantile of a sorted list by the nearest rank; NaN if it is empty.
double nearest_rank(const std::vector<double>& sorted, double q);
/// "diverged at 12" (the failed frame), "diverged (F1)"; only the status if no frame failed, or if there is no class.
std::string ending(const Outcome&), status_with_class(const Outcome&);
/// "llvmpipe" of "llvmpipe (LLVM 15.0.6, 256 bits)".
inline std::string short_name(const std::string& device) { return device.substr(0, device.find(" (")); }
/// " (text)", nothing for an empty text; "–" for an empty text.
inline std::string in_brackets(const std::string& text) { return text.empty() ? "" : " (" + text + ")"; }
inline std::string or_dash(const std::string& text) { return text.empty() ? "–" : text; }
/// "xpbd substeps=4": the solver, and the setting if it is not the default.
std::string label_of(const RunRecord&);
/// Names of the summary values that violate a bound of the run's scene; "outcome" if the run did not end as expected.
std::vector<std::string> violated_bounds(const RunRecord&);
inline constexpr const char* kNoVerdict = "–";
inline constexpr double kTornApart = 1;  ///< strain at which an edge has twice its rest length
/// Verdict on a run: "pass", "fail", "not measured"; kNoVerdict if there are no bounds; "ignored" if the bounds are met
/// but the solver ignores all of the scene's contact, so that the result proves nothing; its ending if it is not ok.
std::string verdict(const RunRecord&);
/// Number of bounds on a run: the scene's bounds and the motion check, without the criterion `outcome`.
std::size_t bounds_of(const RunRecord&);

/// Counts by `verdict` of the runs whose scenes have bounds. Missing runs are not counted.
struct VerdictCounts {
  std::size_t runs = 0, passed = 0, ignored = 0, unsupported = 0, not_measured = 0;
  /// Violated a bound, or ended with an error.
  std::size_t failed() const { return runs - passed - ignored - unsupported - not_measured; }
  /// "3 of 5 runs passed, 1 failed, 1 unsupported"; zero counts are omitted.
  std::string text() const;
  void add(const RunRecord&);
};

/// The only count of passed runs: terminal, tables and JSON all use it.
VerdictCounts count_verdicts(const std::vector<RunRecord>&);

/// The first item for which `is` is true; if there is none, appends `fresh` and returns it.
template <class Item, class Is>
Item& find_or_add(std::vector<Item>& items, Is is, Item fresh) {
  const auto at = std::find_if(items.begin(), items.end(), is);
  return at == items.end() ? items.emplace_back(std::move(fresh)) : *at;
}

/// Cloth resolution. `grid` is {0, 0} for a mesh.
struct Resolution {
  int grid[2] = {0, 0};
  std::uint32_t vertices = 0;  ///< number of vertices of a mesh; 0 for a grid
  std::string label() const;   ///< "32²", "9×7", "1234 vertices", "–"
  double size() const { return static_cast<double>(grid[0]) * grid[1] + vertices; }
};

/// Frame times [s] of all timed trials of a run. Intervals: 95 %.
struct FrameTimes {
  std::vector<double> sorted;  ///< ascending
  Interval median;
  Interval rate;  ///< interval of the trials' median frame rate
  /// Nearest-rank quantile; NaN without frames.
  double at(double q) const;
  /// Fraction of the frames that are longer than one refresh period of a display.
  double missed(double rate_hz) const;
  /// True if the median's interval is wider than 20 % of the median; tables mark such times and do not rank them.
  bool uncertain() const;
};

/// All times of a run; `contact_…`: only frames in which something touches the cloth.
struct RunTimes {
  FrameTimes wall, device, contact_wall, contact_device, cpu, rendered;
  double threads = kMissing;  ///< CPU time over wall time of a CPU solver's median frame, rounded
};

/// Intervals by a bootstrap (notes.json) with a fixed seed; none with fewer than 6 frames. Successive frames are
/// correlated, so blocks of frames are resampled as a whole.
RunTimes times_of(const RunRecord&);
/// Wall times of two runs in the frames that both timed; of these, only frames with contact in both, if there are any.
std::pair<FrameTimes, FrameTimes> common_times(const RunRecord&, const RunRecord&);

/// The section of the report to which a run belongs. None: a planned run whose scene is unknown.
enum class Part { Rates, Contact, Generated, Claims, Truth, Stability, None };

/// Properties of a scene with an exact solution that are the same for all of its runs.
struct TruthFacts {
  std::string ranking;            ///< definition of the error that ranks solvers
  double space_error = kMissing;  ///< error of this mesh's exact solution against the continuum
  double uncertainty = kMissing;  ///< reference uncertainty over the quantity's scale
  double best_error = kMissing;   ///< smallest error of the ranked solvers' ok runs; NaN if there are none
  double floor() const { return 3 * uncertainty; }  ///< uncertainty floor; NaN if unknown
  /// Errors below this are not distinguished: the larger of floor() and space_error, if known; 0 if neither is.
  double rank_floor() const { return std::fmax(0, std::fmax(floor(), space_error)); }
  /// Why the scene ranks no solver: no reference solution, no run to rank, or both best error and space error within
  /// 3 U_ref. Empty if it ranks solvers.
  std::string refused() const;
};

/// A run as tables and figures use it.
struct Row {
  const RunRecord* run = nullptr;
  nlohmann::json scenario = {};
  Part part = Part::Rates;
  std::string scene = {};  ///< with the labels of axes
  std::string name = {};   ///< from the scene's file, without the labels of axes
  /// Common to scenes that differ only in resolution and sides: the name of their file; if it is taken, the words that
  /// their names have in common, or the file's name and the result folder.
  std::string family = {};
  std::string solver = {}, setting = {}, sides = {};
  bool contact = false;  ///< the scene has colliders or hands that grip the cloth
  bool leads = false;    ///< this scene with contact is on the first screen
  Resolution resolution = {};
  int repeat = 1;            ///< 2, 3, … if several files hold this run
  int paper_table = 0;       ///< number of the paper's table that the scene names; 0: none
  int published = -1;        ///< column of the paper's table; -1 for a measured run
  bool largest = false;      ///< finest resolution of its family
  bool scaled = false;       ///< figures may plot it over the resolutions of its family
  bool on_software = false;  ///< on a software Vulkan device, whose times tell nothing about a GPU: never ranked
  int most_frames = 0;       ///< maximum number of timed frames over the runs of the scene
  std::shared_ptr<TruthFacts> truth = nullptr;
  std::shared_ptr<const RunTimes> times = nullptr;  ///< never null in a RunTable
  const Row* baseline = nullptr;                    ///< run of time_baseline() in the same scene
  /// One of many settings of a sweep, which are listed under "Error against run time" only.
  bool in_sweep() const { return part == Part::Truth && setting.find('=') != std::string::npos; }
  /// Has a setting that the first tables and the tiles show, and by which ranks are counted.
  bool is_main() const { return setting == "default" || setting == "best" || is_best; }
  bool elsewhere = false;  ///< the same scene, solver and settings also ran on another device
  bool is_best = false;    ///< has the cheapest settings that meet the largest number of claims in study `reproduction`
  int rank = 0;            ///< by wall time: 1 + number of the scene's main runs that are faster; 0: not ranked

  std::string label() const;  ///< "xpbd substeps=4 (2)"
  int frames() const { return run->trials.empty() ? 0 : run->trials.front().frames(); }
  /// "first 36 frames" if another run of the scene timed more frames; otherwise empty.
  std::string frames_mark() const;
  double value(const std::string& scalar) const { return summary_value(*run, scalar); }
  std::string status() const { return run->outcome.status; }
  double frame_rate_hz() const;
  /// Wall time [ms] per simulated second; pipelined if the solver supports it.
  double wall_ms_per_s() const;
  /// Time [ms] per simulated second by the device's clock.
  double device_ms_per_s() const { return 1e3 * frame_rate_hz() * value("frame_device_median_s"); }
  double error() const { return value("truth_error"); }
  /// The run is ok and has an error.
  bool counts() const { return status() == "ok" && std::isfinite(error()); }
  /// Why this run is not ranked: the scene depends on a stiffness that the solver does not control. Empty if ranked.
  std::string not_ranked() const;
  /// Minimum and maximum contact offset [m]: the solver's own, otherwise the scene's margin; NaN without colliders.
  std::pair<double, double> offset_m() const;
  /// Conditions of the timed trials, as the file states them: "alone", "alone, throttled (1980 to 1400 MHz)", …
  std::string trust() const;
  /// Why this run has no verdict, or no times; empty if it has.
  std::string not_judged() const, not_timed() const;
  /// Sampled parameters of a randomly generated scene; null for any other scene.
  nlohmann::json drawn() const;
};

/// Sets Row::is_best. Rows must not move after this.
void mark_best_points(std::vector<Row>&);
/// True if the run's scene has colliders or hands that grip the cloth.
bool has_contact(const RunRecord&);
/// results/paper-table3.json as of build time.
inline nlohmann::json published_table3() { return json_from(kPublishedTable3); }

/// All runs of a report as typed rows. Rows hold pointers into the table, so do not copy or move it.
class RunTable {
 public:
  explicit RunTable(std::vector<RunRecord> runs);
  RunTable(const RunTable&) = delete;
  RunTable& operator=(const RunTable&) = delete;
  const std::vector<RunRecord>& runs() const { return runs_; }
  /// In the order of tables: scenes by first appearance, then solver, setting, sides and ascending resolution. If a
  /// scene has paper_table 3, the published values follow its runs.
  const std::vector<Row>& rows() const { return rows_; }

 private:
  void add_published();
  std::vector<RunRecord> runs_;
  std::deque<RunRecord> published_;
  std::vector<Row> rows_;
};

}  // namespace clothbench
