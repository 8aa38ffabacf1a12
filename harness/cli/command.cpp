#include "cli/command.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/json_text.hpp"
#include "results/store.hpp"
#include "runner/again.hpp"

namespace clothbench {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string left_for(double s) {
  constexpr double kFewSeconds = 100;
  return s < kFewSeconds ? fmt::format("about {:.0f} s left", s) : fmt::format("about {:.0f} min left", s / 60);
}

std::size_t columns() {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : kUsual;
}

}  // namespace

Overrides split_overrides(const std::vector<std::string>& set) {
  const std::string prefix = "solver.";
  Overrides out;
  for (const std::string& item : set) {
    if (item.rfind(prefix, 0) != 0) {
      out.scene.push_back(item);
      continue;
    }
    const auto eq = item.find('=');
    if (eq == std::string::npos) throw Error("--set " + item + ": expected solver.<name>=<value>");
    const std::string key = item.substr(prefix.size(), eq - prefix.size()), text = item.substr(eq + 1);
    nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
    if (value.is_discarded()) value = text;
    if (const std::string tuning = std::string(kTuning) + "."; key.starts_with(tuning))
      out.solver[kTuning].update({{key.substr(tuning.size()), value}});
    else
      out.solver[key] = value;
  }
  return out;
}

std::string Overrides::label() const {
  std::string text;
  const nlohmann::json flat = flat_settings(solver);
  for (const auto& [key, value] : flat.items())
    text += (text.empty() ? "" : ",") + key + "=" + (value.is_string() ? value.get<std::string>() : value.dump());
  return text.empty() ? "default" : text;
}

void write_between_marks(const std::string& file, const std::string& name, const std::string& text) {
  const std::string begin = "<!-- " + name + " begin -->\n", end = "<!-- " + name + " end -->";
  std::string all = read_text(file);
  const std::size_t from = all.find(begin), to = all.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from)
    throw Error(file + ": expected the lines " + begin.substr(0, begin.size() - 1) + " and " + end);
  all.replace(from + begin.size(), to - from - begin.size(), text);
  write_file_atomically(file, all);
}

ChosenSolver chosen_solver(const std::string& name, const Overrides& overrides) {
  const SolverEntry& entry = find_solver(name);
  return {&entry, complete_settings(entry.info, overrides.solver), overrides.label()};
}

std::vector<std::string> solver_names(bool (*are)(const SolverInfo&)) {
  std::vector<std::string> names;
  for (const SolverEntry& e : solvers())
    if (are == nullptr || are(e.info)) names.push_back(e.info.name);
  return names;
}

std::vector<std::string> scene_names(const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  const std::filesystem::path root = scenario_root();
  for (const std::string& folder : folders) {
    if (!std::filesystem::exists(root / folder)) continue;
    const std::size_t first = names.size();
    for (const auto& file : std::filesystem::recursive_directory_iterator(root / folder))
      if (file.path().extension() == ".json")
        names.push_back(std::filesystem::relative(file.path(), root).replace_extension().string());
    std::sort(names.begin() + static_cast<std::ptrdiff_t>(first), names.end());
  }
  return names;
}

void SolverFlags::add_to(CLI::App& app, const std::string& option, const std::string& help,
                         const std::string& set_help) {
  add_solvers(app, option, solvers, help);
  app.add_option("--set", set, set_help);
}

std::vector<ChosenSolver> SolverFlags::chosen(const std::vector<std::string>& by_default) const {
  const Overrides overrides = split_overrides(set);
  std::vector<ChosenSolver> out;
  for (const std::string& name : solvers.empty() ? by_default : solvers) out.push_back(chosen_solver(name, overrides));
  return out;
}

Overrides SolverFlags::of_solver(const std::string& expected) const {
  Overrides overrides = split_overrides(set);
  if (!overrides.scene.empty()) throw Error("--set " + overrides.scene[0] + ": " + expected);
  return overrides;
}

std::pair<int, int> pixels_of(const std::string& option, const std::string& text) {
  constexpr int kMost = 16384;
  int width = 0, height = 0, used = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) != 2 || used != static_cast<int>(text.size()) ||
      width < 1 || height < 1 || width > kMost || height > kMost)
    throw Error(option + " " + text + ": expected WIDTHxHEIGHT in pixels, such as 1200x900");
  return {width, height};
}

void DeviceFlags::add_to(CLI::App& app) {
  app.add_option("--device", options.index, "Vulkan device number (see `list devices`); default: the best one");
  app.add_option("--device-profile", options.profile,
                 "Use only what a class of devices offers: adreno-like (32 KiB shared memory, groups of 256, no float "
                 "atomics, 64 dispatches a submission)");
  app.add_flag("--validate", options.validation,
               "Vulkan core and synchronization validation; any message fails the run");
  app.add_flag("--allow-no-device", allow_no_device, "Leave out GPU solvers if there is no Vulkan device");
}

CLI::Option* add_solvers(CLI::App& app, const std::string& option, std::vector<std::string>& names,
                         const std::string& help) {
  const auto name_of_plugin = [](std::string name) {
    return name.starts_with(kPluginPrefix) ? find_solver(name).info.name : name;
  };
  return app.add_option(option, names, help + "; plugin:PATH loads a solver from a shared library")
      ->transform(name_of_plugin);
}

void add_require_assets(CLI::App& app, bool& required) {
  app.add_flag("--require-assets", required,
               "Fail if a scene would use procedural rooms or hands in place of scans (scripts/fetch-assets.sh "
               "fetches the scans)");
}

StatusLine::StatusLine(bool enabled)
    : enabled_(enabled && isatty(STDERR_FILENO) != 0 && !Guard::in_child()), start_s_(now_s()) {}

StatusLine::~StatusLine() {
  if (enabled_ && width_ > 0) fmt::print(stderr, "\r{:{}}\r", "", width_);
}

void StatusLine::show(const std::string& what, std::size_t done, std::size_t total) {
  if (!enabled_) return;
  const double elapsed_s = now_s() - start_s_;
  std::string line = total > 0 ? fmt::format("[{}/{}] {}", done, total, what) : what, eta;
  if (done > 0 && done < total)
    eta = "  " + left_for(elapsed_s / static_cast<double>(done) * static_cast<double>(total - done));
  // A line that breaks could not be rewritten.
  const std::size_t room = columns() - 1;
  if (line.size() + eta.size() > room) line.resize(room > eta.size() ? room - eta.size() : 0);
  line += eta;
  fmt::print(stderr, "\r{:<{}}", line, width_);
  std::fflush(stderr);
  width_ = line.size();
}

}  // namespace clothbench
