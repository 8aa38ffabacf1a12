#include "report/run_table.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "truth/reference_case.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kThrottled = 0.95;  // fraction of the GPU's clock at the start

json at(const json& j, const char* pointer) {
  return j.is_object() ? j.value(json::json_pointer(pointer), json()) : json();
}

std::string text_at(const json& j, const char* pointer) {
  const json text = at(j, pointer);
  return text.is_string() ? text.get<std::string>() : "";
}

bool touches(const json& scenario) { return !at(scenario, "/colliders").empty() || !at(scenario, "/grips").empty(); }

Part part_of(const RunRecord& c, const json& scenario) {
  if (c.header.scenario_json.empty() && c.outcome.status == "missing") return Part::None;
  if (scenario.contains("stability")) return Part::Stability;
  if (scenario.contains("drawn")) return scenario["drawn"].contains("settings") ? Part::Claims : Part::Generated;
  if (scenario.contains("truth")) return Part::Truth;
  return touches(scenario) ? Part::Contact : Part::Rates;
}

/// Fills the row's members from the scenario; returns the text that scenes of one family have in common.
std::string read_scenario(Row& row) {
  const RunRecord& c = *row.run;
  row.scene = row.name = c.header.scene;
  row.solver = c.header.solver;
  row.setting = c.header.setting;
  row.scenario = scenario_of(c);
  row.part = part_of(c, row.scenario);
  row.contact = touches(row.scenario);
  row.on_software = environment_text(c, "gpu") != "CPU" && environment_of(c, "gpu_is_software") == true;
  if (row.scenario.empty()) return row.scene;
  if (const std::string name = text_at(row.scenario, "/name"); !name.empty()) row.name = name;
  row.paper_table = row.scenario.value(json::json_pointer("/paper/table"), 0);
  row.sides = text_at(row.scenario, "/cloth/sides");
  json family = row.scenario;
  json& cloth = family["cloth"];
  if (const auto grid = cloth.find("grid"); grid != cloth.end()) {
    grid->get_to(row.resolution.grid);
    cloth.erase(grid);
  } else {
    row.resolution.vertices = c.header.vertices;
    for (const char* key : {"copies", "apart_m"})
      if (cloth.contains("mesh") && cloth["mesh"].contains("drawn")) cloth["mesh"]["drawn"].erase(key);
  }
  if (cloth.is_object()) cloth.erase("sides");
  return dump(family);
}

/// The words at the start of both names: "drop-scale" of "drop-scale-32" and "drop-scale-64".
std::string common_words(std::string a, std::string b) {
  a = "-" + a + "-";
  b = "-" + b + "-";
  a.erase(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first, a.end());
  a.erase(a.rfind('-'));
  return a.substr(std::min<std::size_t>(1, a.size()));
}

/// Adds what a run states about its scene's exact solution.
void add_facts(TruthFacts& t, const Row& r) {
  const std::string known = text_at(r.scenario, "/truth/case");
  t.ranking = known.empty() ? "RMS distance from the converged mean / L" : truth::tolerance_of(known).ranking;
  if (!std::isfinite(t.space_error)) t.space_error = r.value("truth_space_error");
  if (!std::isfinite(t.uncertainty)) t.uncertainty = r.value("reference_uncertainty");
  if (r.counts() && r.not_ranked().empty() && !is_baseline(r.solver) && !(t.best_error <= r.error()))
    t.best_error = r.error();
}

/// Marks the leading scenes: at most two, of different kinds.
void choose_leading(std::vector<Row>& rows) {
  constexpr std::size_t kMost = 2;
  std::map<std::size_t, std::string> leading;
  for (const Row& r : rows)
    if (r.part == Part::Contact) leading.try_emplace(place_of_scene(r.scene), r.scene);
  leading.erase(leading_scenes().size());
  while (leading.size() > kMost) leading.erase(std::prev(leading.end()));
  for (Row& r : rows)
    for (const auto& [unused, scene] : leading) r.leads = r.leads || (r.scene == scene && r.is_main());
}

