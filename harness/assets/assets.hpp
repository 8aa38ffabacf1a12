#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "assets/hand.hpp"
#include "assets/room.hpp"

namespace clothbench::assets {

/// Source of rooms and hands. Tables and files print `kind` as "assets: ...".
struct AssetSource {
  bool npm = false;
  std::filesystem::path root;  ///< a node_modules folder; empty if procedural
  std::string reason;          ///< package versions, or why no packages were found
  const char* kind() const { return npm ? "npm" : "procedural"; }
};

inline constexpr std::array<std::string_view, 5> kRoomNames = {"living_room", "meeting_room", "music_room",
                                                               "office_large", "office_small"};

/// Finds the assets. $CLOTHBENCH_ASSETS is a node_modules folder, or "procedural" for the stand-ins. If it is not set,
/// the folders are share/clothbench/assets/node_modules of an installed tree, build/assets/node_modules of the source
/// tree, and clothbench/assets/node_modules below $XDG_DATA_HOME (~/.local/share); scripts/fetch-assets.sh fills them.
/// Throws Error if `require` and none are found, or if $CLOTHBENCH_ASSETS names a folder without assets.
AssetSource locate_assets(bool require);

/// Opens one of kRoomNames, or a capture by its path (ends in .json). A procedural source has one room for all names.
Room open_room(const AssetSource&, const std::string& name);
Hand open_hand(const AssetSource&, Side);

/// A room that needs no file, for use without captures: 5 x 2.5 x 4 m, with two tables (slab and four legs) instead of
/// the living room's tables 444c8313 (low) and 1088a241 (desk). It is one closed manifold with normals into free space
/// and edges of 5 to 25 cm. Its table tops have a roughness of about 5 mm rms, as in scans. Bitwise reproducible on one
/// machine.
Room procedural_room();

/// A hand that needs no file: a right hand (or its mirror image) with rounded sizes, and with all joints and poses.
/// Its mesh is five overlapping closed tubes, one per finger from the metacarpal on. The mesh is closed, so winding
/// numbers separate inside and outside, but it is not one surface: its volume counts the overlap in the palm twice.
Hand procedural_hand(Side);

}  // namespace clothbench::assets
