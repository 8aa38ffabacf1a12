#include "report/mesh_grid.hpp"

#include <cmath>

#include "report/grid.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

constexpr const char *kTime = "frame_device_median_s", *kStretch = "stretch_mean_last_second";

auto of_grid(const char* name, double scale) {
  return [=](const MeshBesideGrid& m) { return scale * summary_value(*m.run, name); };
}
auto of_mesh(const char* name, double scale) {
  return [=](const MeshBesideGrid& m) { return scale * summary_value(*m.other, name); };
}

/// The fastest run of the pair's grid that is at most as stretched as its mesh.
const RunRecord* as_taut_as(const RunPair& p, const std::vector<RunRecord>& runs) {
  const RunRecord* best = nullptr;
  const double most = summary_value(*p.other, kStretch);
  for (const RunRecord& c : runs) {
    const RunHeader &its = c.header, &own = p.run->header;
    if (its.scenario_sha256 != own.scenario_sha256 || its.solver != own.solver || c.outcome.status != "ok") continue;
    if (!(summary_value(c, kStretch) <= most) || !(summary_value(c, kTime) > 0)) continue;
    if (best == nullptr || summary_value(c, kTime) < summary_value(*best, kTime)) best = &c;
  }
  return best;
}

Columns<MeshBesideGrid> columns() {
  const NumberFormat three = digits(3), two = digits(2);
  return {{"mesh", "mesh", [](auto& m) { return m.other->header.scene; }},
          {"grid", "grid", [](auto& m) { return m.run->header.scene; }},
          {"solver", "solver", [](auto& m) { return label_of(*m.run); }},
          {"vertices_mesh", "vertices, mesh", [](auto& m) { return m.other->header.vertices; }},
          {"vertices_grid", "grid", [](auto& m) { return m.run->header.vertices; }},
          {"device_ms_mesh", "GPU [ms], mesh", of_mesh(kTime, 1e3), three},
          {"device_ms_grid", "grid", of_grid(kTime, 1e3), three},
          {"device_ratio", "×", [](auto& m) { return m.value; }, three},
          {"stretch_mean_mesh_percent", "mean stretch [%], mesh", of_mesh(kStretch, 100), two},
          {"stretch_mean_grid_percent", "grid", of_grid(kStretch, 100), two},
          {"as_taut", "grid at most as stretched",
           [](auto& m) { return m.as_taut == nullptr ? std::string("–") : label_of(*m.as_taut); }},
          {"device_ratio_as_taut", "× of it", [](auto& m) { return m.ratio_as_taut(); }, three}};
}

}  // namespace

double MeshBesideGrid::ratio_as_taut() const {
  return as_taut == nullptr ? kMissing : summary_value(*other, kTime) / summary_value(*as_taut, kTime);
}

std::vector<MeshBesideGrid> meshes_beside_grids(const std::vector<RunRecord>& runs) {
  std::vector<MeshBesideGrid> out;
  for (RunPair& p : run_pairs(runs, "grid"))
    if (p.both_ok()) out.push_back({p, as_taut_as(p, runs)});
  return out;
}

Table mesh_grid_table(const std::vector<MeshBesideGrid>& rows) {
  return columns().table(
      {"Meshes beside grids",
       with_withheld("A triangle mesh and a grid of about as many vertices, of one material, at one setting. Stretch: "
                     "mean of the structural edges in the last second; edges shorter than at rest count as 0. All "
                     "edges of a mesh are structural, the diagonals of a grid are not. At most as stretched: the "
                     "solver's fastest setting on the grid whose mean stretch is not above that of the mesh.",
                     runs_of(rows, &MeshBesideGrid::run, &MeshBesideGrid::other), {kTime}),
       {}},
      rows);
}

std::string mesh_grid_csv(const std::vector<MeshBesideGrid>& rows) { return columns().csv(rows); }

}  // namespace clothbench
