#pragma once
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"
#include "truth/lattice.hpp"
#include "truth/reference_case.hpp"

// Reference cases of flat rectangular cloths as triangle meshes. Their answer is the continuum: no exact solution of a
// mesh is known. So how far a mesh itself is from it comes from a converged solution (runner/reference.hpp).
namespace clothbench::truth {

struct Strip;

/// From a cloth's vertices to the material lattice. Throws Error if its triangles do not cover the rectangle.
LatticeSampler sampler_of(const Cloth&);

/// Vertices of a mesh at most `u_m` from edge u0, by their place in the rectangle, ascending.
std::vector<std::uint32_t> vertices_up_to(const Cloth&, double u_m);

/// Throws Error if a mesh is not a flat rectangle round the middle of its frame, its longer side along u.
void need_rectangle(const Strip&);

/// Width [m] of what the pins of a mesh hold beside edge u0. Throws Error if they hold anything else, or the edge
/// alone.
double need_mesh_clamp(const Strip&);

/// The same reference case of a mesh: the continuum at its vertices. Its columns are those of the material lattice.
ReferenceCase on_mesh(const Strip&, ReferenceCase);

}  // namespace clothbench::truth