/// A run's rank is one more than the number of other solvers' main runs whose whole interval lies below its own.
void compare_times(std::vector<Row>& all) {
  std::map<std::string, std::vector<Row*>> scenes;
  for (Row& r : all)
    if (r.published < 0) scenes[r.scene].push_back(&r);
  for (auto& [unused, rows] : scenes) {
    const Row* baseline = nullptr;
    std::vector<Row*> ranked;
    for (Row* r : rows) {
      const bool good = r->status() == "ok" && !r->times->wall.sorted.empty() && !r->on_software;
      if (good && r->solver == time_baseline() && r->setting == "default" && !baseline) baseline = r;
      const std::string v = verdict(*r->run);
      if (good && !is_floor(r->solver) && v != "fail" && v != "ignored" && !r->times->wall.uncertain() &&
          std::isfinite(r->times->wall.median.low) && r->repeat == 1 &&
          !(r->value("stretch_max_last_second") > kTornApart))
        ranked.push_back(r);
    }
    for (Row* r : rows) r->baseline = r->on_software ? nullptr : baseline;
    const auto is_rival = [&](const Row* r) { return r->solver != ranked.front()->solver; };
    if (std::none_of(ranked.begin(), ranked.end(), is_rival)) continue;
    for (Row* r : ranked)
      r->rank = 1 + static_cast<int>(std::count_if(ranked.begin(), ranked.end(), [&](const Row* other) {
                  return other->is_main() && other->times->wall.median.high < r->times->wall.median.low;
                }));
  }
}

/// Sets Row::elsewhere. A run of study `reproduction` counts once, on a GPU if there is one; its copies get no part.
void compare_devices(std::vector<Row>& rows) {
  const auto key = [](const Row& r) { return r.run->header.scenario_json + label_of(*r.run); };
  std::map<std::string, std::pair<const Row*, std::set<std::string>>> found;
  for (const Row& r : rows) {
    auto& [point, devices] = found[key(r)];
    devices.insert(environment_text(*r.run, "gpu"));
    if (point == nullptr || (point->on_software && !r.on_software)) point = &r;
  }
  for (Row& r : rows) {
    const auto& [point, devices] = found.at(key(r));
    r.elsewhere = r.published < 0 && devices.size() > 1;
    if (r.part == Part::Claims && point != &r) r.part = Part::None;
  }
}

}  // namespace

json scenario_of(const RunRecord& c) {
  return c.header.scenario_json.empty() ? json::object() : json_from(c.header.scenario_json);
}

json environment_of(const RunRecord& c, const char* key) {
  const json& e = c.header.environment;
  return e.is_object() ? e.value(key, json()) : json();
}

std::string environment_text(const RunRecord& c, const char* key) {
  const json e = environment_of(c, key);
  return e.is_string() ? e.get<std::string>() : "";
}

std::string device_of(const RunRecord& c) {
  const std::string gpu = environment_text(c, "gpu");
  return short_name(gpu == "CPU" ? environment_text(c, "cpu") : gpu);
}

std::string commit_of(const RunRecord& c) {
  const bool changed = environment_of(c, "git_dirty") == json(true);
  return environment_text(c, "git_commit").substr(0, 12) + (changed ? " (with local changes)" : "");
}

std::string folder_of(const RunRecord& c) { return std::filesystem::path(c.file).parent_path().filename().string(); }

std::string engine_of(const RunRecord& c) { return text_at(c.header.environment, "/plugin/engine"); }

const json& solver_roles() {
  static const json all = json_from(kSolverRoles);
  return all;
}

std::size_t place_of_scene(const std::string& scene) {
  std::size_t place = 0;
  while (place < leading_scenes().size() && scene.find(leading_scenes()[place].get<std::string>()) == std::string::npos)
    ++place;
  return place;
}

