#include "jolt/soft_body.hpp"

#include <map>

namespace clothbench::jolt {
namespace {

using Settings = JPH::SoftBodySharedSettings;
using peer::Kind;

float compliance(double stiffness) { return std::isinf(stiffness) ? 0.0F : static_cast<float>(1 / stiffness); }

using Pair = std::pair<std::uint32_t, std::uint32_t>;

Pair pair(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

Settings::Edge edge(const peer::Spring& p) {
  Settings::Edge e(p.a, p.b, compliance(p.stiffness_N_per_m));
  e.mRestLength = static_cast<float>(p.rest_m);
  return e;
}

double area(const std::vector<peer::Point>& rest, const std::uint32_t* v) {
  return peer::length(peer::cross(rest[v[1]] - rest[v[0]], rest[v[2]] - rest[v[0]])) / 2;
}

/// A hinge at every inner edge, of energy k/2 angle^2 with k = 3 B |e|^2 / A, A the area of its two triangles (Tamstorf
/// and Grinspun, Discrete Bending Forces and Their Jacobians, 2013, section 2).
void add_hinges(const ClothbenchScene& s, const std::vector<peer::Point>& rest, Settings& to) {
  std::map<Pair, std::uint32_t> first;  // an edge's first triangle
  for (std::uint32_t t = 0; t < s.triangle_count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t* v = s.triangles + 3 * t;
      const std::uint32_t a = v[k], b = v[(k + 1) % 3], apex = v[(k + 2) % 3];
      const auto [at, is_new] = first.try_emplace(pair(a, b), t);
      if (is_new) continue;
      const std::uint32_t* u = s.triangles + 3 * at->second;
      const std::uint32_t other = u[0] + u[1] + u[2] - a - b;
      const double l = peer::length(rest[b] - rest[a]);
      const double k_Nm = 3 * s.bending_rigidity_N_m * l * l / (area(rest, u) + area(rest, v));
      if (k_Nm > 0) to.mDihedralBendConstraints.push_back({a, b, other, apex, compliance(k_Nm)});
    }
}

/// What the engine makes of the faces itself, on a copy without anything else.
Settings created(const Settings& from, const Settings::VertexAttributes& attributes, Settings::EBendType bend) {
  Settings copy;
  copy.mVertices = from.mVertices;
  copy.mFaces = from.mFaces;
  copy.CreateConstraints(&attributes, 1, bend);
  return copy;
}

Settings::EBendType engines(BendType type) {
  if (type == BendType::Distance) return Settings::EBendType::Distance;
  return type == BendType::Dihedral ? Settings::EBendType::Dihedral : Settings::EBendType::None;
}

/// The engine's own constraints in its own order, which decides how well it converges: edges of the scene's springs get
/// their compliance, and diagonals without a spring go. Springs that the engine has no edge for come last.
void add_edges(const ClothbenchScene& s, const Bending& bending, Settings& to) {
  constexpr float kDiagonal = 2;  // marks the engine's diagonals
  const bool own = bending.compliance >= 0;
  const Settings all = created(to, {0.0F, kDiagonal, own ? static_cast<float>(bending.compliance) : FLT_MAX},
                               own ? engines(bending.type) : Settings::EBendType::None);
  std::map<Pair, Settings::Edge> springs;
  for (const peer::Spring& p : peer::springs(s)) {
    const bool wanted = p.kind != Kind::Bend || (!own && bending.type == BendType::Distance);
    if (wanted && p.stiffness_N_per_m > 0) springs[pair(p.a, p.b)] = edge(p);
  }
  for (const Settings::Edge& e : all.mEdgeConstraints) {
    const auto at = springs.find(pair(e.mVertex[0], e.mVertex[1]));
    if (at != springs.end()) {
      to.mEdgeConstraints.push_back(at->second);
      springs.erase(at);
    } else if (own && e.mCompliance == static_cast<float>(bending.compliance)) {
      to.mEdgeConstraints.push_back(e);
    }
  }
  for (const auto& [vertices, e] : springs) to.mEdgeConstraints.push_back(e);
  to.mDihedralBendConstraints = all.mDihedralBendConstraints;
}

void add_attachments(Settings& to, Attachments kind) {
  const auto type =
      kind == Attachments::Euclidean ? Settings::ELRAType::EuclideanDistance : Settings::ELRAType::GeodesicDistance;
  to.mLRAConstraints = created(to, {0.0F, 0.0F, FLT_MAX, type}, Settings::EBendType::None).mLRAConstraints;
}

}  // namespace

JPH::Ref<Settings> shared_settings(const ClothbenchScene& s, const Bending& bending, Attachments attachments) {
  JPH::Ref<Settings> out = new Settings;
  const std::vector<peer::Point> rest = peer::rest_points(s);
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) {
    JPH::Float3 at;
    to_engine(rest[v], {}).StoreFloat3(&at);
    out->mVertices.emplace_back(at, JPH::Float3(0, 0, 0), static_cast<float>(1 / s.mass_kg[v]));
  }
  for (std::uint32_t k = 0; k < s.pin_count; ++k) out->mVertices[s.pins[k]].mInvMass = 0;
  for (std::uint32_t t = 0; t < s.triangle_count; ++t)
    out->AddFace({s.triangles[3 * t], s.triangles[3 * t + 1], s.triangles[3 * t + 2]});
  add_edges(s, bending, *out);
  if (bending.compliance < 0 && bending.type == BendType::Dihedral && peer::needs(s, CLOTHBENCH_BEND))
    add_hinges(s, rest, *out);
  out->CalculateBendConstraintConstants();
  if (attachments != Attachments::None && s.pin_count > 0) add_attachments(*out, attachments);
  out->Optimize();
  return out;
}

}  // namespace clothbench::jolt
