#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

class IrregularReader {
 public:
  IrregularReader(const json& scenario, Scene& scene, const std::string& source)
      : j_(scenario), s_(scene), source_(source) {}

  void read() {
    const json& cloth = j_["cloth"];
    if (cloth.contains("spin_rad_per_s")) s_.cloth.spin_rad_per_s = vec3(cloth["spin_rad_per_s"]);
    if (cloth.contains("column_factors")) columns(cloth["column_factors"]);
    if (cloth.contains("mass_factors")) masses(cloth["mass_factors"]);
    if (cloth.contains("start")) start(cloth["start"]);
    if (j_["material"].contains("regions")) regions(j_["material"]["regions"]);
  }

 private:
  void columns(const json& list) {
    Cloth& c = s_.cloth;
    c.column_factors.assign(static_cast<std::size_t>(c.columns - 1), 1);
    for (std::size_t k = 0; k < list.size(); ++k) {
      const auto column = list[k]["column"].get<std::size_t>();
      if (column >= c.column_factors.size())
        refuse(source_, fmt::format("/cloth/column_factors/{}/column", k),
               fmt::format("cell {} of {} (the first is 0)", column, c.column_factors.size()));
      c.column_factors[column] = list[k]["factor"].get<double>();
    }
    for (std::size_t line = 0; line <= c.column_factors.size(); ++line) {
      const double left = line > 0 ? c.column_factors[line - 1] : 0,
                   right = line < c.column_factors.size() ? c.column_factors[line] : 0;
      if (!(left + right > 0))
        refuse(source_, "/cloth/column_factors",
               fmt::format("grid line {}: expected a cell of width above 0 next to it; its vertices would have no mass",
                           line));
    }
    if (c.span_m > 0)
      refuse(source_, "/cloth/pose/span_m", "expected columns of one width for a sheet that starts as an arc");
  }

  void masses(const json& list) {
    s_.cloth.mass_factors.assign(s_.cloth.vertex_count(), 1);
    for (std::size_t k = 0; k < list.size(); ++k)
      for (std::uint32_t v : selected_vertices(s_.cloth, list[k], source_, fmt::format("/cloth/mass_factors/{}", k)))
        s_.cloth.mass_factors[v] = list[k]["factor"].get<double>();
  }

  void start(const json& j) {
    Start& s = s_.cloth.start;
    constexpr std::array kShapes = {"rest", "sphere", "plane", "line", "point", "folded"};  // see Start::Shape
    s.shape = static_cast<Start::Shape>(std::find(kShapes.begin(), kShapes.end(), j["shape"]) - kShapes.begin());
    s.radius_m = j["radius_m"].get<double>();
    s.folds = j["folds"].get<int>();
    s.noise_m = j["noise_m"].get<double>();
    s.seed = j["seed"].get<std::uint64_t>();
    for (std::size_t k = 0; k < j["merge"].size(); ++k)
      s.merged.push_back(listed_vertices(s_.cloth, j["merge"][k], source_, fmt::format("/cloth/start/merge/{}", k)));
    for (std::size_t k = 0; k < j["move"].size(); ++k)
      s.moved.push_back({selected_vertices(s_.cloth, j["move"][k], source_, fmt::format("/cloth/start/move/{}", k)),
                         vec3(j["move"][k]["by_m"])});
  }

  StiffnessRegion region_of_grid(const json& r, const std::string& pointer) const {
    if (r.contains("group"))
      refuse(source_, pointer + "/group", "expected a cloth that is a mesh; a grid has \"columns\"");
    if (!r.contains("columns")) refuse(source_, pointer, "expected \"columns\"");
    StiffnessRegion region{r["columns"][0].get<int>(), r["columns"][1].get<int>(), {}};
    if (region.last < region.first || region.last > s_.cloth.columns - 2)
      refuse(source_, pointer + "/columns",
             fmt::format("expected the first and the last cell, 0 to {}, in this order", s_.cloth.columns - 2));
    return region;
  }

  StiffnessRegion region_of_mesh(const json& r, const std::string& pointer) const {
    if (r.contains("columns"))
      refuse(source_, pointer + "/columns", "expected a cloth that is a grid; a mesh has \"group\"");
    if (!r.contains("group")) refuse(source_, pointer, "expected \"group\"");
    const auto group = r["group"].get<std::string>();
    const std::vector<std::uint32_t>& in = group_vertices(s_.cloth, group, source_, pointer + "/group");
    const auto has = [&](std::uint32_t v) { return std::binary_search(in.begin(), in.end(), v); };
    StiffnessRegion region;
    const auto& triangles = s_.cloth.mesh->triangles;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      if (std::all_of(triangles[t].begin(), triangles[t].end(), has)) region.triangles.push_back(t);
    if (region.triangles.empty())
      refuse(
          source_, pointer + "/group",
          fmt::format("no triangle has all its vertices in the group \"{}\"; expected one that has triangles", group));
    return region;
  }

  void regions(const json& list) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      const json& r = list[k];
      const std::string pointer = fmt::format("/material/regions/{}", k);
      StiffnessRegion region = s_.cloth.mesh ? region_of_mesh(r, pointer) : region_of_grid(r, pointer);
      if (r["membrane_stiffness_N_per_m"].is_number())
        region.membrane_stiffness_N_per_m = r["membrane_stiffness_N_per_m"].get<double>();
      s_.material.regions.push_back(region);
    }
  }

  const json& j_;
  Scene& s_;
  const std::string& source_;
};

/// Element `n` of the van der Corput sequence in base 2, in [0, 1). Seeds are offsets of `n`, so no state is needed.
double scattered(std::uint64_t n) {
  double out = 0, half = 0.5;
  for (; n > 0; n >>= 1, half /= 2)
    if ((n & 1) != 0) out += half;
  return out;
}

}  // namespace

void read_irregular(const json& scenario, Scene& scene, const std::string& source) {
  IrregularReader(scenario, scene, source).read();
}

void read_frame_times(const json& time, Scene& scene, const std::string& source) {
  const bool hitch = time.contains("hitch"), jitter = time.contains("jitter");
  if (!hitch && !jitter) return;
  TimeSpan& span = scene.time;
  const int slow = hitch ? time["hitch"]["frame"].get<int>() : -1;
  if (hitch && slow >= span.frames())
    refuse(source, "/time/hitch/frame", fmt::format("expected one of {} frames (the first is 0)", span.frames()));
  std::vector<double> ends = {0};
  for (int f = 0; f < span.frames(); ++f) {
    double dt = span.dt();
    if (jitter) {
      const auto seed = time["jitter"]["seed"].get<std::uint64_t>();
      dt *= 1 +
            time["jitter"]["share"].get<double>() * (2 * scattered(static_cast<std::uint64_t>(f) + 1 + 97 * seed) - 1);
    }
    if (f == slow) dt = time["hitch"]["dt_s"].get<double>();
    ends.push_back(ends.back() + dt);
  }
  span.ends_s = std::move(ends);
}

void read_stability(const json& scenario, Scene& scene) {
  if (!scenario.contains("stability")) return;
  const json& j = scenario["stability"];
  StabilityRules& rules = scene.stability;
  rules.name = j["case"].get<std::string>();
  for (const json& c : j["judged"]) rules.judged |= 1u << (c.get<std::string>()[1] - '0');
  rules.when_relaxed = j["from"].get<std::string>() == "relaxed";
  rules.relax_s = j["relax_s"].get<double>();
  rules.settle_s = j["settle_s"].get<double>();
}

}  // namespace clothbench
