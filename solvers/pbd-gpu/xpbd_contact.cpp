#include "xpbd_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>

namespace clothbench::pbd_gpu {
namespace {

/// Least margin as a share of the cells' size: 0.16 mm for a cloth of 0.5 m and 32 vertices. It keeps the side of a
/// vertex distinct in spite of the rounding of its position. A larger one holds the cloth off visibly.
constexpr double kLeastMargin = 0.01;

/// Least margin round an open border, as a share of the greatest spacing of contact points on an edge. A straight edge
/// needs 1/2 to stay off the border; an edge bent round it at a right angle needs 1/sqrt(2). The latter also keeps the
/// corner of a sheet off the middle of a cell, where there is no contact point.
constexpr double kBorder = 0.72;

/// Cosine of 15 degrees, the angle between two triangles' normals above which their edge is sharp.
constexpr double kFlatTurn = 0.966;

/// Half the thickness of a fingertip.
constexpr double kFinger_m = 0.008;

/// Words of a mask with one bit for each word of the cluster mask.
constexpr std::uint32_t blocks_of(std::size_t words) { return static_cast<std::uint32_t>((words + 31) / 32); }

double longer_side(const Cloth& c) { return std::max(c.du(), c.dv()); }

void split(const std::vector<Vec3>& centroids, std::vector<std::uint32_t>::iterator first,
           std::vector<std::uint32_t>::iterator last, std::vector<std::uint32_t>& sizes) {
  const auto count = static_cast<std::size_t>(last - first);
  if (count <= Clusters::kClusterSize) {
    if (count > 0) sizes.push_back(static_cast<std::uint32_t>(count));
    return;
  }
  Vec3 low = centroids[*first], high = low;
  for (auto t = first; t != last; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], centroids[*t][k]);
      high[k] = std::max(high[k], centroids[*t][k]);
    }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  // Ties are broken by index, so that clusters are the same on every machine.
  const auto middle = first + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(first, middle, last, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(centroids[a][axis], a) < std::pair(centroids[b][axis], b);
  });
  std::sort(first, middle);
  std::sort(middle, last);
  split(centroids, first, middle, sizes);
  split(centroids, middle, last, sizes);
}

}  // namespace

std::vector<std::uint32_t> edge_marks(const std::vector<double>& positions,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  // Scans and hands repeat vertices along texture seams, so vertices at one position count as one.
  std::map<Vec3, std::uint32_t> places;
  std::vector<std::uint32_t> place;
  for (std::size_t v = 0; v < positions.size(); v += 3)
    place.push_back(
        places
            .try_emplace({positions[v], positions[v + 1], positions[v + 2]}, static_cast<std::uint32_t>(places.size()))
            .first->second);
  const auto opposite = [&](const std::array<std::uint32_t, 3>& t, std::size_t k) {
    return std::minmax(place[t[(k + 1) % 3]], place[t[(k + 2) % 3]]);
  };
  const auto normal = [&](const std::array<std::uint32_t, 3>& t) {
    const auto side = [&](std::size_t to, std::size_t k) { return positions[3 * t[to] + k] - positions[3 * t[0] + k]; };
    const Vec3 n = {side(1, 1) * side(2, 2) - side(1, 2) * side(2, 1),
                    side(1, 2) * side(2, 0) - side(1, 0) * side(2, 2),
                    side(1, 0) * side(2, 1) - side(1, 1) * side(2, 0)};
    const double l = std::hypot(n[0], n[1], n[2]);
    return Vec3{n[0] / l, n[1] / l, n[2] / l};
  };
  struct Meeting {
    int triangles = 0;
    Vec3 normal{};
    bool sharp = false;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Meeting> meetings;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      Meeting& m = meetings[opposite(t, k)];
      const Vec3 n = normal(t);
      // A triangle without area has no normal; its edges count as sharp, to be safe.
      if (m.triangles++ == 0)
        m.normal = n;
      else if (!(n[0] * m.normal[0] + n[1] * m.normal[1] + n[2] * m.normal[2] >= kFlatTurn))
        m.sharp = true;
    }
  std::vector<std::uint32_t> bits(triangles.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Meeting& m = meetings[opposite(triangles[t], k)];
      if (m.triangles == 1) bits[t] |= 1u << k;
      if (m.sharp) bits[t] |= 8u << k;
    }
  return bits;
}

