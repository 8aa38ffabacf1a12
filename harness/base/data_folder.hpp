#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace clothbench {

/// A kind of files that the program reads when it runs.
struct DataFolder {
  const char* what;       ///< in messages
  const char* variable;   ///< the environment variable that names the folder
  const char* installed;  ///< below share/clothbench
  const char* in_source;  ///< below the source tree
};

inline constexpr DataFolder kScenarioFolder{"scenes and studies", "CLOTHBENCH_SCENARIOS", "scenarios", "scenarios"};
inline constexpr DataFolder kAssetFolder{"rooms and hands", "CLOTHBENCH_ASSETS", "assets/node_modules",
                                         "build/assets/node_modules"};

/// What the kinds lie below.
struct DataRoots {
  std::filesystem::path installed;  ///< share/clothbench of the tree this program lies in; empty if that is unknown
  std::filesystem::path source;     ///< the source tree this was built from
};

/// Of this program, wherever it was moved to.
DataRoots data_roots();

/// What the environment variable says; empty where it says nothing.
std::string named_data(const DataFolder&);

/// Where to look when the variable says nothing: the installed tree, then the source tree.
std::vector<std::filesystem::path> usual_places(const DataFolder&, const DataRoots& = data_roots());

/// The folder that the variable names, and no other; without it the first of the usual places that exists. Throws Error
/// with every place if there is none.
std::filesystem::path find_data(const DataFolder&, const DataRoots& = data_roots());

}  // namespace clothbench
