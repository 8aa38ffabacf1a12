#pragma once
#include <string>
#include <vector>

#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {

/// Every pair of a triangle of the cloth and a convex convex shape of a collider whose boxes meet in a frame, by force.
struct PairCheck {
  long pairs = 0;
  long separated = 0;  ///< those that some plane parts at both ends of the frame, with the convex shape's radius
};
/// For solvers that move cloth and colliders in straight lines in a frame, as `xpbd` does with substeps=1: a plane that
/// separates a pair at both ends then separates it in between. Convex shapes are capsules, spheres, and triangles (of
/// boxes too); directions tried come from the nearest points at both ends and 15 between them. In double, with no code
/// of the solver's. Positions [m], three numbers per vertex.
PairCheck check_pairs(const Scene& scene, const std::vector<double>& before, const std::vector<double>& after,
                      int frame);

/// The same of the cloth's triangles with each other, those without a common vertex.
PairCheck check_self_pairs(const Scene& scene, const std::vector<double>& before, const std::vector<double>& after);

/// First fault in the run of a scene whose frames are steps; empty if there is none. Adds up its pairs with convex
/// shapes, and the pairs of the cloth with itself.
std::string fault_of(GpuSolver& solver, const Scene& s, long& pairs, long& own_pairs);

/// Expects that nothing is, and more than `least` pairs: of the cloth with itself where the scene has self-contact.
void expect_all_separated(GpuSolver& solver, const Scene& s, long least = 0);

}  // namespace clothbench::pbd_gpu