std::uint32_t samples_needed(const Scene& scene, int wanted) {
  const double du = scene.cloth.du(), dv = scene.cloth.dv(), squared = du * du + dv * dv;
  const auto needed = [&](const Collider& c) {
    if (c.shape == Collider::Shape::Plane) return false;
    // Height over a chord of length l of a circle of radius r: l^2 / 8r for l well below r; twice that if the cloth is
    // stretched by half.
    return c.shape != Collider::Shape::Sphere || !(2 * squared / (8 * c.radius_m) <= c.margin_m);
  };
  if (std::none_of(scene.colliders.begin(), scene.colliders.end(), needed)) return 0;
  if (wanted >= 0) return static_cast<std::uint32_t>(wanted);
  double finger = std::numeric_limits<double>::infinity();
  for (const Collider& c : scene.colliders) {
    if (!c.moves()) continue;
    if (c.mesh) finger = std::min(finger, kFinger_m + c.margin_m);
    for (const Capsule& s : c.capsules) finger = std::min(finger, s.radius_m + c.margin_m);
  }
  // If points are a distance p apart, the nearest one is up to half a diagonal away; twice that where the cloth is
  // stretched.
  const double hole = std::sqrt(2.0) * std::max(du, dv);
  std::uint32_t samples = 1;
  while (samples < 7 && hole / (samples + 1) > finger) samples = 2 * samples + 1;
  return samples;
}

Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Vec3> centroids;
  for (const auto& t : triangles) {
    Vec3& c = centroids.emplace_back(Vec3{});
    for (const std::uint32_t v : t)
      for (std::size_t k = 0; k < 3; ++k) c[k] += positions[3 * v + k] / 3;
  }
  Clusters result;
  result.triangles.resize(triangles.size());
  std::iota(result.triangles.begin(), result.triangles.end(), 0u);
  split(centroids, result.triangles.begin(), result.triangles.end(), result.sizes);
  return result;
}

XpbdContact::XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers& colliders,
                         int samples)
    : frame_(frame), scene_(scene), colliders_(colliders), samples_(samples_needed(scene, samples)) {
  if (samples == 0) frame_.leave_out("contact samples", "setting contact_samples=0");
  if (samples != 0 && samples_ == 0)
    frame_.leave_out("contact samples", "no edge of the cloth reaches between two vertices");
  const FeatureSet meshes = scene.needs & FeatureSet{Feature::StaticMesh, Feature::MovingMesh};
  if (meshes.empty())
    frame_.leave_out("BroadPhase", "the scene has no mesh to collide with");
  else
    stage_broad_ = frame_.add_stage("BroadPhase", meshes);
  stage_contact_ = frame_.add_stage(
      "Contact", scene.needs & (kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided}), true);
  // A margin much thinner than the cells is below float resolution. (The margin round open borders is larger still.)
  const double least = kLeastMargin * std::min(scene.cloth.du(), scene.cloth.dv());
  std::vector<double> margins;
  for (const Collider& c : scene.colliders) margins.push_back(std::max(c.margin_m, least));
  frame_.set_contact_margins(std::move(margins));
  add_sides(origin_m);
  if (!meshes.empty()) add_meshes();
  add_kernels();
}

void XpbdContact::add_sides(Vec3 origin_m) {
  const std::vector<double> start = initial_positions(scene_);
  const std::size_t n = scene_.cloth.vertex_count(), columns = static_cast<std::size_t>(scene_.cloth.columns);
  std::vector<vec4> side, sample_side(3 * samples_ * n, vec4{});
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = [&](std::size_t k) { return static_cast<float>(start[3 * i + k] - origin_m[k]); };
    side.push_back({at(0), at(1), at(2), 0});
  }
  frame_.add_buffer(BIND_SIDES, "contact sides", side);
  if (samples_ == 0) return;
  const std::size_t steps[] = {1, columns, columns + 1};
  for (std::size_t f = 0; f < 3 * samples_; ++f)
    for (std::size_t i = 0; i + steps[f / samples_] < n; ++i) {
      const vec4 &a = side[i], &b = side[i + steps[f / samples_]];
      const float t = static_cast<float>(f % samples_ + 1) / static_cast<float>(samples_ + 1);
      sample_side[f * n + i] = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z), 0};
    }
  frame_.add_buffer(BIND_SAMPLE_SIDES, "contact sides of samples", sample_side);
  frame_.add_buffer(BIND_CORRECTIONS, "contact corrections", 2 * sample_side.size() * sizeof(vec4));
}

