#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "pbd_shared.h"

namespace clothbench::pbd_gpu {

/// Are the links of a cloth not all alike, so that chains (chain_pass) take it, not lines?
bool wants_chains(const Scene&);

/// How many times the substeps of an even cloth this one needs: short links turn faster, by the root of how much
/// shorter they are. 1 while the shortest that is not welded has half of the mean length.
double substeps_for_short_links(const Scene&);

/// Its particles and links. Vertices at the ends of slivers, edges of less than a fiftieth of the mean length, are
/// welded: so short a link turns by any angle within a substep, and no step that real time allows can follow it.
struct ChainCloth {
  std::vector<std::uint32_t> particle;  ///< of each vertex: itself, or the vertex it is welded to
  struct Link {
    std::uint32_t a, b;  ///< particles, a < b, ascending
    float rest_m, compliance_m_per_N;
  };
  std::vector<Link> links;
  std::vector<std::uint32_t> welded;  ///< vertices that are not their own particle
  const Link& link(std::uint32_t a, std::uint32_t b) const;
};
/// Without welds where hands hold vertices: each moves by itself.
ChainCloth chain_cloth(const Scene&);

/// A path of links [v0 v1], [v1 v2], ... that is best solved whole: a line of a grid, or edges of a mesh that go on as
/// straight as its triangles allow.
struct Strand {
  std::vector<std::uint32_t> vertices;  ///< of a closed one the first is the last too
  int family = -1;                      ///< that it should be in; -1: any
};
/// Every link of the cloth is on exactly one, its vertices are particles. Of a grid rows, columns and (with shear) both
/// diagonals.
std::vector<Strand> strands(const Scene&, const ChainCloth&);

/// One family: chains that share no vertex.
struct ChainFamily {
  std::vector<std::vector<std::uint32_t>> chains;  ///< of at least two vertices and at most a block
  std::uint32_t longest() const;                   ///< links
};
/// Strands cut into chains and spread over as few families as goes without cutting much. The last has the strands
/// wanted last: the order in which families are solved.
std::vector<ChainFamily> families_of(std::vector<Strand> strands, std::size_t vertices, std::uint32_t block);

/// What a kernel reads of a family: whole chains in blocks, filled up with CHAIN_NO_VERTEX. With `with_others` also the
/// vertices that are on no chain.
std::vector<ChainEntry> entries_of(const ChainFamily&, const Scene&, const ChainCloth&, std::uint32_t block,
                                   bool with_others);

/// Tethers (Kim, Chentanez & Müller 2012) vertex by vertex: to the nearest pinned vertex of each connected group of
/// them.
struct TetherTable {
  std::uint32_t a_vertex = 0;  ///< entries of each vertex, 0 to 4
  std::vector<TetherEnd> ends;
  std::string why_not;  ///< if there are none
};
/// Reach is the distance at rest, of a flat mesh with a convex border or a grid; else the way along edges, which is
/// longer than that through triangles, so such tethers hold a little less. Slack as tethers_of.
TetherTable tether_table(const Scene&);

}  // namespace clothbench::pbd_gpu
