#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "assets/assets.hpp"

namespace clothbench::assets {
namespace {

// A right hand in its palm frame, in metres and degrees, with rounded sizes of an adult's hand. The thumb is at -x.
struct Finger {
  std::size_t first;         ///< metacarpal joint
  double x_base, x_knuckle;  ///< x of the metacarpal and the proximal joint
  double y_knuckle;
  std::array<double, 3> bones;  ///< proximal, intermediate, distal (to the tip)
  std::array<double, 5> radius;
};
const Finger kFingers[] = {
    {kIndex, -0.016, -0.022, 0.030, {0.038, 0.023, 0.022}, {0.020, 0.010, 0.0085, 0.0075, 0.0065}},
    {kMiddle, 0.0, 0.0, 0.030, {0.043, 0.027, 0.025}, {0.020, 0.011, 0.0085, 0.0075, 0.0065}},
    {kRing, 0.016, 0.020, 0.025, {0.038, 0.026, 0.024}, {0.019, 0.010, 0.0080, 0.0070, 0.0060}},
    {kPinky, 0.026, 0.037, 0.013, {0.031, 0.020, 0.020}, {0.018, 0.0085, 0.0070, 0.0065, 0.0055}}};
const double kBaseY = -0.030;
const std::array<double, 3> kThumbBones = {0.031, 0.033, 0.025};
const std::array<double, 4> kThumbRadius = {0.019, 0.012, 0.010, 0.009};

/// Angles [degrees] of each finger's three joints, from index to little finger; the thumb's base and the directions of
/// its bones. In `pinch` the thumb is straight and ends at the tip of the index finger.
struct Bends {
  const char* name;
  std::array<std::array<double, 3>, 4> fingers;
  Vector thumb_base;
  std::array<Vector, 3> thumb;
};
const Bends kBends[] = {{"relaxed",
                         {{{2, 14, 4}, {0, 17, 2}, {-5, 16, 6}, {-4, 19, 1}}},
                         {-0.027, -0.030, -0.011},
                         {{{-0.64, 0.70, -0.32}, {-0.64, 0.74, -0.18}, {-0.54, 0.77, -0.34}}}},
                        {"pinch",
                         {{{65, 32, 8}, {19, 20, 1}, {-1, 22, 6}, {-10, 20, 2}}},
                         {-0.022, -0.028, -0.018},
                         {{{0, 0.735, -0.678}, {0, 0.735, -0.678}, {0, 0.735, -0.678}}}},
                        {"point",
                         {{{7, 7, -6}, {64, 81, 56}, {74, 84, 26}, {75, 89, 26}}},
                         {-0.028, -0.031, -0.009},
                         {{{-0.72, 0.68, -0.18}, {-0.60, 0.79, -0.12}, {-0.81, 0.57, -0.11}}}}};

/// A joint with -z along `bone` and +y as close to `back` as possible.
Frame joint_frame(const Vector& at, const Vector& bone, const Vector& back) {
  Frame frame = Frame::Identity();
  const Vector z = -bone.normalized();
  const Vector y = (back - back.dot(z) * z).normalized();
  frame.linear() << y.cross(z), y, z;
  frame.translation() = at;
  return frame;
}

/// Direction +y, rotated by `degrees` towards the palm.
Frame bent(const Vector& at, double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return joint_frame(at, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)});
}

HandPose make_pose(const Bends& bends) {
  HandPose pose;
  pose.joints[kWrist] = bent({0, -0.065, 0}, 0);
  pose.radius_m[kWrist] = 0.0215;
  for (std::size_t f = 0; f < 4; ++f) {
    const Finger& finger = kFingers[f];
    const Vector base(finger.x_base, kBaseY, 0), knuckle(finger.x_knuckle, finger.y_knuckle, 0);
    pose.joints[finger.first] = joint_frame(base, knuckle - base, Vector::UnitZ());
    Vector at = knuckle;
    double angle = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      angle += bends.fingers[f][k];
      pose.joints[finger.first + 1 + k] = bent(at, angle);
      at -= finger.bones[k] * pose.joints[finger.first + 1 + k].linear().col(2);
    }
    pose.joints[finger.first + 4] = bent(at, angle);
    for (std::size_t k = 0; k < 5; ++k) pose.radius_m[finger.first + k] = finger.radius[k];
  }
  const Vector thumb_back(-0.8, -0.5, 0.3);
  Vector at = bends.thumb_base;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector bone = bends.thumb[std::min<std::size_t>(k, 2)];
    pose.joints[kThumb + k] = joint_frame(at, bone, thumb_back);
    pose.radius_m[kThumb + k] = kThumbRadius[k];
    if (k < 3) at += kThumbBones[k] * bone.normalized();
  }
  return pose;
}

/// Adds a closed tube along joints first..last: a ring at each joint and half-way along each bone, round caps at both
/// ends.
class TubeMaker {
 public:
  explicit TubeMaker(SkinnedMesh& hand) : hand_(hand) {}

