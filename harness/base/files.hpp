#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace clothbench {

/// Separates a file's name from the id of the writing process in a temporary name.
inline constexpr char kTemporaryMark[] = ".tmp.";

/// `<path>.tmp.<pid>`: name of an incomplete file.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Content of a file; empty if it cannot be read.
std::string content_of(const std::filesystem::path&);

/// Calls fsync on the temporary file, renames it to `path`, calls fsync on the folder. Throws Error naming the file.
void publish(const std::filesystem::path& temporary, const std::filesystem::path& path);

/// Writes a temporary file and publishes it, so that readers see either the old or the complete new file.
void write_file_atomically(const std::filesystem::path&, const std::string& content);

/// SHA-256 of `data` in lower-case hexadecimal (FIPS 180-4).
std::string sha256(const std::string& data);

/// A kind of data that the program reads at run time, and the locations of its folder.
struct DataFolder {
  const char* what;       ///< name in messages
  const char* variable;   ///< the environment variable that names the folder
  const char* installed;  ///< path below share/clothbench
  const char* in_source;  ///< path below the source tree
};

inline constexpr DataFolder kScenarioFolder{"scenes and studies", "CLOTHBENCH_SCENARIOS", "scenarios", "scenarios"};
inline constexpr DataFolder kAssetFolder{"rooms and hands", "CLOTHBENCH_ASSETS", "assets/node_modules",
                                         "build/assets/node_modules"};

/// Folders that contain the data folders.
struct DataRoots {
  std::filesystem::path installed;  ///< share/clothbench of this program's tree; empty if unknown
  std::filesystem::path source;     ///< the source tree from which this program was built
};

/// The roots of this program, correct even if it was moved.
DataRoots data_roots();

/// Value of the environment variable; empty if it is not set.
std::string named_data(const DataFolder&);

/// Folders to search if the variable is not set: in the installed tree, then in the source tree.
std::vector<std::filesystem::path> usual_places(const DataFolder&, const DataRoots& = data_roots());

/// The variable's folder; if it is not set, the first of usual_places() that exists. Throws Error that lists them.
std::filesystem::path find_data(const DataFolder&, const DataRoots& = data_roots());

}  // namespace clothbench
