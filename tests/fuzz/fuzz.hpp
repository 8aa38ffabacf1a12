#pragma once
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "clothbench/error.hpp"

namespace clothbench {

// One input for each reader that needs more than a statement.
void fuzz_scene(const std::uint8_t* data, std::size_t size);
void fuzz_hand(const std::uint8_t* data, std::size_t size);
void fuzz_track(const std::uint8_t* data, std::size_t size);
void fuzz_hdf5(const std::uint8_t* data, std::size_t size);

/// A reader may accept an input or throw Error with a message. Anything else ends the program.
template <class Read>
void reads_or_refuses(Read read) {
  try {
    read();
  } catch (const Error& e) {
    if (std::string(e.what()).empty()) std::abort();
  }
}

/// A file with these bytes for this object's lifetime; in memory if the system supports that.
class MemoryFile {
 public:
  MemoryFile(const void* data, std::size_t size)
      : path_((std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path().string()) +
              "/clothbench-fuzz-" + std::to_string(getpid())) {
    std::ofstream out(path_, std::ios::binary);
    if (!out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size)).flush()) std::abort();
  }
  ~MemoryFile() { std::filesystem::remove(path_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace clothbench
