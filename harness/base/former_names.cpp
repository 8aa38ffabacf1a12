#include "base/former_names.hpp"

#include <fmt/format.h>

#include <mutex>
#include <set>

namespace clothbench {
namespace {

using nlohmann::json;

bool move_key(json& object, const char* from, const char* to) {
  if (!object.is_object() || !object.contains(from) || object.contains(to)) return false;
  object[to] = std::move(object[from]);
  object.erase(from);
  return true;
}

}  // namespace

void notice_renamed(const std::string& where, const std::string& former, const std::string& current) {
  static std::mutex mutex;
  static std::set<std::string> noticed;
  const std::lock_guard lock(mutex);
  if (noticed.insert(former).second)
    fmt::print(stderr, "notice: {}: \"{}\" is now called \"{}\"; both are accepted\n", where, former, current);
}

void rename_key(json& object, const char* former, const char* current, const std::string& where) {
  if (move_key(object, former, current)) notice_renamed(where, former, current);
}

void rename_scene_keys(json& scene, const std::string& source) {
  if (scene.is_object() && scene.contains("truth")) rename_key(scene["truth"], "card", "case", source + ": /truth");
}

json with_former_keys(json scene) {
  if (scene.contains("truth")) move_key(scene["truth"], "case", "card");
  return scene;
}

std::string current_verdict(const std::string& stored) {
  const std::string broken = "broken";
  if (stored == "kept") return "pass";
  return stored.starts_with(broken) ? "fail" + stored.substr(broken.size()) : stored;
}

std::string current_scenario(const std::string& stored) {
  // Most files have neither word, and parsing takes longer than looking.
  if (stored.find("\"card\"") == std::string::npos && stored.find("\"material_card\"") == std::string::npos)
    return stored;
  json scenario = json::parse(stored, nullptr, false);
  if (!scenario.is_object()) return stored;
  if (scenario.contains("truth")) move_key(scenario["truth"], "card", "case");
  move_key(scenario, "material_card", "effective_moduli");
  return scenario.dump();
}

std::vector<std::string> current_words(std::vector<std::string> words) {
  static const std::map<std::string, std::string> kOptions = {
      {"--cell", "--run"}, {"--list-cells", "--list-runs"}, {"--no-cards", "--no-moduli"}, {"--patience", "--timeout"}};
  const auto command = std::find_if(words.begin(), words.end(), [](const auto& w) { return !w.starts_with("-"); });
  if (command != words.end() && *command == "card") {
    notice_renamed("clothbench", "card", "moduli");
    *command = "moduli";
  }
  for (std::string& word : words) {
    const std::size_t end = std::min(word.find('='), word.size());
    const auto found = kOptions.find(word.substr(0, end));
    if (found == kOptions.end()) continue;
    notice_renamed("clothbench", found->first, found->second);
    word.replace(0, end, found->second);
  }
  return words;
}

}  // namespace clothbench