void XpbdContact::add_meshes() {
  std::vector<MeshCluster> clusters;
  std::vector<ClusterBox> boxes;
  std::vector<uvec4> triangles;
  for (const bool moving : {false, true}) {
    const MeshBuffers& meshes = moving ? colliders_.moving : colliders_.standing;
    const auto clusters_before = static_cast<std::uint32_t>(clusters.size());
    const std::size_t triangles_before = triangles.size();
    for (const MeshRange& range : meshes.ranges) {
      const ColliderMesh& mesh = *scene_.colliders[range.collider].mesh;
      const std::vector<double> at =
          moving ? posed_positions(mesh, scene_.motion.at(0).colliders.at(range.collider)) : mesh.positions;
      const Clusters c = cluster(at, mesh.triangles);
      const std::vector<std::uint32_t> marks = edge_marks(at, mesh.triangles);
      std::size_t next = 0;
      for (const std::uint32_t size : c.sizes) {
        clusters.push_back({static_cast<uint>(triangles.size()), size, range.margin_m, range.friction});
        constexpr float kFar = std::numeric_limits<float>::max();
        float low[3] = {kFar, kFar, kFar}, high[3] = {-kFar, -kFar, -kFar};
        for (const std::size_t end = next + size; next < end; ++next) {
          const auto& t = mesh.triangles[c.triangles[next]];
          triangles.push_back({range.first_vertex + t[0], range.first_vertex + t[1], range.first_vertex + t[2],
                               marks[c.triangles[next]]});
          for (const std::uint32_t v : t)
            for (std::size_t k = 0; k < 3; ++k) {
              const auto x = static_cast<float>(at[3 * v + k] - colliders_.origin_m()[k]);
              low[k] = std::min(low[k], x);
              high[k] = std::max(high[k], x);
            }
        }
        boxes.push_back({{low[0], low[1], low[2], 0}, {high[0], high[1], high[2], 0}});
      }
    }
    (moving ? moving_clusters_ : standing_clusters_) = static_cast<std::uint32_t>(clusters.size()) - clusters_before;
    if (moving) moving_triangles_ = static_cast<std::uint32_t>(triangles.size() - triangles_before);
  }
  const std::size_t n = scene_.cloth.vertex_count(), words = (clusters.size() + 31) / 32;
  frame_.add_buffer(BIND_CLUSTERS, "collider clusters", clusters);
  frame_.add_buffer(BIND_CLUSTER_BOXES, "collider cluster boxes", boxes);
  frame_.add_buffer(BIND_TRIANGLES, "collider triangles", triangles);
  frame_.add_buffer(BIND_CANDIDATES, "contact candidates", n * (words + blocks_of(words)) * 4);
  frame_.add_buffer(BIND_REACHES, "contact reaches", (n + 1) * sizeof(vec4));
}

void XpbdContact::add_kernels() {
  const ColliderBuffers& c = colliders_;
  lanes_ = lanes();
  ContactSpecialization s;
  s.PLANES = c.planes.count;
  s.SPHERES = c.spheres.count;
  s.BOXES = c.boxes.count;
  s.CAPSULES = c.capsules.count;
  s.FRICTION = scene_.needs.has(Feature::Friction) ? 1 : 0;
  s.STANDING_CLUSTERS = standing_clusters_;
  s.MOVING_CLUSTERS = moving_clusters_;
  s.SAMPLES = samples_;
  s.MOVING = scene_.motion.empty() ? 0 : 1;
  s.LANES = lanes_;
  const std::string shuffles = lanes_ > 1 ? "_shuffle" : "", variant = (meshes() ? "_mesh" : "") + shuffles;
  constexpr auto kPush = static_cast<std::uint32_t>(sizeof(ContactConstants));
  if (moving_clusters_ > 0) find_boxes_ = frame_.add_kernel(stage_broad_, "contact_boxes", sizeof(BoxConstants));
  if (meshes())
    find_candidates_ = frame_.add_kernel(stage_broad_, "contact_candidates" + shuffles, kPush, s.by_number());
  if (samples_ > 0) sample_ = frame_.add_kernel(stage_contact_, "contact_samples" + variant, kPush, s.by_number());
  vertices_ = frame_.add_kernel(stage_contact_, "contact_vertices" + variant, kPush, s.by_number());
}

/// One thread runs the proximity query of a point where threads are few or a CPU's lanes compute one point each. The
/// points of a small cloth do not fill a discrete GPU; there one thread would read triangle after triangle, each read
/// waiting for the previous one.
std::uint32_t XpbdContact::lanes() const {
  const vulkan::Device& d = *frame_.device();
  const auto request = frame_.tuning()["contact_lanes"].get<std::uint32_t>();
  const std::uint32_t most =
      frame_.counts_bytes() || !frame_.tuning()["shuffles"].get<bool>() ? 1 : std::max(1u, d.shuffled_lanes());
  if (request != 0) return std::min(request, most);
  if (!d.is_discrete()) return 1;
  constexpr std::uint32_t kMeshLanes = 16, kShapeLanes = 8;
  const ColliderBuffers& c = colliders_;
  const std::uint32_t shapes = c.planes.count + c.spheres.count + c.boxes.count + c.capsules.count;
  return std::min(most, meshes() ? kMeshLanes : shapes >= kShapeLanes ? kShapeLanes : 1);
}

