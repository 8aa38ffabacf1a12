/// The engine's fabric of a sheet: its constraints, sorted into phases, with the stiffness of each.
#pragma once

#include <NvCloth/Fabric.h>
#include <NvClothExt/ClothFabricCooker.h>

#include "nvcloth/colliders.hpp"
#include "nvcloth/engine.hpp"

namespace clothbench::nvcloth {

template <typename T>
void describe(nv::cloth::BoundedData& to, const T* from, std::size_t count, std::size_t per_item = 1) {
  to.data = from;
  to.count = static_cast<physx::PxU32>(count);
  to.stride = static_cast<physx::PxU32>(per_item * sizeof(T));
}

/// Passes the sheet at rest to the cooker: quads of a grid, triangles of a mesh.
inline void cook_mesh(nv::cloth::ClothFabricCooker& cooker, const ClothbenchScene& s,
                      const std::vector<double>& inverse_mass) {
  std::vector<PxVec3> points;
  for (const Point& p : peer::rest_points(s)) points.push_back(to_engine(p, 0).getXYZ());
  const std::vector<float> weights(inverse_mass.begin(), inverse_mass.end());
  std::vector<std::uint32_t> cells;
  for (std::uint32_t j = 0; j + 1 < s.rows; ++j)
    for (std::uint32_t i = 0; i + 1 < s.columns; ++i) {
      const std::uint32_t a = j * s.columns + i;
      cells.insert(cells.end(), {a, a + 1, a + 1 + s.columns, a + s.columns});
    }
  nv::cloth::ClothMeshDesc mesh;
  describe(mesh.points, points.data(), points.size());
  describe(mesh.invMasses, weights.data(), weights.size());
  if (cells.empty())
    describe(mesh.triangles, s.triangles, s.triangle_count, 3);
  else
    describe(mesh.quads, cells.data(), cells.size() / 4, 4);
  require(cooker.cook(mesh, PxVec3(0, 1, 0), true) ? &cooker : nullptr, "ClothFabricCooker::cook");
}

struct Cooked {
  nv::cloth::Fabric* fabric = nullptr;
  std::vector<nv::cloth::PhaseConfig> phases;  ///< phases that the scene needs, with their stiffness
  Cooked() = default;
  ~Cooked() {
    if (fabric != nullptr) fabric->decRefCount();
  }
  Cooked(const Cooked&) = delete;
  Cooked& operator=(const Cooked&) = delete;
};

/// Makes the fabric of the sheet at rest. `NvClothExt`'s cooker sorts constraints into phases: vertical and horizontal
/// edges, diagonals, and pairs two edges apart for bending; tethers lead to pins. Phases that no spring of the scene
/// needs are omitted. The stiffness of a constraint is the fraction of its error that one iteration removes, W k h^2 /
/// (1 + W k h^2), W: sum of inverse masses, k: spring stiffness. Each iteration here is a whole step of h, so this is
/// equivalent to compliance 1 / k (Macklin et al., XPBD, 2016, eq. 18 with lambda = 0).
inline std::shared_ptr<const Cooked> cook(nv::cloth::Factory& factory, const ClothbenchScene& s, bool tethers,
                                          double iteration_s) {
  const std::vector<double> inverse_mass = peer::inverse_masses(s);
  const auto free = [](nv::cloth::ClothFabricCooker* cooker) { NV_CLOTH_DELETE(cooker); };
  const std::unique_ptr<nv::cloth::ClothFabricCooker, decltype(free)> cooker(NvClothCreateFabricCooker(), free);
  cook_mesh(*cooker, s, inverse_mass);
  const nv::cloth::CookedData data = cooker->getCookedData();
  std::map<peer::Pair, double> stiffness;
  for (const peer::Spring& p : peer::springs(s)) stiffness[peer::pair(p.a, p.b)] = p.stiffness_N_per_m;
  const auto error_fraction = [&](std::uint32_t a, std::uint32_t b) {
    const auto spring = stiffness.find(peer::pair(a, b));
    if (spring == stiffness.end()) return 0.0;
    if (std::isinf(spring->second)) return 1.0;
    const double x = (inverse_mass[a] + inverse_mass[b]) * spring->second * iteration_s * iteration_s;
    return x / (1 + x);
  };
  auto out = std::make_shared<Cooked>();
  std::vector<float> each(data.mRestvalues.size(), 0);  // log2 of the fraction of the error that one iteration leaves
  bool even = true;
  for (std::uint32_t phase = 0; phase < data.mPhaseIndices.size(); ++phase) {
    const std::uint32_t set = data.mPhaseIndices[phase];
    double low = 1, high = 0;
    for (std::uint32_t k = set == 0 ? 0 : data.mSets[set - 1]; k < data.mSets[set]; ++k) {
      const std::uint32_t a = data.mIndices[2 * k], b = data.mIndices[2 * k + 1];
      const double share = error_fraction(a, b);
      each[k] = static_cast<float>(std::max(std::log2(1 - share), -1e30));
      if (inverse_mass[a] > 0 && inverse_mass[b] > 0) low = std::min(low, share), high = std::max(high, share);
    }
    nv::cloth::PhaseConfig config(static_cast<std::uint16_t>(phase));
    config.mStiffness = static_cast<float>(high < low ? 1 : (low + high) / 2);
    even = even && (high < low || high - low <= 1e-3 * high);
    if (config.mStiffness > 0) out->phases.push_back(config);
  }
  // The engine skips phases of low stiffness even if each constraint has its own stiffness.
  if (!even)
    for (nv::cloth::PhaseConfig& config : out->phases) config.mStiffness = std::max(config.mStiffness, 0.5F);
  const nv::cloth::Range<const std::uint32_t> no_anchors;
  const nv::cloth::Range<const float> no_values;
  tethers = tethers && s.pin_count > 0;
  std::vector<float> lengths(data.mTetherLengths.begin(), data.mTetherLengths.end());
  // On CUDA the engine rounds lengths to 16 bits of the greatest, so that a tether would move a pinned vertex.
  for (std::size_t k = 0; k < lengths.size(); ++k)
    if (inverse_mass[k % data.mNumParticles] == 0) lengths[k] = *std::max_element(lengths.begin(), lengths.end());
  out->fabric =
      require(factory.createFabric(data.mNumParticles, data.mPhaseIndices, data.mSets, data.mRestvalues,
                                   even ? no_values : range(each), data.mIndices, tethers ? data.mAnchors : no_anchors,
                                   tethers ? range(lengths) : no_values, data.mTriangles),
              "Factory::createFabric");
  return out;
}

}  // namespace clothbench::nvcloth
