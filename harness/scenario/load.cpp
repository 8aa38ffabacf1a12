#include "scenario/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <tuple>

#include "base/files.hpp"
#include "base/words.hpp"
#include "clothbench/solver.hpp"
#include "clothbench/vector.hpp"
#include "scenario/cloth_mesh.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kMostVertices = 12'000'000;
constexpr double kMostFrames = 1e7;
constexpr std::size_t kMostName = 100;
constexpr std::size_t kShown = 200;  // bytes of an argument that a message shows

Pins read_pins(const json& list, const Cloth& c, const std::string& source) {
  std::set<std::uint32_t> pinned;
  for (std::size_t k = 0; k < list.size(); ++k)
    for (const std::uint32_t v : selected_vertices(c, list[k], source, fmt::format("/pins/{}", k))) pinned.insert(v);
  return {{pinned.begin(), pinned.end()}};
}

/// Reads the cloth's shape: a grid with its size, or a mesh.
void read_shape(json& j, Cloth& c, const std::string& source, const SceneParts& parts) {
  if (j.contains("mesh")) {
    for (const char* of_grids : {"grid", "size_m", "column_factors"})
      if (j.contains(of_grids))
        refuse(source, std::string("/cloth/") + of_grids, "expected a cloth that is a grid, not a mesh");
    c.mesh = parts.mesh(j["mesh"]);
    if (c.mesh->vertices.size() > kMostVertices)
      refuse(source, "/cloth/mesh",
             fmt::format("at most {} vertices; found {}", kMostVertices, c.mesh->vertices.size()));
    c.columns = static_cast<int>(c.mesh->vertices.size());
    c.rows = 1;
    std::tie(c.width_m, c.height_m) = longest_sides(*c.mesh);
    return;
  }
  for (const char* needed : {"grid", "size_m"})
    if (!j.contains(needed))
      refuse(source, "/cloth",
             std::string("\"") + needed + "\" is missing; expected \"grid\" and \"size_m\", or \"mesh\"");
  c.columns = j["grid"][0].get<int>();
  c.rows = j["grid"][1].get<int>();
  if (c.vertex_count() > kMostVertices)
    refuse(source, "/cloth/grid", fmt::format("at most {} vertices; found {}", kMostVertices, c.vertex_count()));
  c.width_m = j["size_m"][0].get<double>();
  c.height_m = j["size_m"][1].get<double>();
}

Cloth read_cloth(json& j, const std::string& source, const SceneParts& parts) {
  Cloth c;
  read_shape(j, c, source, parts);
  c.areal_density_kg_per_m2 = j["areal_density_kg_per_m2"].get<double>();
  const auto sides = j["sides"].get<std::string>();
  c.sides = sides == "single" ? Sides::Single : sides == "double" ? Sides::Double : Sides::DoubleDuplicated;
  c.center_m = vec3(j["pose"]["center_m"]);
  c.axis_u = vec3(j["pose"]["axis_u"]);
  c.axis_v = vec3(j["pose"]["axis_v"]);
  if (c.mesh)
    for (const char* of_grids : {"span_m", "drape", "over_table"})
      if (j["pose"].contains(of_grids))
        refuse(source, std::string("/cloth/pose/") + of_grids, "expected a cloth that is a grid, not a mesh");
  c.span_m = j["pose"].value("span_m", 0.0);
  if (!(c.span_m < c.width_m))
    refuse(source, "/cloth/pose/span_m", fmt::format("expected less than the width, {} m", c.width_m));
  if (c.span_m > 0 && c.columns < 3)
    refuse(source, "/cloth/grid/0", "expected at least 3 columns, for a sheet that starts bent");
  if (j["pose"].contains("drape")) {
    if (c.span_m > 0) refuse(source, "/cloth/pose/drape", "expected either span_m or drape");
    c.drape_radius_m = j["pose"]["drape"]["radius_m"].get<double>();
    c.drape_offset_m = j["pose"]["drape"].value("offset_m", 0.0);
    if (!(c.du() < 2 * c.drape_radius_m))
      refuse(source, "/cloth/pose/drape/radius_m", fmt::format("expected more than half a cell, {} m", c.du() / 2));
  }
  c.initial_velocity_m_per_s = vec3(j["initial_velocity_m_per_s"]);
  constexpr double kOrthonormal = 1e-9;
  for (const char* name : {"axis_u", "axis_v"}) {
    const Vec3 a = vec3(j["pose"][name]);
    if (!(std::abs(dot(a, a) - 1) <= kOrthonormal))
      refuse(source, std::string("/cloth/pose/") + name, "expected a vector of length 1");
  }
  if (!(std::abs(dot(c.axis_u, c.axis_v)) <= kOrthonormal))
    refuse(source, "/cloth/pose/axis_v", "expected a vector perpendicular to axis_u");
  return c;
}

