#include "assets/assets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

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

/// The first missing file; empty if all exist.
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
  constexpr const char* kPackages[] = {"@iwer/sem", "iwer", "@webxr-input-profiles/assets"};
  return joined(kPackages, ", ", [&](const char* package) {
    const fs::path file = root / package / "package.json";
    const nlohmann::json document = parse_json(read_text(file), file.string());
    validate_json(document, R"({"required": ["version"], "properties": {"version": {"type": "string"}}})",
                  file.string());
    return fmt::format("{} {}", package, document["version"].get<std::string>());
  });
}

/// Folder of a user's own data (XDG base directories); empty if there is no home.
fs::path user_data() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data == '/')
    return fs::path(data) / "clothbench";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return fs::path(home) / ".local/share/clothbench";
  return {};
}

/// Path by which a user of this build can call fetch-assets.sh.
std::string fetching_script() {
  const char* const script = "scripts/fetch-assets.sh";
  const DataRoots roots = data_roots();
  std::error_code ec;
  for (const fs::path& root : {roots.installed, roots.source})
    if (!root.empty() && fs::is_regular_file(root / script, ec)) return (root / script).string();
  return script;
}

/// Folders to search, in order: in the installed tree, in the source tree, in the user's data.
std::vector<fs::path> asset_places() {
  std::vector<fs::path> places = usual_places(kAssetFolder);
  if (const fs::path own = user_data(); !own.empty()) places.push_back(own / kAssetFolder.installed);
  return places;
}

}  // namespace

AssetSource locate_assets(bool require) {
  const std::string wanted = named_data(kAssetFolder);
  AssetSource source;
  if (wanted == "procedural") {
    source.reason = "CLOTHBENCH_ASSETS=procedural";
  } else {
    std::vector<std::string> missing;
    for (const fs::path& root : wanted.empty() ? asset_places() : std::vector<fs::path>{wanted}) {
      const fs::path file = first_missing(root);
      if (file.empty()) return {true, root, versions(root)};
      missing.push_back(file.string());
    }
    source.reason =
        fmt::format("{} {} missing; {} gets {}", fmt::join(missing, ", "), missing.size() == 1 ? "is" : "are",
                    fetching_script(), missing.size() == 1 ? "it" : "them");
    if (!wanted.empty()) throw Error("CLOTHBENCH_ASSETS: " + source.reason);
  }
  if (require) throw Error("assets required: " + source.reason);
  return source;
}

Room open_room(const AssetSource& source, const std::string& name) {
  if (lower_case(name).ends_with(".json")) return load_room(name);
  if (!contains(kRoomNames, name))
    throw Error(fmt::format("room {}: expected a .json capture or one of {}{}", in_quotes(name),
                            fmt::join(kRoomNames, ", "), nearest_known(name, {kRoomNames.begin(), kRoomNames.end()})));
  return source.npm ? load_room(room_file(source.root, name)) : procedural_room();
}

Hand open_hand(const AssetSource& source, Side side) {
  if (!source.npm) return procedural_hand(side);
  Hand hand;
  hand.side = side;
  constexpr std::uintmax_t kMostBytes = 64u << 20;
  const fs::path mesh = hand_file(source.root, side);
  hand.mesh = parse_hand_glb(read_text(mesh, kMostBytes), mesh.string());
  for (auto name : kPoseNames) {
    const fs::path pose = pose_file(source.root, name);
    const HandPose left = parse_pose_js(read_text(pose), pose.string());
    hand.poses.emplace(name, in_palm_frame(side == Side::Left ? left : mirrored(left)));
  }
  return hand;
}

}  // namespace clothbench::assets
