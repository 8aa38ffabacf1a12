#include "android/packed_assets.hpp"

#include <fmt/format.h>

#include <sstream>
#include <vector>

#include "base/files.hpp"
#include "base/sha256.hpp"
#include "clothbench/error.hpp"

namespace clothbench::android {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndex = "index.txt";

struct Entry {
  std::size_t bytes = 0;
  std::string sha256, path;
};

bool stays_inside(const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  for (const fs::path& part : path)
    if (part == ".." || part == ".") return false;
  return true;
}

std::vector<Entry> parse_index(const std::string& text) {
  std::vector<Entry> entries;
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    Entry e;
    std::istringstream words(line);
    words >> e.bytes >> e.sha256 >> std::ws;
    std::getline(words, e.path);
    if (!words || e.sha256.size() != 64 || !stays_inside(e.path))
      throw Error(fmt::format("assets: {}: line {}: expected bytes, SHA-256 and a path inside; found \"{}\"", kIndex,
                              number, line));
    entries.push_back(std::move(e));
  }
  if (entries.empty()) throw Error(fmt::format("assets: {}: the file is empty", kIndex));
  return entries;
}

}  // namespace

void unpack_assets(const AssetReader& read, const fs::path& to) {
  const auto index = read(kIndex);
  if (!index) throw Error(fmt::format("assets: {}: expected this file in the package", kIndex));
  if (!index->empty() && content_of(to / kIndex) == *index) return;
  const std::vector<Entry> entries = parse_index(*index);
  fs::remove_all(to);
  for (const Entry& e : entries) {
    const auto content = read(e.path);
    if (!content) throw Error(fmt::format("assets: {}: missing", e.path));
    if (content->size() != e.bytes || sha256(*content) != e.sha256)
      throw Error(fmt::format("assets: {}: {} bytes, which differ from the file in the index ({} bytes)", e.path,
                              content->size(), e.bytes));
    fs::create_directories((to / e.path).parent_path());
    write_file_atomically(to / e.path, *content);
  }
  // Last, so that an interrupted unpacking is done again.
  write_file_atomically(to / kIndex, *index);
}

}  // namespace clothbench::android
