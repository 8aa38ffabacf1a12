#include <fmt/format.h>

#include <cstdlib>

#include "base/files.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

std::string listed(const std::vector<fs::path>& places) {
  return joined(places, ", then ", [](const fs::path& place) { return place.string(); });
}

}  // namespace

DataRoots data_roots() {
  DataRoots roots{{}, CLOTHBENCH_SOURCE_ROOT};
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (!unknown) roots.installed = (program.parent_path() / CLOTHBENCH_DATA_FROM_PROGRAM).lexically_normal();
  return roots;
}

std::string named_data(const DataFolder& folder) {
  const char* named = std::getenv(folder.variable);
  return named == nullptr ? "" : named;
}

std::vector<fs::path> usual_places(const DataFolder& folder, const DataRoots& roots) {
  std::vector<fs::path> out;
  if (!roots.installed.empty()) out.push_back(roots.installed / folder.installed);
  out.push_back(roots.source / folder.in_source);
  return out;
}

fs::path find_data(const DataFolder& folder, const DataRoots& roots) {
  const std::vector<fs::path> places = usual_places(folder, roots);
  std::error_code ec;
  if (const std::string named = named_data(folder); !named.empty()) {
    if (fs::is_directory(named, ec)) return named;
    throw Error(fmt::format("no {}: {}={} is not a folder; without {} they are searched for in {}", folder.what,
                            folder.variable, named, folder.variable, listed(places)));
  }
  for (const fs::path& place : places)
    if (fs::is_directory(place, ec)) return place;
  throw Error(fmt::format("no {}: not found in {}; set {} to the folder that contains them", folder.what,
                          listed(places), folder.variable));
}

}  // namespace clothbench
