// Raw run files. The first byte says as which kind the rest is read; checksums are put right, or no input would pass
// them.
#include <cstring>
#include <vector>

#include "fuzz.hpp"
#include "results/raw_file.hpp"

namespace {

void put(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, 4);
}

/// Header checksum, and those of as many frames as its "frame_B" makes.
void seal(std::vector<std::uint8_t>& b) {
  std::uint32_t header = 0;
  if (b.size() < 12) return;
  std::memcpy(&header, b.data() + 8, 4);
  if (header > b.size() - 12 || b.size() - 12 - header < 4) return;
  put(b, 12 + header, clothbench::crc32c(b.data() + 12, header));
  const nlohmann::json j = nlohmann::json::parse(b.begin() + 12, b.begin() + 12 + header, nullptr, false);
  if (!j.is_object() || !j.contains("frame_B") || !j["frame_B"].is_number_unsigned()) return;
  const auto frame = j["frame_B"].get<std::uint64_t>();
  if (frame < 8 || frame > b.size()) return;
  for (std::size_t at = 16 + header; at + frame <= b.size(); at += frame)
    put(b, at + frame - 4, clothbench::crc32c(b.data() + at, frame - 4));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clothbench;
  if (size == 0) return 0;
  std::vector<std::uint8_t> bytes(data + 1, data + size);
  if (data[0] % 2 == 0) seal(bytes);
  const MemoryFile file(bytes.data(), bytes.size());
  reads_or_refuses([&] {
    switch (data[0] / 2 % 5) {
      case 0:
        read_raw(file.path());
        break;
      case 1:
        read_trial_file(file.path());
        break;
      case 2:
        read_accuracy_file(file.path());
        break;
      case 3:
        read_replay_file(file.path());
        break;
      default:
        try {
          header_from_json(read_raw(file.path()).header);
        } catch (const nlohmann::json::exception&) {  // its callers name the file
        }
    }
  });
  return 0;
}
