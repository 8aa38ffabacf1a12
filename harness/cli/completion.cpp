// Completion of the command line. The answers come from the declared commands and options and from the solvers and
// files that exist, so they cannot become outdated.
#include <algorithm>

#include "base/words.hpp"
#include "cli/command.hpp"
#include "cli/texts.hpp"

namespace clothbench {
namespace {

using Words = std::vector<std::string>;

/// `--set solver.<name>=` of the solvers named so far, or of all.
Words setting_names(const Words& before) {
  Words names;
  for (const SolverEntry& e : solvers()) {
    if (!contains(before, "--solver") || contains(before, e.info.name))
      for (const SettingSpec& s : e.info.settings) names.push_back("solver." + s.name + "=");
  }
  return names;
}

Words candidates(const CLI::App& app, const Words& before, const std::string& prefix) {
  Words names;
  const CLI::App* command = nullptr;
  for (const CLI::App* c : app.get_subcommands({})) {
    if (before.empty() && !c->get_group().empty()) names.push_back(c->get_name());
    if (!before.empty() && before.front() == c->get_name()) command = c;
  }
  if (command == nullptr) return names;
  const std::string& last = before.back();
  if (last == "--solver") return solver_names();
  if (last == "--set") return setting_names(before);
  if (last == "--device-profile") return {"adreno-like"};
  if (prefix.starts_with("-")) {
    for (const CLI::App* a : {command, &app})
      for (const CLI::Option* o : a->get_options())
        for (const std::string& name : o->get_lnames()) names.push_back("--" + name);
    return names;
  }
  const std::string& name = command->get_name();
  if (name == "study") {
    for (const std::string& study : scene_names({"studies"})) names.push_back(study.substr(study.find('/') + 1));
    return names;
  }
  if (name == "conformance") return solver_names();
  if (name == "list") return list_names();
  if (name == "run" || name == "plan" || name == "validate" || name == "xr")
    return scene_names({"paper", "contact", "garments", "validation", "stability", "conformance"});
  return names;
}

}  // namespace

void add_completion(CLI::App& app, Console& console) {
  auto& shell = console.arguments<std::string>();
  auto& words = console.arguments<Words>();
  CLI::App* cmd = app.add_subcommand("completion", "Print a script that completes this command in bash, zsh or fish");
  cmd->add_option("shell", shell,
                  "bash, zsh or fish; `words` prints completions of the word that a command line ends with")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish", "words"}));
  cmd->add_option("words", words, "The command line after the program's name");
  cmd->footer(
      "Examples: source <(clothbench completion bash)\n"
      "          clothbench completion zsh > ~/.zfunc/_clothbench\n"
      "          clothbench completion fish > ~/.config/fish/completions/clothbench.fish");
  cmd->callback([&app, &console, &shell, &words] {
    const std::string script = shell == "bash"   ? texts::kBash
                               : shell == "zsh"  ? texts::kZsh
                               : shell == "fish" ? texts::kFish
                                                 : "";
    if (!script.empty() && console.json) return Console::print({{"shell", shell}, {"script", script}});
    if (!script.empty()) return fmt::print("{}", script);
    const std::string prefix = words.empty() ? "" : words.back();
    if (!words.empty()) words.pop_back();
    Words found = candidates(app, words, prefix);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (console.json) {
      std::erase_if(found, [&](const std::string& word) { return !word.starts_with(prefix); });
      return Console::print(found);
    }
    for (const std::string& word : found)
      if (word.starts_with(prefix)) fmt::print("{}\n", word);
  });
}

}  // namespace clothbench
