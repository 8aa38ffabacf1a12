#pragma once
#include "vulkan/kernel.hpp"

namespace clothbench::pbd_gpu {

/// A kernel's code, as it runs and with byte counters.
struct Shader {
  const char* name;
  vulkan::SpirV code, counted;
};

namespace shaders {
extern const Shader kApplyExternalForces, kDampVelocities, kApplyExplicitEuler, kProjectConstraintDeltas,
    kProjectConstraintDeltasNative, kAverageConstraintDeltas, kUpdatePositions, kIntegrate, kProjectDistance,
    kProjectBending, kProjectDistanceIterated, kProjectBendingIterated, kSkinMesh, kSkinMeshKeepStart, kMoveGrips,
    kSatisfySphereCollisions, kSatisfyCubeCollisions, kSatisfyCapsuleCollisions, kSatisfyMeshCollisions, kContactBoxes,
    kContactCandidates, kContactSamples, kContactSamplesMesh, kContactVertices, kContactVerticesMesh;
}

}  // namespace clothbench::pbd_gpu
