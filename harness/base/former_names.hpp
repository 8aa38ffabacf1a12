#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clothbench {

// Names that files and commands used up to version 0.1; CHANGELOG.md has the table. Readers accept both names.

/// Prints on stderr, once per process, that `former` is now `current`. `where`: the file or command that uses it.
void notice_renamed(const std::string& where, const std::string& former, const std::string& current);

/// Renames the key `former` of `object` to `current`, with a notice, if it is there. `object` may be of any JSON type.
void rename_key(nlohmann::json& object, const char* former, const char* current, const std::string& where);

/// Renames the former keys of a scene, given as its file has it, to the current ones.
void rename_scene_keys(nlohmann::json& scene, const std::string& source);

/// A scene's JSON with the keys of its first format. Hashes are computed from it, so renaming a key changes no hash.
nlohmann::json with_former_keys(nlohmann::json scene);

/// A stored verdict of `expect` in current terms: "kept" -> "pass", "broken: …" -> "fail: …"; other text unchanged.
std::string current_verdict(const std::string& stored);

/// The stored scenario of a run in current terms (truth.card, material_card). Text that is no JSON object is unchanged.
std::string current_scenario(const std::string& stored);

/// Arguments of the command with the words of version 0.1 replaced by the current ones, with a notice for each.
std::vector<std::string> current_words(std::vector<std::string> words);

}  // namespace clothbench
