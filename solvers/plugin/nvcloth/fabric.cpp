#include "nvcloth/fabric.hpp"

#include <NvClothExt/ClothFabricCooker.h>

#include <map>
#include <memory>

namespace clothbench::nvcloth {
namespace {

struct Deleter {
  void operator()(nv::cloth::ClothFabricCooker* cooker) const { NV_CLOTH_DELETE(cooker); }
};

/// The cells of a grid. A mesh has none.
std::vector<std::uint32_t> quads(const ClothbenchScene& s) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t j = 0; j + 1 < s.rows; ++j)
    for (std::uint32_t i = 0; i + 1 < s.columns; ++i) {
      const std::uint32_t a = j * s.columns + i;
      out.insert(out.end(), {a, a + 1, a + 1 + s.columns, a + s.columns});
    }
  return out;
}

template <typename T>
void describe(nv::cloth::BoundedData& to, const std::vector<T>& from, std::size_t per_item) {
  to.data = from.data();
  to.count = static_cast<physx::PxU32>(from.size() / per_item);
  to.stride = static_cast<physx::PxU32>(per_item * sizeof(T));
}

std::unique_ptr<nv::cloth::ClothFabricCooker, Deleter> cooker_of(const ClothbenchScene& s,
                                                                 const std::vector<peer::Point>& rest,
                                                                 const std::vector<double>& inverse_mass) {
  std::vector<physx::PxVec3> points;
  for (const peer::Point& p : rest) points.push_back(to_engine(p, {}, 0).getXYZ());
  const std::vector<float> weights(inverse_mass.begin(), inverse_mass.end());
  const std::vector<std::uint32_t> cells = quads(s);
  nv::cloth::ClothMeshDesc mesh;
  describe(mesh.points, points, 1);
  describe(mesh.invMasses, weights, 1);
  if (cells.empty()) {
    mesh.triangles.data = s.triangles;
    mesh.triangles.count = s.triangle_count;
    mesh.triangles.stride = 3 * sizeof(std::uint32_t);
  } else {
    describe(mesh.quads, cells, 4);
  }
  std::unique_ptr<nv::cloth::ClothFabricCooker, Deleter> cooker(NvClothCreateFabricCooker());
  const bool done = cooker->cook(mesh, physx::PxVec3(0, 1, 0), true);
  require(done ? cooker.get() : nullptr, "ClothFabricCooker::cook");
  return cooker;
}

/// Stiffness [N/m] of the spring between two vertices. Pairs that the scene has no spring for are not held.
class Springs {
 public:
  explicit Springs(const ClothbenchScene& s) {
    for (const peer::Spring& p : peer::springs(s))
      stiffness_[{std::min(p.a, p.b), std::max(p.a, p.b)}] = p.stiffness_N_per_m;
  }
  double between(std::uint32_t a, std::uint32_t b) const {
    const auto at = stiffness_.find({std::min(a, b), std::max(a, b)});
    return at == stiffness_.end() ? 0 : at->second;
  }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> stiffness_;
};

/// Share of a constraint's error that one iteration of `h` seconds removes.
double share_of_error(double stiffness, double inverse_masses, double h) {
  if (std::isinf(stiffness)) return 1;
  const double x = inverse_masses * stiffness * h * h;
  return x / (1 + x);
}

}  // namespace

Cooked cook(nv::cloth::Factory& factory, const ClothbenchScene& s, const std::vector<double>& inverse_mass,
            const FabricOptions& options) {
  const std::vector<peer::Point> rest = peer::rest_points(s);
  const auto cooker = cooker_of(s, rest, inverse_mass);
  const nv::cloth::CookedData data = cooker->getCookedData();
  const Springs springs(s);
  const double exponent = options.stiffness_frequency_hz * options.iteration_s;
  Cooked out;
  std::vector<float> each(data.mRestvalues.size(), 0);  // logarithm to base 2 of the share of the error that is left
  bool even = true;
  for (std::uint32_t phase = 0; phase < data.mPhaseIndices.size(); ++phase) {
    const std::uint32_t set = data.mPhaseIndices[phase];
    double low = 1, high = 0;
    for (std::uint32_t k = set == 0 ? 0 : data.mSets[set - 1]; k < data.mSets[set]; ++k) {
      const std::uint32_t a = data.mIndices[2 * k], b = data.mIndices[2 * k + 1];
      const double share =
          share_of_error(springs.between(a, b), inverse_mass[a] + inverse_mass[b], options.iteration_s);
      each[k] = static_cast<float>(std::max(std::log2(1 - share) / exponent, -1e30));
      if (inverse_mass[a] > 0 && inverse_mass[b] > 0) low = std::min(low, share), high = std::max(high, share);
    }
    nv::cloth::PhaseConfig config(static_cast<std::uint16_t>(phase));
    const double share = high < low ? 1 : (low + high) / 2;
    config.mStiffness = static_cast<float>(1 - std::pow(1 - share, 1 / exponent));
    even = even && (high < low || high - low <= 1e-3 * high);
    // A phase of stiffness 0 is dropped by the engine, and one that each constraint states its own for must not be.
    if (config.mStiffness > 0 || high > 0) out.phases.push_back(config);
  }
  if (!even)
    for (nv::cloth::PhaseConfig& config : out.phases) config.mStiffness = std::max(config.mStiffness, 0.5F);
  const bool tethers = options.tethers && s.pin_count > 0;
  out.fabric = factory.createFabric(data.mNumParticles, data.mPhaseIndices, data.mSets, data.mRestvalues,
                                    even ? nv::cloth::Range<const float>() : range(each), data.mIndices,
                                    tethers ? data.mAnchors : nv::cloth::Range<const std::uint32_t>(),
                                    tethers ? data.mTetherLengths : nv::cloth::Range<const float>(), data.mTriangles);
  require(out.fabric, "Factory::createFabric");
  return out;
}

}  // namespace clothbench::nvcloth