  void tube(const HandPose& pose, std::size_t first, std::size_t last) {
    cap(pose, first, -1);
    for (std::size_t j = first; j <= last; ++j) {
      ring(pose.joints[j], 0, pose.radius_m[j], j, j > first ? j - 1 : j);
      if (j == last) break;
      const double length = (pose.joints[j + 1].translation() - pose.joints[j].translation()).norm();
      ring(pose.joints[j], length / 2, (pose.radius_m[j] + pose.radius_m[j + 1]) / 2, j, j);
    }
    cap(pose, last, 1);
  }

 private:
  static constexpr std::uint32_t kSides = 12, kCapRings = 3;

  std::uint32_t vertex(const Vector& p, std::size_t a, std::size_t b) {
    hand_.rest.add_vertex(p);
    hand_.joints.push_back({static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), 0, 0});
    hand_.weights.push_back({0.5, 0.5, 0, 0});
    return static_cast<std::uint32_t>(hand_.rest.vertex_count() - 1);
  }

  /// Adds a ring at distance `along` the bone from a joint, and joins it to the previous ring.
  void ring(const Frame& joint, double along, double radius, std::size_t a, std::size_t b) {
    const auto start = static_cast<std::uint32_t>(hand_.rest.vertex_count());
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const double angle = 2 * std::numbers::pi * s / kSides;
      vertex(joint * Vector(radius * std::cos(angle), radius * std::sin(angle), -along), a, b);
    }
    auto& triangles = hand_.rest.triangles;
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const std::uint32_t t = (s + 1) % kSides;
      if (pole_) {
        triangles.push_back({*pole_, start + s, start + t});
      } else {
        triangles.push_back({before_ + s, start + t, before_ + t});
        triangles.push_back({before_ + s, start + s, start + t});
      }
    }
    pole_.reset();
    before_ = start;
  }

  void cap(const HandPose& pose, std::size_t j, int end) {
    const Frame& joint = pose.joints[j];
    const double radius = pose.radius_m[j];
    if (end < 0) pole_ = vertex(joint * Vector(0, 0, radius), j, j);
    for (std::uint32_t k = 1; k < kCapRings; ++k) {
      const double latitude = std::numbers::pi / 2 * (end < 0 ? kCapRings - k : k) / kCapRings;
      ring(joint, end * radius * std::sin(latitude), radius * std::cos(latitude), j, j);
    }
    if (end < 0) return;
    const std::uint32_t tip = vertex(joint * Vector(0, 0, -radius), j, j);
    for (std::uint32_t s = 0; s < kSides; ++s)
      hand_.rest.triangles.push_back({before_ + s, tip, before_ + (s + 1) % kSides});
  }

  SkinnedMesh& hand_;
  std::optional<std::uint32_t> pole_;
  std::uint32_t before_ = 0;
};

constexpr double kCoarse = 0.25, kFine = 0.05;  ///< edge lengths [m]: walls; tables
constexpr double kSlab = 0.04, kLeg = 0.05;     ///< thickness of table tops and legs [m]

struct Block {
  Vector low, high;
};

struct Plan {
  const char *uuid, *stands_for;
  Vector centre;  ///< centre of the top's upper face
  double length_x, length_z;
};

// Rounded heights and sizes of the two scanned tables.
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

/// Coordinates of grid lines along one axis: every block face, and lines between the faces. On a
/// horizontal axis, gaps over a block are at most `kFine`; all other gaps are at most `kCoarse`.
std::vector<double> grid_lines(int axis, double low, double high, const std::vector<Block>& blocks) {
  std::vector<double> faces = {low, high};
  for (const Block& b : blocks) faces.insert(faces.end(), {b.low[axis], b.high[axis]});
  std::sort(faces.begin(), faces.end());
  // Faces of legs and slab that should coincide differ by rounding errors.
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

/// Collects the faces between free and solid cells of a grid, which form a closed surface by construction.
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

  /// Adds a face whose normal points back into the free cell.
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

/// Sum of three waves of different lengths and directions, all shorter than the tables: rms 5 mm, peak 12.3 mm.
double roughness(double x, double z) {
  return 0.0041 *
         (std::sin(9.1 * x + 4.7 * z) + std::sin(21.3 * z - 6.1 * x + 1.0) + std::sin(33.7 * x + 27.9 * z + 2.0));
}

}  // namespace

Hand procedural_hand(Side side) {
  Hand hand;
  hand.side = side;
  for (const Bends& bends : kBends) {
    const HandPose right = make_pose(bends);
    hand.poses.emplace(bends.name, in_palm_frame(side == Side::Right ? right : mirrored(right)));
  }
  const HandPose& rest = hand.poses.at("relaxed");
  TubeMaker maker(hand.mesh);
  maker.tube(rest, kThumb, kThumb + 3);
  for (std::size_t first : {kIndex, kMiddle, kRing, kPinky}) maker.tube(rest, first, first + 4);
  for (std::size_t j = 0; j < kJointCount; ++j) hand.mesh.inverse_bind[j] = Eigen::Affine3d(rest.joints[j].inverse());
  return hand;
}

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
    // As in captures: the box's z is up, and its top is at z = 0.
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
