#include "base/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

/// Throws Error, with BadInput for a path at which no file can exist and CheckFailed for a full or broken disk.
[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  const int why = errno;
  const bool wrong_path = why == ENOENT || why == ENOTDIR || why == EISDIR || why == ENAMETOOLONG || why == EACCES ||
                          why == EROFS || why == EPERM;
  throw Error(fmt::format("{}: {}: {}", path.string(), what, std::strerror(why)),
              wrong_path ? ExitCode::BadInput : ExitCode::CheckFailed);
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : fd_(open(path.c_str(), flags, 0644)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// FIPS 180-4, §4.2.2: fractional parts of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> kRound = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

void compress(std::array<std::uint32_t, 8>& h, const unsigned char* block) {
  std::array<std::uint32_t, 64> w;
  for (int i = 0; i < 16; ++i)
    w[i] = std::uint32_t{block[4 * i]} << 24 | std::uint32_t{block[4 * i + 1]} << 16 |
           std::uint32_t{block[4 * i + 2]} << 8 | block[4 * i + 3];
  for (int i = 16; i < 64; ++i) {
    const std::uint32_t a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3)) + w[i - 7] +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10));
  }
  auto s = h;
  for (int i = 0; i < 64; ++i) {
    const std::uint32_t e = s[4], a = s[0];
    const std::uint32_t t1 =
        s[7] + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & s[5]) ^ (~e & s[6])) + kRound[i] + w[i];
    const std::uint32_t t2 =
        (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
    s = {t1 + t2, s[0], s[1], s[2], s[3] + t1, s[4], s[5], s[6]};
  }
  for (int i = 0; i < 8; ++i) h[i] += s[i];
}

}  // namespace

std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string out;
  std::error_code unknown;  // a pipe has no size
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  if (!unknown && in) {
    out.resize(size);
    in.read(out.data(), static_cast<std::streamsize>(size));
    out.resize(static_cast<std::size_t>(in.gcount()));
    in.clear();
  }
  return out.append(std::istreambuf_iterator<char>(in), {});
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  return path.string() + fmt::format("{}{}", kTemporaryMark, getpid());
}

void publish(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  {
    const Descriptor file(temporary, O_RDONLY);
    if (file.get() < 0 || fsync(file.get()) != 0) fail(temporary, "cannot be synced");
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "cannot be renamed into place");
  const auto folder = path.parent_path().empty() ? std::filesystem::path(".") : path.parent_path();
  const Descriptor dir(folder, O_RDONLY | O_DIRECTORY);
  if (dir.get() < 0) fail(folder, "cannot be opened");
  // Some file systems, such as a phone's shared storage, cannot sync folders.
  if (fsync(dir.get()) != 0 && errno != EINVAL && errno != ENOTSUP) fail(folder, "cannot be synced");
}

void write_file_atomically(const std::filesystem::path& path, const std::string& content) {
  const std::filesystem::path temporary = temporary_name(path);
  try {
    const Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (file.get() < 0) fail(path, "cannot be created");
    for (std::size_t at = 0; at < content.size();) {
      const ssize_t n = write(file.get(), content.data() + at, content.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(path, "cannot be written");
      at += static_cast<std::size_t>(n);
    }
    publish(temporary, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

std::string sha256(const std::string& data) {
  std::array<std::uint32_t, 8> h = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                    0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::string padded = data + '\x80';
  while (padded.size() % 64 != 56) padded += '\0';
  const std::uint64_t bits = std::uint64_t{data.size()} * 8;
  for (int i = 7; i >= 0; --i) padded += static_cast<char>(bits >> (8 * i));
  for (std::size_t i = 0; i < padded.size(); i += 64)
    compress(h, reinterpret_cast<const unsigned char*>(padded.data()) + i);
  std::string hex;
  for (std::uint32_t word : h)
    for (int i = 7; i >= 0; --i) hex += "0123456789abcdef"[word >> (4 * i) & 15];
  return hex;
}

}  // namespace clothbench
