#include "android/packed_assets.hpp"

#include <sstream>

#include "base/files.hpp"
#include "base/sha256.hpp"
#include "clothbench/error.hpp"

namespace clothbench::android {

void unpack_assets(const AssetReader& read, const std::filesystem::path& to) {
  constexpr const char* kIndex = "index.txt";
  const auto index = read(kIndex);
  if (!index || index->empty()) throw Error("assets: index.txt: expected this file in the package");
  if (content_of(to / kIndex) == *index) return;
  std::filesystem::remove_all(to);
  std::istringstream lines(*index);
  for (std::string hash, path; lines >> hash >> std::ws && std::getline(lines, path);) {
    const auto content = read(path);
    if (!content) throw Error("assets: " + path + ": missing");
    if (sha256(*content) != hash) throw Error("assets: " + path + ": differs from the file that was packed");
    std::filesystem::create_directories((to / path).parent_path());
    write_file_atomically(to / path, *content);
  }
  // Written last, so that an interrupted unpacking is repeated.
  write_file_atomically(to / kIndex, *index);
}

}  // namespace clothbench::android
