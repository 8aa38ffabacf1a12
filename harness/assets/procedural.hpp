#pragma once
#include "assets/hand.hpp"
#include "assets/room.hpp"

namespace clothbench::assets {

/// A room that needs no file, used if the captures are not available: 5 x 2.5 x 4 m, with two tables (slab and four
/// legs) that replace the living room's 444c8313 (low) and 1088a241 (desk). It is one closed manifold with normals into
/// free space and edges of 5 to 25 cm. Its table tops have a roughness of about 5 mm rms, as in scans. The result is
/// bitwise reproducible on one machine.
Room procedural_room();

/// A hand that needs no file: a right hand of rounded dimensions (or its mirror image) with the same joints and poses.
/// Its mesh is five closed tubes, one per finger from the metacarpal on, that overlap in the palm. It is closed, so
/// winding numbers separate inside and outside. It is not one surface, and its volume counts the overlap twice.
Hand procedural_hand(Side);

}  // namespace clothbench::assets
