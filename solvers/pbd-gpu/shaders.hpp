#pragma once
#include "vulkan/kernel.hpp"

namespace clothbench::pbd_gpu {

/// A kernel's code, as it runs and with byte counters; the latter is null where the build left them out
/// (CLOTHBENCH_COUNTED_KERNELS).
struct Shader {
  const char* name;
  vulkan::SpirV code, counted;
};

namespace shaders {
extern const Shader kApplyExternalForces, kDampVelocities, kApplyExplicitEuler, kProjectConstraintDeltas,
    kProjectConstraintDeltasNative, kAverageConstraintDeltas, kUpdatePositions, kSkinMesh, kSkinMeshKeepStart,
    kMoveGrips, kSatisfySphereCollisions, kSatisfyCubeCollisions, kSatisfyCapsuleCollisions, kSatisfyMeshCollisions,
    kContactBoxes, kChainPass, kChainsResident, kWeld, kSelfBlocks, kSelfNear, kSelfWishes, kSelfApply, kSelfCertify,
    kSelfMove;

/// By whether there are meshes [0] and whether lanes share a point by shuffles [1].
extern const Shader kContactCandidates[2], kContactSamples[2][2], kContactVertices[2][2];

/// By whether subgroups exchange by shuffles [0] and multipliers are kept [1].
extern const Shader kLineFrame[2][2], kLinePass[2][2];
/// With shuffles; by whether multipliers are kept.
extern const Shader kLinesResident[2];
}  // namespace shaders

}  // namespace clothbench::pbd_gpu
