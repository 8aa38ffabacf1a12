#pragma once
#include "assets/hand.hpp"
#include "assets/room.hpp"

namespace clothbench::assets {

/// A room that needs no file, for where the captures are not to be had: 5 x 2.5 x 4 m, with two tables of slab and four
/// legs that stand for the living room's 444c8313 (low) and 1088a241 (desk). One closed manifold, normals into free
/// space, edges of 5 to 25 cm, table tops rough by about 5 mm rms as scans are. The same bits every time on one
/// machine.
Room procedural_room();

/// A hand that needs no file: a right hand of round measures (or its mirror image) with the same joints and poses. Its
/// mesh is five closed tubes, one per finger from the metacarpal on, that overlap in the palm; so it is closed and
/// winding numbers tell inside from outside, but it is not one surface, and its volume counts the overlap twice.
Hand procedural_hand(Side);

}  // namespace clothbench::assets