/// Call after the cells are known: a thickness above the smallest height of a triangle would let a flat cloth touch
/// itself.
void read_self_collision(const json& cloth, Cloth& c, const std::string& source) {
  if (!cloth.contains("self_collision")) return;
  c.self_collision = {cloth["self_collision"]["thickness_m"].get<double>(),
                      cloth["self_collision"]["friction"].get<double>()};
  const double most = c.least_height_m();
  if (!(c.self_collision.thickness_m <= most))
    refuse(source, "/cloth/self_collision/thickness_m",
           fmt::format("expected at most the smallest height of a triangle, {:.6g} m, or the cloth would touch itself "
                       "where it lies flat; found {:.6g}",
                       most, c.self_collision.thickness_m));
}

/// The schema checks the names; this function checks that lower bounds are not above upper ones.
void read_expect(const json& j, Scene& s, const std::string& source) {
  for (const auto& [name, bounds] : j.items()) {
    if (name == "outcome") {
      s.expected_outcome = bounds.get<std::string>();
      continue;
    }
    Expectation e{name, {}, {}};
    if (bounds.contains("at_least")) e.at_least = bounds["at_least"].get<double>();
    if (bounds.contains("at_most")) e.at_most = bounds["at_most"].get<double>();
    if (e.at_least && e.at_most && *e.at_least > *e.at_most)
      refuse(source, "/expect/" + name, "expected at_least below or equal to at_most");
    s.expect.push_back(std::move(e));
  }
}

void read_truth(const json& truth, Scene& s, const std::string& source) {
  s.reference_case = truth.value("case", "");
  if (!truth.contains("converged")) return;
  if (s.cloth.mesh) refuse(source, "/truth/converged", "expected a cloth that is a grid, not a mesh");
  const json& c = truth["converged"];
  s.converged = {c["substeps"].get<int>(), c["starts"].get<int>(), c["nudge_m"].get<double>()};
  if (c.contains("fine_grid")) s.converged.fine_grid = c["fine_grid"].get<std::array<int, 2>>();
}

void check_assumed(const json& scenario, const std::string& source) {
  for (std::size_t k = 0; k < scenario["assumed"].size(); ++k) {
    const auto entry = scenario["assumed"][k].get<std::string>();
    if (entry[0] != '/') continue;
    bool found = false;
    try {
      found = scenario.contains(json::json_pointer(entry));
    } catch (const json::exception&) {
    }
    if (!found)
      refuse(source, fmt::format("/assumed/{}", k),
             in_quotes(entry) + ": expected the JSON pointer of a value in this scene");
  }
}

bool is_json(const std::filesystem::path& file) { return lower_case(file.extension().string()) == ".json"; }

/// All scenario files except schemas and assets: "paper/gravity", "studies/table3".
std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  std::error_code ec;
  for (std::filesystem::recursive_directory_iterator at(scenario_root(), ec), end; !ec && at != end; at.increment(ec)) {
    const std::filesystem::path name = at->path().lexically_relative(scenario_root()).replace_extension();
    const std::string folder = name.begin()->string();
    if (is_json(at->path()) && folder != "schema" && folder != "assets") names.push_back(name.string());
  }
  return names;
}

bool touches(const Scene& scene, Feature what) {
  return std::any_of(scene.colliders.begin(), scene.colliders.end(),
                     [&](const Collider& c) { return c.feature() == what; });
}

bool rubs(const Scene& scene) {
  return scene.cloth.self_collision.friction > 0 ||
         std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const Collider& c) { return c.friction > 0; });
}

/// Member `key` of an object, created if missing, or item `key` of an array.
json& child(json& of, const std::string& key, const std::string& where) {
  if (of.is_object() || of.is_null()) return of[key];
  if (!of.is_array()) throw Error(where + ": expected a key of an object");
  const bool number = !key.empty() && key.find_first_not_of("0123456789") == std::string::npos && key.size() < 6;
  if (!number || std::stoul(key) >= of.size())
    throw Error(fmt::format("{}: expected an item's number, 0 to {}", where, static_cast<long>(of.size()) - 1));
  return of[std::stoul(key)];
}

template <bool (*kTest)(const Collider&)>
bool any_collider(const Scene& s) {
  return std::any_of(s.colliders.begin(), s.colliders.end(), kTest);
}

