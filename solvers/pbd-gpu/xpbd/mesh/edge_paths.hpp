#pragma once
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"
#include "common/gpu_types.h"

namespace clothbench::pbd_gpu {

/// True if the links of a cloth are not uniform, so that Chains solve it instead of Lines.
bool needs_chain_solver(const Scene&);

/// Factor on the number of substeps, because short links rotate faster than mean ones, by the square root of the length
/// ratio. 1 if the shortest link that is not welded has at least half of the mean length.
double substeps_for_short_links(const Scene&);

/// Particles and links of a chain cloth, slivers welded (xpbd/mesh/README.md).
struct ChainCloth {
  std::vector<std::uint32_t> particle;  ///< one per vertex: itself, or the vertex to which it is welded
  struct Link {
    std::uint32_t a, b;  ///< particles, a < b, ascending
    float rest_m, compliance_m_per_N;
  };
  std::vector<Link> links;
  std::vector<std::uint32_t> welded;  ///< vertices whose particle is another vertex
  const Link& link(std::uint32_t a, std::uint32_t b) const;
};
/// A cloth with attachments has no welds, because each attached vertex has a motion of its own.
ChainCloth chain_cloth(const Scene&);

/// A path of links [v0 v1], [v1 v2], ... that is best solved as a whole: a line of a grid, or edges of a mesh that
/// continue as straight as its triangles allow.
struct EdgePath {
  std::vector<std::uint32_t> vertices;  ///< particles; a closed edge path ends with its first one
  int colour = -1;                      ///< preferred colour; -1: any
  std::vector<float> share = {};        ///< fraction of each link's stiffness; empty: 1
};
/// Edge paths of a cloth; every link is on exactly one, or on two that share its stiffness. The edge paths of a grid
/// are its rows, columns and (with shear) both diagonals.
std::vector<EdgePath> edge_paths(const Scene&, const ChainCloth&);

/// One colour: chains that share no vertex.
struct ChainColour {
  std::vector<EdgePath> chains;   ///< each has at least two vertices and fits into a block
  std::uint32_t longest() const;  ///< links of the longest chain
};
/// Distributes edge paths over few colours, and cuts them into chains where necessary. Colours are in the order in
/// which they are solved.
std::vector<ChainColour> colours_of(std::vector<EdgePath> edge_paths, std::size_t vertices, std::uint32_t block);

/// Data of one colour for a kernel: whole chains in blocks, padded with CHAIN_NO_VERTEX. `with_others` adds the
/// vertices that are on no chain.
std::vector<ChainEntry> entries_of(const ChainColour&, const Scene&, const ChainCloth&, std::uint32_t block,
                                   bool with_others);

}  // namespace clothbench::pbd_gpu
