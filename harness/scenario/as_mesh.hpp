#pragma once
#include "clothbench/scene.hpp"

namespace clothbench {

/// A scene of a grid with the same cloth as a triangle mesh: the grid's vertices with the same numbers, each cell
/// cut along one of its diagonals, in an irregular pattern, its pattern as the shape at rest if the cloth starts bent.
/// Pins, grips, colliders and the start are the grid's. A mesh has one stiffness, so regions are left out, with
/// reference case and bounds of `expect`, which belong to the grid. Bending is also left out unless `bends`: some
/// solvers cannot bend meshes. A scene of a mesh is returned as it is.
Scene as_mesh(Scene, bool bends = false);

}  // namespace clothbench