bool touches(const Scene& s) { return !s.colliders.empty(); }
bool always(const Scene&) { return true; }
/// Stretched cloth springs back when a hand releases it, and then vibrates with little damping, which is no fault.
bool lets_go_of_nothing(const Scene& s) { return s.grips.vertices.empty(); }
bool meets_itself(const Scene& s) { return s.needs.has(Feature::SelfCollision); }

double upper_bound(const nlohmann::json& bounds) {
  return bounds.value("at_most", std::numeric_limits<double>::infinity());
}

}  // namespace

std::filesystem::path scenario_root() { return find_data(kScenarioFolder); }

std::filesystem::path find_scenario(const std::string& name_or_path) {
  std::error_code ec;
  if (std::filesystem::is_regular_file(name_or_path, ec)) return name_or_path;
  for (const char* folder : {"", "studies/"})
    for (const char* ending : {".json", ".JSON"}) {
      const std::filesystem::path named = scenario_root() / (folder + name_or_path + ending);
      if (std::filesystem::is_regular_file(named, ec)) return named;
    }
  if (std::filesystem::exists(name_or_path, ec)) return name_or_path;
  std::vector<std::string> names = scenario_names();
  for (std::string& known : names) {  // tables show the "name" in the file
    const std::filesystem::path file = scenario_root() / (known + ".json");
    if (known.starts_with("studies/")) known.erase(0, 8);
    const json scene = std::filesystem::is_regular_file(file, ec) ? json_or_discarded(read_text(file)) : json();
    if (scene.is_object() && scene.value("name", json()) == name_or_path) return file;
  }
  throw Error(fmt::format("{}: no such file, nor a scene or study of that name in {}{}",
                          shortened(name_or_path, kShown), scenario_root().string(),
                          nearest_known(name_or_path, names)));
}

FeatureSet derive_needs(const Scene& scene) {
  FeatureSet needs;
#define FEATURE(id, name, bit, of, doc, needed) \
  if (needed) needs.add(Feature::id);
#include "clothbench/feature_table.hpp"
#undef FEATURE
  return needs;
}

void apply_override(json& scenario, const std::string& assignment, const std::string& source) {
  const auto eq = assignment.find('=');
  if (eq == std::string::npos || eq == 0)
    throw Error("--set " + shortened(assignment, kShown) + ": expected key=value, such as cloth.grid=[64,64]");
  const std::string text = assignment.substr(eq + 1);
  const bool has_nan = text.find("NaN") != std::string::npos;
  json value = json_or_discarded(text);
  if (value.is_discarded() && (has_nan || text.empty()))
    throw Error("--set " + shortened(assignment, kShown) + ": expected a JSON value");
  if (value.is_discarded()) value = text;
  json* at = &scenario;
  std::string pointer;
  std::size_t i = 0;
  const std::string path = assignment.substr(0, eq);
  while (i <= path.size()) {
    const std::size_t dot_at = std::min(path.find('.', i), path.size());
    const std::string key = path.substr(i, dot_at - i);
    pointer += "/" + key;
    at = &child(*at, key, source + ": --set " + shortened(assignment, kShown) + ": " + shortened(pointer, kShown));
    i = dot_at + 1;
  }
  *at = std::move(value);
}

Scene scene_from_json(json scenario, const std::string& source, const std::vector<std::string>& overrides,
                      Assets assets) {
  for (const std::string& o : overrides) apply_override(scenario, o, source);
  return scene_from_parts(std::move(scenario), source,
                          {[&](json& mesh) { return read_cloth_mesh(mesh, source); },
                           [&](json& all, Scene& scene) { read_colliders(all, scene, source, assets); }});
}

