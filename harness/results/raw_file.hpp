#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// Raw run file, format 1. Every measurement is written to it first; a device without HDF5 writes nothing else.
/// Little-endian:
///   8 B  "CBRAW001"
///   u32  length of the header, then the header (JSON, UTF-8), then u32 CRC32C of the header
///   frames of `frame_B` bytes each (named in the header): u32 index, payload, u32 CRC32C of index and payload
/// A truncated file, or one with a damaged frame, is valid up to that point.
struct RawFile {
  nlohmann::json header;
  std::vector<std::vector<std::uint8_t>> frames;  ///< payloads, in order
  bool complete = true;                           ///< false: a torn or damaged tail was cut off
};

std::uint32_t crc32c(const std::uint8_t* data, std::size_t size, std::uint32_t seed = 0);

/// tmp + fsync + rename + fsync of the folder. All payloads have the same size.
void write_raw(const std::filesystem::path&, nlohmann::json header,
               const std::vector<std::vector<std::uint8_t>>& payloads);

/// Throws Error naming the file if its header is not readable.
RawFile read_raw(const std::filesystem::path&);

/// How a run ended and its summary: `outcome.raw`, and what a child answers.
nlohmann::json outcome_to_json(const Outcome&, const std::map<std::string, double>& summary);
void outcome_from_json(const nlohmann::json&, RunRecord&);

nlohmann::json header_to_json(const RunHeader&);
RunHeader header_from_json(const nlohmann::json&);
/// Header from a part folder's header.raw. Throws Error naming the file.
RunHeader read_header(const std::filesystem::path&);

void write_trial_file(const std::filesystem::path&, const TimedTrial&, std::size_t stages);
TimedTrial read_trial_file(const std::filesystem::path&);
void write_accuracy_file(const std::filesystem::path&, const AccuracyPass&, std::uint32_t vertices);
AccuracyPass read_accuracy_file(const std::filesystem::path&);
void write_replay_file(const std::filesystem::path&, const std::vector<StoredGroup>&);
std::vector<StoredGroup> read_replay_file(const std::filesystem::path&);

}  // namespace clothbench
