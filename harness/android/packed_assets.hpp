#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace clothbench::android {

/// Content of a packed file by its path; empty if there is none.
using AssetReader = std::function<std::optional<std::string>(const std::string& path)>;

/// Unpacks what pack_assets.py packed into the folder `to`, so that everything else reads plain files. `index.txt` has
/// one line a file: bytes, SHA-256, path. A folder that already holds this very index is left alone; anything else
/// there is removed first. Throws Error naming the file that is missing, damaged or has a path that leaves the folder.
void unpack_assets(const AssetReader& read, const std::filesystem::path& to);

}  // namespace clothbench::android
