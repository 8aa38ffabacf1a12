#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "runner/reference.hpp"

namespace clothbench {

/// SHA-256 of the sources that reference values depend on (reference_code.cmake), computed at compile time.
extern const char* const kReferenceCode;

/// Everything that a scene's reference value depends on: the scenario, the reference solver's version and complete
/// settings, the rules of the runs, and the code of solver, truths and scenes.
nlohmann::json reference_key(const Scene&, const ReferenceRules&);

/// The value stored in `folder` for this key. None if the file is missing, unreadable or of another key.
std::optional<ReferenceResult> read_reference(const std::filesystem::path& folder, const nlohmann::json& key);
void write_reference(const std::filesystem::path& folder, const nlohmann::json& key, const ReferenceResult&);

}  // namespace clothbench
