#include "assets/assets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>

#include "assets/json_at.hpp"
#include "assets/procedural.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "scenario/json_text.hpp"

namespace clothbench::assets {
namespace {

namespace fs = std::filesystem;

fs::path room_file(const fs::path& root, std::string_view name) {
  return root / "@iwer/sem/captures" / (std::string(name) + ".json");
}
fs::path hand_file(const fs::path& root, Side side) {
  return root / "@webxr-input-profiles/assets/dist/profiles/generic-hand" / (std::string(name_of(side)) + ".glb");
}
fs::path pose_file(const fs::path& root, std::string_view name) {
  return root / "iwer/lib/device/configs/hand" / (std::string(name) + ".js");
}

/// The first file that is not there; empty if all are.
fs::path first_missing(const fs::path& root) {
  std::vector<fs::path> wanted;
  for (auto name : kRoomNames) wanted.push_back(room_file(root, name));
  for (Side side : {Side::Left, Side::Right}) wanted.push_back(hand_file(root, side));
  for (auto name : kPoseNames) wanted.push_back(pose_file(root, name));
  std::error_code ec;
  for (const fs::path& file : wanted)
    if (!fs::is_regular_file(file, ec)) return file;
  return {};
}

std::string versions(const fs::path& root) {
  std::string out;
  for (const char* package : {"@iwer/sem", "iwer", "@webxr-input-profiles/assets"}) {
    const fs::path file = root / package / "package.json";
    const nlohmann::json document = parse_json(read_text(file), file.string());
    out +=
        fmt::format("{}{} {}", out.empty() ? "" : ", ", package, JsonAt(document, file.string()).key("version").text());
  }
  return out;
}

}  // namespace

AssetSource locate_assets(bool require) {
  const char* variable = std::getenv("CLOTHBENCH_ASSETS");
  const std::string wish = variable ? variable : "";
  AssetSource source;
  if (wish == "procedural") {
    source.reason = "CLOTHBENCH_ASSETS=procedural";
  } else {
    const fs::path root = wish.empty() ? fs::path(CLOTHBENCH_DEFAULT_ASSETS) : fs::path(wish);
    const fs::path missing = first_missing(root);
    if (missing.empty()) return {true, root, versions(root)};
    source.reason = missing.string() + " is missing; scripts/fetch-assets.sh gets it";
    if (!wish.empty()) throw Error("CLOTHBENCH_ASSETS: " + source.reason);
  }
  if (require) throw Error("assets required: " + source.reason);
  return source;
}

Room open_room(const AssetSource& source, const std::string& name) {
  if (name.ends_with(".json")) return load_room(name);
  if (std::find(kRoomNames.begin(), kRoomNames.end(), name) == kRoomNames.end()) {
    const std::string near = nearest(name, {kRoomNames.begin(), kRoomNames.end()});
    throw Error(fmt::format("room \"{}\": expected a .json capture or one of {}{}", name, fmt::join(kRoomNames, ", "),
                            near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }
  return source.npm ? load_room(room_file(source.root, name)) : procedural_room();
}

Hand open_hand(const AssetSource& source, Side side) {
  if (!source.npm) return procedural_hand(side);
  Hand hand;
  hand.side = side;
  hand.mesh = read_hand_glb(hand_file(source.root, side));
  for (auto name : kPoseNames) {
    const HandPose left = read_pose_js(pose_file(source.root, name));
    hand.poses.emplace(name, in_palm_frame(side == Side::Left ? left : mirrored(left)));
  }
  return hand;
}

}  // namespace clothbench::assets
