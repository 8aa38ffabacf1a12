#include <algorithm>
#include <cmath>
#include <map>

#include "assets/procedural.hpp"

namespace clothbench::assets {
namespace {

constexpr double kCoarse = 0.25, kFine = 0.05;  ///< edge lengths [m], walls and tables
constexpr double kSlab = 0.04, kLeg = 0.05;     ///< thickness of table tops and legs [m]

struct Block {
  Vector low, high;
};

struct Plan {
  const char *uuid, *stands_for;
  Vector centre;  ///< of the top's upper face
  double length_x, length_z;
};

// Heights and sizes are rounded from the two scanned tables.
const Plan kPlans[] = {{"procedural-low-table", "444c8313", {1.2, 0.45, -0.4}, 0.6, 1.1},
                       {"procedural-desk", "1088a241", {-1.4, 0.76, 0.2}, 0.75, 1.3}};

std::vector<Block> solids_of(const Plan& p) {
  const Vector half(p.length_x / 2, 0, p.length_z / 2);
  std::vector<Block> blocks = {{p.centre - half - Vector(0, kSlab, 0), p.centre + half}};
  for (double sx : {-1.0, 1.0})
    for (double sz : {-1.0, 1.0}) {
      const Vector outer = p.centre + Vector(sx * half.x(), -kSlab, sz * half.z());
      const Vector inner = Vector(outer.x() - sx * kLeg, 0, outer.z() - sz * kLeg);
      blocks.push_back({outer.cwiseMin(inner), outer.cwiseMax(inner)});
    }
  return blocks;
}

/// Grid lines of one axis through all block faces, between them no further apart than `kFine` over a table, else
/// `kCoarse`.
std::vector<double> grid_lines(int axis, double low, double high, const std::vector<Block>& blocks) {
  std::vector<double> faces = {low, high};
  for (const Block& b : blocks) faces.insert(faces.end(), {b.low[axis], b.high[axis]});
  std::sort(faces.begin(), faces.end());
  // Faces of legs and slab that ought to be one differ by rounding.
  faces.erase(std::unique(faces.begin(), faces.end(), [](double a, double b) { return b - a < kFine / 1000; }),
              faces.end());
  std::vector<double> lines;
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    const double middle = (faces[i] + faces[i + 1]) / 2;
    const bool fine = axis != 1 && std::any_of(blocks.begin(), blocks.end(), [&](const Block& b) {
                        return b.low[axis] < middle && middle < b.high[axis];
                      });
    const int parts = std::max(1, static_cast<int>(std::ceil((faces[i + 1] - faces[i]) / (fine ? kFine : kCoarse))));
    for (int k = 0; k < parts; ++k) lines.push_back(faces[i] + (faces[i + 1] - faces[i]) * k / parts);
  }
  lines.push_back(high);
  return lines;
}

/// The faces between free and solid cells of a grid, which is how a closed surface comes for nothing.
class CellRoom {
 public:
  CellRoom(const Block& room, const std::vector<Block>& solids) : solids_(solids), room_(room) {
    for (int k = 0; k < 3; ++k) lines_[k] = grid_lines(k, room.low[k], room.high[k], solids);
  }

  TriangleMesh surface() {
    std::array<int, 3> c{};
    for (c[0] = 0; c[0] < cells(0); ++c[0])
      for (c[1] = 0; c[1] < cells(1); ++c[1])
        for (c[2] = 0; c[2] < cells(2); ++c[2]) {
          if (!is_free(c)) continue;
          for (int axis = 0; axis < 3; ++axis)
            for (int step : {-1, 1}) {
              std::array<int, 3> beyond = c;
              beyond[axis] += step;
              if (!is_free(beyond)) add_face(c, axis, step);
            }
        }
    return std::move(mesh_);
  }

 private:
  int cells(int axis) const { return static_cast<int>(lines_[axis].size()) - 1; }

  bool is_free(const std::array<int, 3>& c) const {
    Vector middle;
    for (int k = 0; k < 3; ++k) {
      if (c[k] < 0 || c[k] >= cells(k)) return false;
      middle[k] = (lines_[k][static_cast<std::size_t>(c[k])] + lines_[k][static_cast<std::size_t>(c[k]) + 1]) / 2;
    }
    return std::none_of(solids_.begin(), solids_.end(), [&](const Block& b) {
      return (b.low.array() < middle.array()).all() && (middle.array() < b.high.array()).all();
    });
  }

  std::uint32_t vertex(const std::array<int, 3>& at) {
    const auto [place, is_new] = places_.try_emplace(at, static_cast<std::uint32_t>(mesh_.vertex_count()));
    if (is_new) {
      Vector p;
      for (int k = 0; k < 3; ++k) p[k] = lines_[k][static_cast<std::size_t>(at[k])];
      mesh_.add_vertex(p);
    }
    return place->second;
  }

  /// The normal points back into the free cell.
  void add_face(const std::array<int, 3>& cell, int axis, int step) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<int, 3> base = cell;
    if (step > 0) ++base[axis];
    std::array<std::array<int, 3>, 4> corner = {base, base, base, base};
    ++corner[1][u];
    ++corner[2][u], ++corner[2][v];
    ++corner[3][v];
    if (step > 0) std::swap(corner[1], corner[3]);
    std::array<std::uint32_t, 4> i{};
    for (std::size_t k = 0; k < 4; ++k) i[k] = vertex(corner[k]);
    mesh_.triangles.push_back({i[0], i[1], i[2]});
    mesh_.triangles.push_back({i[0], i[2], i[3]});
  }

  const std::vector<Block>& solids_;
  Block room_;
  std::array<std::vector<double>, 3> lines_;
  std::map<std::array<int, 3>, std::uint32_t> places_;
  TriangleMesh mesh_;
};

/// Three waves of unlike length and direction: rms 5 mm, at most 12 mm. The longest is below the tables' size.
double roughness(double x, double z) {
  return 0.0041 *
         (std::sin(9.1 * x + 4.7 * z) + std::sin(21.3 * z - 6.1 * x + 1.0) + std::sin(33.7 * x + 27.9 * z + 2.0));
}

}  // namespace

Room procedural_room() {
  Room room;
  room.name = "procedural";
  const Block walls{{-2.5, 0, -2}, {2.5, 2.5, 2}};
  std::vector<Block> solids;
  for (const Plan& plan : kPlans) {
    const auto blocks = solids_of(plan);
    solids.insert(solids.end(), blocks.begin(), blocks.end());
    Table table;
    table.uuid = plan.uuid;
    table.stands_for = plan.stands_for;
    // As in captures: the box's z is up, its top at z = 0.
    table.frame = Frame::Identity();
    table.frame.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    table.frame.translation() = plan.centre;
    const Eigen::Vector2d half(plan.length_x / 2, plan.length_z / 2);
    table.box = Box(Vector(-half.x(), -half.y(), -plan.centre.y()), Vector(half.x(), half.y(), 0));
    room.tables.push_back(table);
  }
  room.mesh = CellRoom(walls, solids).surface();
  for (std::size_t v = 0; v < room.mesh.vertex_count(); ++v) {
    const Vector p = room.mesh.vertex(v);
    for (const Plan& plan : kPlans)
      if (std::abs(p.y() - plan.centre.y()) < kSlab / 4 &&
          std::abs(p.x() - plan.centre.x()) <= plan.length_x / 2 + kSlab / 4 &&
          std::abs(p.z() - plan.centre.z()) <= plan.length_z / 2 + kSlab / 4)
        room.mesh.positions[3 * v + 1] += roughness(p.x(), p.z());
  }
  return room;
}

}  // namespace clothbench::assets
