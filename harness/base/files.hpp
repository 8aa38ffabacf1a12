#pragma once
#include <filesystem>
#include <string>

namespace clothbench {

/// Separates a file's name from the id of the writing process in a temporary name.
inline constexpr char kTemporaryMark[] = ".tmp.";

/// `<path>.tmp.<pid>`: the name of a file until it is complete.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// The whole file; empty if it cannot be read.
std::string content_of(const std::filesystem::path&);

/// Calls fsync on the temporary file, renames it to `path`, calls fsync on the folder. Throws Error naming the file.
void publish(const std::filesystem::path& temporary, const std::filesystem::path& path);

/// Writes a temporary file and publishes it, so that readers see the old or the new file, never a part.
void write_file_atomically(const std::filesystem::path&, const std::string& content);

/// SHA-256 of `data` in lower-case hexadecimal (FIPS 180-4).
std::string sha256(const std::string& data);

}  // namespace clothbench