double nearest_rank(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return kMissing;
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

std::string ending(const Outcome& o) {
  return o.failed_frame < 0 ? o.status : fmt::format("{} at {}", o.status, o.failed_frame);
}

std::string status_with_class(const Outcome& o) {
  return o.status + (o.klass.empty() || o.klass == "ok" ? "" : " (" + o.klass + ")");
}

std::string label_of(const RunRecord& c) {
  const std::string& setting = c.header.setting;
  return c.header.solver + (setting == "default" || setting.empty() ? "" : " " + setting);
}

std::string Resolution::label() const {
  if (grid[0] > 0) return grid[0] == grid[1] ? fmt::format("{}²", grid[0]) : fmt::format("{}×{}", grid[0], grid[1]);
  return vertices > 0 ? fmt::format("{} vertices", vertices) : "–";
}

std::string TruthFacts::refused() const {
  if (!std::isfinite(uncertainty)) return "no reference solution";
  // The solution is known only to within its uncertainty; errors below the mesh's error are not ranked.
  if (!std::isfinite(best_error)) return "no run can be ranked";
  const double least = std::fmax(best_error, space_error);
  if (!(floor() < least)) return fmt::format("3 U_ref {:.1e} is not below {:.1e} (best or mesh error)", floor(), least);
  return "";
}

std::string Row::label() const {
  return (is_best ? solver + ", best" : label_of(*run)) + (repeat > 1 ? fmt::format(" ({})", repeat) : "");
}

std::string Row::frames_mark() const {
  return frames() > 0 && frames() < most_frames ? fmt::format("first {} frames", frames()) : "";
}

double Row::frame_rate_hz() const {
  const json rate = at(scenario, "/time/frame_rate_hz");
  return rate.is_number() ? rate.get<double>() : kMissing;
}

double Row::wall_ms_per_s() const {
  const double pipelined = 1e3 * frame_rate_hz() * value("frame_pipelined_median_s");
  return std::isfinite(pipelined) ? pipelined : 1e3 * frame_rate_hz() * value("frame_wall_median_s");
}

std::string Row::not_ranked() const {
  constexpr double kLeastDependence = 0.01;
  const json shear = at(scenario, "/material/shear");
  const char* Y = shear.is_boolean() && !shear.get<bool>() ? "strip_Y" : "sheet_Y";
  for (const json& l : at(run->header.plan, "/left_out")) {
    const std::string without = l.value("no_parameter", "");
    if ((without == Y && value("truth_dependence_Y") >= kLeastDependence) ||
        (without == "B" && value("truth_dependence_B") >= kLeastDependence))
      return "the run has no " + l.value("what", "") + ": " + l.value("why", "");
  }
  return "";
}

std::pair<double, double> Row::offset_m() const {
  std::pair<double, double> out = {kMissing, kMissing};
  if (status() == "unsupported" || status() == "missing") return out;
  const auto add = [&](const json& collider) {
    const double m = collider.value("margin_m", kMissing);
    out = {std::fmin(out.first, m), std::fmax(out.second, m)};
  };
  const json stated = at(run->header.plan, "/contact_margins"), colliders = at(scenario, "/colliders");
  std::set<std::string> names;
  for (const json& m : stated) {
    names.insert(m.value("collider", ""));
    add(m);
  }
  // A solver names colliders by type or by role; a list as long as the scene's list covers all of them.
  for (const json& c : colliders)
    if (stated.size() < colliders.size() && c.contains("margin_m") && !names.contains(c.value("type", ""))) add(c);
  return out;
}

std::string Row::trust() const {
  if (run->trials.empty()) return "";
  std::string out = jobs_of(*run) == 1 ? "alone" : "not alone";
  if (environment_of(*run, "window_s").is_number()) out += ", with pauses between frames";
  const double start = value("gpu_clock_start_Hz"), end = value("gpu_clock_end_Hz");
  if (end < kThrottled * start) out += fmt::format(", throttled ({:.0f} to {:.0f} MHz)", 1e-6 * start, 1e-6 * end);
  if (!std::isfinite(start) && !std::isfinite(value("cpu_clock_start_Hz"))) out += ", clocks not readable";
  const json load = environment_of(*run, "load_average");
  if (load.is_number()) out += fmt::format(", load {:.1f}", load.get<double>());
  if (times && times->wall.uncertain()) out += ", ~ wide interval";
  return out + in_brackets(frames_mark());
}

std::string Row::not_judged() const {
  if (!run->outcome.message.empty() || verdict(*run) != "not measured") return run->outcome.message;
  const double measured_s = run->accuracy.time_s.empty() ? 0 : run->accuracy.time_s.back();
  const json all_s = at(scenario, "/time/duration_s");
  return all_s.is_number() && measured_s < 0.999 * all_s.get<double>()
             ? fmt::format("the untimed run covers {:.3g} s of {:.3g} s", measured_s, all_s.get<double>())
             : "the program was built without contact metrics";
}

std::string Row::not_timed() const {
  if (!run->outcome.message.empty()) return run->outcome.message;
  return !run->withheld.empty() ? run->withheld.begin()->second : run->trials.empty() ? "not timed" : "";
}

json Row::drawn() const { return at(scenario, "/drawn"); }

bool has_contact(const RunRecord& c) { return touches(scenario_of(c)); }

RunTable::RunTable(std::vector<RunRecord> runs) : runs_(std::move(runs)) {
  std::map<std::string, std::string> owners, commons, families;  // first family of a name; words and name of a family
  std::map<std::vector<std::string>, int> repeats;
  std::map<std::string, std::shared_ptr<TruthFacts>> facts;
  std::set<std::string> timed;
  std::map<std::string, std::size_t> scenes;
  std::map<std::string, int> most_frames;
  std::map<std::string, std::set<double>> sizes;
  for (const RunRecord& c : runs_) {
    Row row{&c};
    row.times = std::make_shared<RunTimes>(times_of(c));
    row.family = read_scenario(row);
    if (row.part != Part::None) owners.try_emplace(row.name, row.family);
    std::string& common = commons.try_emplace(row.family, row.scene).first->second;
    common = common_words(common, row.scene);
    row.repeat = ++repeats[{row.family, row.scene, row.sides, row.solver, row.setting, row.resolution.label()}];
    if (row.value("frame_wall_median_s") > 0) timed.insert(row.scene);
    most_frames[row.scene] = std::max(most_frames[row.scene], row.frames());
    sizes[row.family].insert(row.resolution.size());
    rows_.push_back(std::move(row));
  }
  for (Row& r : rows_) {
    r.most_frames = most_frames[r.scene];
    r.largest = r.resolution.size() >= *sizes[r.family].rbegin();
    r.scaled = r.part == Part::Rates || (r.part == Part::Contact && sizes[r.family].size() > 1);
    const std::string& common = commons.at(r.family);
    const bool is_first = r.part == Part::None || owners.at(r.name) == r.family,
               differs = !common.empty() && common != r.name;
    const std::string other = differs ? common : r.name + in_brackets(folder_of(*r.run));
    r.family = std::string(families.try_emplace(r.family, is_first ? r.name : other).first->second);
    scenes.try_emplace(r.part == Part::Rates ? r.family : r.scene, scenes.size());
    // A pulled strip on which no solver was timed is listed with the scenes with contact.
    if (r.part == Part::Truth && text_at(r.scenario, "/truth/case") == "two-hand-pull" && !timed.contains(r.scene))
      r.part = Part::Contact;
    if (r.part != Part::Truth) continue;
    auto& shared = facts.try_emplace(r.scene, std::make_shared<TruthFacts>()).first->second;
    add_facts(*shared, r);
    r.truth = shared;
  }
  add_published();
  const auto key = [&](const Row& r) {
    const int sides = r.sides == "single" ? 0 : r.sides == "double-duplicated" ? 1 : 2;
    return std::tuple(scenes.at(r.part == Part::Rates ? r.family : r.scene), r.published, r.solver, r.setting, r.repeat,
                      sides, r.resolution.size());
  };
  std::stable_sort(rows_.begin(), rows_.end(), [&](const Row& a, const Row& b) { return key(a) < key(b); });
  compare_devices(rows_);
  mark_best_points(rows_);
  choose_leading(rows_);
  compare_times(rows_);
}

void RunTable::add_published() {
  const auto paper = std::find_if(rows_.begin(), rows_.end(),
                                  [](const Row& r) { return r.paper_table == 3 && r.part == Part::Rates; });
  if (paper == rows_.end()) return;
  const std::string family = paper->family, name = paper->name;
  const json published = published_table3();
  for (std::size_t k = 0; k < published["columns"].size(); ++k)
    for (std::size_t n = 0; n < published["resolution"].size(); ++n) {
      const json& column = published["columns"][k];
      RunRecord& c = published_.emplace_back();
      c.header.solver = "published: " + column.at("name").get<std::string>();
      c.header.setting = "default";
      c.summary["fps_at_72"] = column.at("fps").at(n);
      const int width = published["resolution"][n];
      rows_.push_back({.run = &c,
                       .name = name,
                       .family = family,
                       .solver = c.header.solver,
                       .setting = "default",
                       .sides = column.value("sides", ""),
                       .resolution = {{width, width}},
                       .paper_table = 3,
                       .published = static_cast<int>(k),
                       .scaled = true,
                       .times = std::make_shared<RunTimes>()});
    }
}

}  // namespace clothbench