Scene scene_from_parts(json scenario, const std::string& source, const SceneParts& parts) {
  validate_json(scenario, kSceneSchema, source);
  fill_defaults(scenario, kSceneSchema);
  check_assumed(scenario, source);

  Scene s;
  s.source = source;
  s.name = scenario["name"].get<std::string>();
  if (s.name.size() > kMostName)
    refuse(source, "/name",
           fmt::format("{} characters; expected at most {}, because names of result files contain it", s.name.size(),
                       kMostName));
  s.why = scenario["why"].get<std::string>();
  s.cloth = read_cloth(scenario["cloth"], source, parts);
  const json& material = scenario["material"];
  if (material["membrane_stiffness_N_per_m"].is_number())
    s.material.membrane_stiffness_N_per_m = material["membrane_stiffness_N_per_m"].get<double>();
  s.material.bending_rigidity_N_m = material["bending_rigidity_N_m"].get<double>();
  s.material.damping_per_s = material["damping_per_s"].get<double>();
  s.material.shear = material["shear"].get<bool>();
  read_irregular(scenario, s, source);
  read_self_collision(scenario["cloth"], s.cloth, source);
  s.pins = read_pins(scenario["pins"], s.cloth, source);
  s.gravity_m_per_s2 = vec3(scenario["gravity_m_per_s2"]);
  s.time.frame_rate_hz = scenario["time"]["frame_rate_hz"].get<double>();
  s.time.duration_s = scenario["time"]["duration_s"].get<double>();
  if (!(s.time.duration_s * s.time.frame_rate_hz <= kMostFrames))
    refuse(source, "/time/duration_s", fmt::format("expected at most {} frames", kMostFrames));
  if (s.time.frames() < 1) refuse(source, "/time/duration_s", "expected at least one frame");
  read_frame_times(scenario["time"], s, source);
  parts.colliders(scenario, s);
  read_stability(scenario, s);
  if (scenario.contains("seed")) s.seed = scenario["seed"].get<std::uint64_t>();
  if (scenario.contains("truth")) read_truth(scenario["truth"], s, source);
  s.needs = derive_needs(s);
  if (scenario.contains("expect")) {
    complete_expect(scenario["expect"], s, source);
    read_expect(scenario["expect"], s, source);
  }
  s.json = dump(scenario);
  s.sha256 = sha256(s.json);
  return s;
}

void scale_units(json& scenario, double length, double time) {
  static constexpr struct {
    const char* unit;
    int length, time;
  } kUnits[] = {{"_N_per_m", 2, -2}, {"_m_per_s2", 1, -2}, {"_m_per_s", 1, -1}, {"_per_s", 0, -1},
                {"_N_m", 4, -2},     {"_hz", 0, -1},       {"_m", 1, 0},        {"_s", 0, 1}};
  const std::function<void(json&, double)> multiply = [&](json& value, double by) {
    if (value.is_number()) value = by * value.get<double>();
    if (value.is_array())
      for (json& item : value) multiply(item, by);
  };
  if (!scenario.is_structured()) return;
  for (auto& [key, value] : scenario.items()) {
    scale_units(value, length, time);
    const auto unit = std::find_if(std::begin(kUnits), std::end(kUnits),
                                   [&name = key](const auto& u) { return name.ends_with(u.unit); });
    if (scenario.is_object() && unit != std::end(kUnits))
      multiply(value, std::pow(length, unit->length) * std::pow(time, unit->time));
  }
}

Scene load_scene(const std::string& name_or_path, const std::vector<std::string>& overrides, Assets assets) {
  const std::filesystem::path file = find_scenario(name_or_path);
  return scene_from_json(parse_json(read_text(file), file.string()), file.string(), overrides, assets);
}

std::vector<std::string> scene_names(const std::vector<std::string>& folders) {
  std::vector<std::string> all = scenario_names(), names;
  std::sort(all.begin(), all.end());
  for (const std::string& folder : folders)
    std::copy_if(all.begin(), all.end(), std::back_inserter(names),
                 [&](const std::string& name) { return name.starts_with(folder + "/"); });
  return names;
}

bool has_inside(const Collider& c) { return !c.mesh || c.mesh->closed || c.mesh->skinned(); }

const std::vector<StrictBound>& strict_contact() {
  static const std::vector<StrictBound> all = {{"crossings_max", 0, touches},
                                               {"contact_length_settled_m", 0, touches},
                                               {"contact_length_max_m", 0.005, touches},
                                               {"depth_max_m", 0.001, any_collider<has_inside>},
                                               {"self_contact_length_max_m", 0, meets_itself},
                                               {"pop_max_m", 0.025, lets_go_of_nothing},
                                               {"stretch_max", 0.5, always},
                                               {"stretch_max_end", 0.1, lets_go_of_nothing}};
  return all;
}

void complete_expect(nlohmann::json& expect, const Scene& scene, const std::string& source) {
  if (!expect.contains("contact")) return;
  if (scene.colliders.empty() && scene.grips.vertices.empty() && !meets_itself(scene))
    refuse(source, "/expect/contact", "\"strict\" is for scenes with colliders, grips or self_collision");
  expect.erase("contact");
  for (const StrictBound& b : strict_contact()) {
    if (!b.defined(scene)) continue;
    if (!expect.contains(b.scalar)) {
      expect[b.scalar] = {{"at_most", b.at_most}};
    } else if (!(upper_bound(expect[b.scalar]) <= b.at_most) && !expect[b.scalar].contains("why")) {
      refuse(source, std::string("/expect/") + b.scalar,
             fmt::format("expected \"why\", the reason for a bound looser than the strict one ({:g})", b.at_most));
    }
  }
}

}  // namespace clothbench
