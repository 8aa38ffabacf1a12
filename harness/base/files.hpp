#pragma once
#include <filesystem>
#include <string>

namespace clothbench {

/// Between a file's name and the process that writes it.
inline constexpr char kTemporaryMark[] = ".tmp.";

/// `<path>.tmp.<pid>`: what a file is called until it is whole.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// fsync of the temporary file, rename into place, fsync of the folder. Throws Error naming the file.
void publish(const std::filesystem::path& temporary, const std::filesystem::path& path);

/// tmp + fsync + rename + fsync of the folder.
void write_file_atomically(const std::filesystem::path&, const std::string& content);

}  // namespace clothbench
