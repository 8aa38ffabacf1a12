#pragma once
#include "mesh_scene.hpp"
#include "scenario/drawn_mesh.hpp"

namespace clothbench::pbd_gpu {

/// A sheet of width x height m along x and y, pinned along x = 0. Its inner vertices are those of a square lattice,
/// turned by an angle, each moved by up to a share of a cell.
inline Scene random_sheet(double width, double height, int cells, double angle, double share, unsigned seed) {
  ClothMesh mesh = drawn_mesh({width, height, cells, angle, share, seed});
  std::vector<std::uint32_t> pins = mesh.groups.at("u0");
  return of_mesh(std::move(mesh), std::move(pins));
}

}  // namespace clothbench::pbd_gpu
