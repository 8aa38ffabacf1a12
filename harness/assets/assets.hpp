#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "assets/hand.hpp"
#include "assets/room.hpp"

namespace clothbench::assets {

/// Where rooms and hands come from. `kind` is what tables and files say as "assets: ...".
struct AssetSource {
  bool npm = false;
  std::filesystem::path root;  ///< a node_modules folder; empty if procedural
  std::string reason;          ///< package versions, or why there are none
  const char* kind() const { return npm ? "npm" : "procedural"; }
};

inline constexpr std::array<std::string_view, 5> kRoomNames = {"living_room", "meeting_room", "music_room",
                                                               "office_large", "office_small"};

/// Looks in $CLOTHBENCH_ASSETS (a node_modules folder; the word "procedural" asks for the stand-ins); where that isn't
/// set in share/clothbench/assets/node_modules of an installed tree, in build/assets/node_modules of the source tree
/// and in clothbench/assets/node_modules below $XDG_DATA_HOME (~/.local/share), where scripts/fetch-assets.sh puts
/// them. Throws Error if `require` and there are none, and whenever $CLOTHBENCH_ASSETS names a folder without them.
AssetSource locate_assets(bool require);

/// One of kRoomNames, or the path of a capture (ends in .json). Procedural: the one procedural room for every name.
Room open_room(const AssetSource&, const std::string& name);
Hand open_hand(const AssetSource&, Side);

}  // namespace clothbench::assets