ContactConstants XpbdContact::constants(double dt_s, int substeps) const {
  const Cloth& c = scene_.cloth;
  const Vec3 g = scene_.gravity_m_per_s2;
  ContactConstants k{};
  k.columns = static_cast<uint>(c.columns);
  k.rows = static_cast<uint>(c.rows);
  k.words = (standing_clusters_ + moving_clusters_ + 31) / 32;
  k.part = static_cast<float>(1.0 / substeps);
  k.frames_per_s = static_cast<float>(1 / dt_s);
  k.least_margin_m = static_cast<float>(kLeastMargin * std::min(c.du(), c.dv()));
  k.border_margin_m = static_cast<float>(kBorder * std::hypot(c.du(), c.dv()) / (samples_ + 1));
  // Neighbours may push a vertex at rest by a cell's length a frame, plus the displacement by gravity.
  k.reach_m = static_cast<float>(longer_side(c) + std::hypot(g[0], g[1], g[2]) * dt_s * dt_s);
  // Half a diagonal to the middle of an edge; as much again because the sample may lag or the edge be stretched.
  k.sample_reach_m = samples_ > 0 ? static_cast<float>(std::hypot(c.du(), c.dv())) : 0.0f;
  return k;
}

void XpbdContact::record_frame(double dt_s, int substeps) {
  if (!meshes()) return;
  const double n = static_cast<double>(scene_.cloth.vertex_count()), all = standing_clusters_ + moving_clusters_,
               t = moving_triangles_, moving = moving_clusters_;
  if (find_boxes_ != nullptr)
    frame_.dispatch(*find_boxes_, moving_clusters_, BoxConstants{standing_clusters_, moving_clusters_},
                    {16 * moving + 112 * t, 32 * moving});
  const ContactConstants k = constants(dt_s, substeps);
  frame_.dispatch(*find_candidates_, lanes_ * scene_.cloth.vertex_count(), k,
                  {n * (32 + 16 * moving + 48 * all), 16 + n * (16 + 4.0 * (k.words + blocks_of(k.words)))});
}

void XpbdContact::record_substep(int s, int substeps, double dt_s) {
  ContactConstants k = constants(dt_s, substeps);
  k.begin = static_cast<float>(static_cast<double>(s) / substeps);
  const std::vector<float>& w = frame_.inverse_mass_now();
  const std::size_t n = w.size(), columns = k.columns, rows = k.rows;
  // Traffic for any shape of the cloth; colliders that come near add to it.
  const double shapes = 32.0 * colliders_.planes.count + 32.0 * colliders_.spheres.count +
                        80.0 * colliders_.boxes.count + 64.0 * colliders_.capsules.count;
  // Later in a frame only vertices that came near a collider search again.
  const bool has_meshes = meshes();
  const double look = s == 0 ? shapes + (has_meshes ? 4.0 * blocks_of(k.words) : 0.0) : 0.0;
  const double ways = (colliders_.capsules.count > 0 ? 16 : 0) + (has_meshes && !scene_.motion.empty() ? 16 : 0);
  const double around = look + ways + (has_meshes ? 16 : 0);
  if (samples_ > 0) {
    Traffic t;
    for (std::size_t family = 0; family < 3; ++family)
      for (std::size_t i = 0; i < n; ++i) {
        const bool right = family != 1, down = family != 0;
        if ((right && i % columns + 1 == columns) || (down && i / columns + 1 == rows)) continue;
        const bool any_free = w[i] > 0 || w[i + (right ? 1 : 0) + (down ? columns : 0)] > 0;
        t.read_B += samples_ * (32 + (any_free ? 80 + around : 0.0));
        t.write_B += samples_ * (any_free ? 48.0 : 0.0);
      }
    frame_.dispatch(*sample_, lanes_ * 3 * samples_ * n, k, t);
  }
  Traffic t;
  for (std::size_t i = 0; i < n; ++i) {
    const double right = i % columns + 1 < columns, left = i % columns > 0, down = i / columns + 1 < rows,
                 up = i / columns > 0;
    const double beside = samples_ * (right + left + down + up + right * down + left * up);
    t.read_B += 16 + (w[i] > 0 ? 32 + 16 * beside + around : 0.0);
    t.write_B += w[i] > 0 ? 48 : 16;
  }
  frame_.dispatch(*vertices_, lanes_ * n, k, t);
}

}  // namespace clothbench::pbd_gpu
