/// The cloth's constraints as Jolt's shared settings of soft bodies.
#pragma once

#include "jolt/engine.hpp"

namespace clothbench::jolt {

enum class BendType { None = 0, Distance = 1, Dihedral = 2 };
enum class Attachments { None = 0, Euclidean = 1, Geodesic = 2 };

/// `compliance`: of every bend constraint [m/N; rad/(N m) for hinges]; negative: by the scene's bending rigidity, and
/// none where it has none.
struct Bending {
  BendType type;
  double compliance;
};

/// Edges, bend constraints and long-range attachments of the sheet at rest; vertices at rest, without velocity. A
/// constraint's compliance is the inverse of the spring that the scene's sheet has there, 0 where it is inextensible.
/// Attachments tie to pins, not to grips, which let go.
JPH::Ref<JPH::SoftBodySharedSettings> shared_settings(const ClothbenchScene&, const Bending&, Attachments);

}  // namespace clothbench::jolt
