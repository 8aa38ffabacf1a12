#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace clothbench::android {

/// Returns the content of the packed file at a path; empty if there is none.
using AssetReader = std::function<std::optional<std::string>(const std::string& path)>;

/// Unpacks the files packed by pack_assets.py into the folder `to`, so that all other code reads plain files.
/// `index.txt` has one line per file: SHA-256 and path. A folder with the same index is kept; otherwise its content is
/// removed first. Throws Error naming a file that is missing or damaged.
void unpack_assets(const AssetReader& read, const std::filesystem::path& to);

}  // namespace clothbench::android
