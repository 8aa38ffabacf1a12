#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

// What files and commands called things in version 0.1 and before; CHANGELOG.md has the table. Readers take both words.

/// Says once a process on stderr that `former` is called `current` now. `where`: the file or command that has it.
void notice_renamed(const std::string& where, const std::string& former, const std::string& current);

/// Gives a key of `object` its current name, with a notice, where the former one is found. `object` may be of any type.
void rename_key(nlohmann::json& object, const char* former, const char* current, const std::string& where);

/// Gives the keys of a scene as its file has it their current names.
void rename_scene_keys(nlohmann::json& scene, const std::string& source);

/// A scene's JSON with the keys of its first format. Hashes are made of it, so that a new name changes no hash.
nlohmann::json with_former_keys(nlohmann::json scene);

/// A stored verdict of `expect` in current words: "kept" is "pass", "broken: …" is "fail: …"; any other text unchanged.
std::string current_verdict(const std::string& stored);

/// The stored scenario of a run in current words (truth.card, material_card); text that is no JSON object unchanged.
std::string current_scenario(const std::string& stored);

}  // namespace clothbench
