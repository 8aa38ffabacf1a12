#include "plugin/plugin.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <list>
#include <sstream>

#include "base/child_process.hpp"
#include "clothbench/error.hpp"
#include "plugin/scene_view.hpp"

namespace clothbench::plugin {
namespace {

namespace fs = std::filesystem;

constexpr char kSymbol[] = "clothbench_plugin";
using Entrance = const ClothbenchPlugin* (*)();

// A new feature needs its bit in clothbench_plugin.h.
#define FEATURE(id, name, bit, of, doc, needed) static_assert(CLOTHBENCH_##bit == 1 << static_cast<int>(Feature::id));
#include "clothbench/feature_table.hpp"
#undef FEATURE

struct Loaded {
  std::string path;
  SolverEntry entry;
};

std::list<Loaded>& loaded() {  // a list, because pointers to its entries must stay valid
  static std::list<Loaded> all;
  return all;
}

Entrance entrance(void* library) { return reinterpret_cast<Entrance>(dlsym(library, kSymbol)); }

[[noreturn]] void refuse(const std::string& path, const std::string& what) { throw Error(path + ": " + what); }

void check_sizes(const std::string& path, const ClothbenchPlugin& c) {
  if (c.version != CLOTHBENCH_PLUGIN_VERSION)
    refuse(path, fmt::format("it was built for version {} of clothbench_plugin.h; this program expects version {}",
                             c.version, CLOTHBENCH_PLUGIN_VERSION));
  struct Size {
    const char* what;
    std::uint32_t theirs;
    std::size_t ours;
  };
  for (const Size& s : {Size{"ClothbenchPlugin", c.plugin_size, sizeof(ClothbenchPlugin)},
                        {"ClothbenchScene", c.scene_size, sizeof(ClothbenchScene)},
                        {"ClothbenchFrame", c.frame_size, sizeof(ClothbenchFrame)},
                        {"ClothbenchEdge", c.edge_size, sizeof(ClothbenchEdge)},
                        {"ClothbenchCollider", c.collider_size, sizeof(ClothbenchCollider)},
                        {"ClothbenchPose", c.pose_size, sizeof(ClothbenchPose)},
                        {"ClothbenchSetting", c.setting_size, sizeof(ClothbenchSetting)},
                        {"ClothbenchStage", c.stage_size, sizeof(ClothbenchStage)}})
    if (s.theirs != s.ours)
      refuse(path, fmt::format("its {} has {} bytes: expected {}; it was built with a different clothbench_plugin.h",
                               s.what, s.theirs, s.ours));
}

void check_settings(const std::string& path, const ClothbenchPlugin& c) {
  for (std::uint32_t k = 0; k < c.setting_count; ++k) {
    const ClothbenchSetting& s = c.settings[k];
    if (s.name == nullptr || *s.name == '\0' || s.doc == nullptr)
      refuse(path, fmt::format("settings: {}: expected a name and a doc", k));
    if (!std::isfinite(s.default_value) || (s.integer != 0 && s.default_value != std::floor(s.default_value)))
      refuse(path,
             fmt::format("settings: {}: its default is not {}", s.name, s.integer != 0 ? "a whole number" : "finite"));
  }
}

void check_description(const std::string& path, const ClothbenchPlugin& c) {
  const std::string name = c.name != nullptr ? c.name : "";
  if (name.empty() ||
      name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") != std::string::npos)
    refuse(path, "name: expected letters, digits, . _ -; found \"" + name + "\"");
  for (const SolverEntry& e : solvers())
    if (e.info.name == name)
      refuse(path, "name: \"" + name + "\" is already a solver of clothbench; expected another name");
  for (const auto& [what, text] :
       {std::pair{"summary", c.summary}, {"solver_version", c.solver_version}, {"precision", c.precision}})
    if (text == nullptr || *text == '\0') refuse(path, fmt::format("{}: expected a text", what));
  if (std::string(c.precision) != "float32" && std::string(c.precision) != "float64")
    refuse(path, "precision: expected float32 or float64");
  if (((c.supports | c.ignores) >> kFeatureCount) != 0)
    refuse(path, "supports, ignores: expected bits of known features only");
  if ((c.supports & c.ignores) != 0) refuse(path, "supports, ignores: expected each feature in one of them only");
  if (c.engine != nullptr && *c.engine == '\0') refuse(path, "engine: expected a text or NULL");
  if (c.time_order < 1) refuse(path, "time_order: expected 1 or more");
  for (const auto& [what, there] : {std::pair{"create", c.create != nullptr},
                                    {"destroy", c.destroy != nullptr},
                                    {"restart", c.restart != nullptr},
                                    {"step", c.step != nullptr},
                                    {"read_state", c.read_state != nullptr},
                                    {"stages", c.stages != nullptr},
                                    {"settings", c.settings != nullptr || c.setting_count == 0}})
    if (!there) refuse(path, fmt::format("{}: missing", what));
  check_settings(path, c);
}

const ClothbenchPlugin& checked(const std::string& path, const ClothbenchPlugin* c) {
  if (c == nullptr) refuse(path, fmt::format("{} returns nothing", kSymbol));
  check_sizes(path, *c);
  check_description(path, *c);
  return *c;
}

/// Loads a library and reads its description in a child process, because its code may crash or hang.
void probe(const std::string& path) {
  constexpr unsigned kPatience_s = 30;
  const pid_t child = fork();
  if (child < 0)
    throw Error(path + ": cannot be tried in a child process: " + std::strerror(errno), ExitCode::CheckFailed);
  if (child == 0) {
    for (const int s : {SIGINT, SIGTERM, SIGALRM, SIGABRT}) std::signal(s, SIG_DFL);
    alarm(kPatience_s);
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    const Entrance enter = library != nullptr ? entrance(library) : nullptr;
    const ClothbenchPlugin* c = enter != nullptr ? enter() : nullptr;
    try {
      checked(path, c);
    } catch (const Error&) {  // the parent process also loads it and reports the error
    }
    _exit(0);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status))
    throw Error(fmt::format("{}: it {} when it is loaded: signal {} ({})", path,
                            WTERMSIG(status) == SIGALRM ? "hangs" : "crashes", WTERMSIG(status),
                            strsignal(WTERMSIG(status))));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw Error(path + ": it ends the program when it is loaded");
}

SolverInfo describe(const std::string& path, const ClothbenchPlugin& c) {
  SolverInfo info;
  info.name = c.name;
  info.folder = kPluginPrefix + path;
  info.summary = c.summary;
  info.version = c.solver_version;
  info.precision = c.precision;
  info.on_gpu = c.device_s != nullptr;
  info.supports = FeatureSet(c.supports);
  info.ignores = FeatureSet(c.ignores);
  info.time_order = c.time_order;
  if (c.engine != nullptr) info.engine = c.engine;
  for (std::uint32_t k = 0; k < c.setting_count; ++k) {
    const ClothbenchSetting& s = c.settings[k];
    const nlohmann::json value =
        s.integer != 0 ? nlohmann::json(static_cast<std::int64_t>(s.default_value)) : nlohmann::json(s.default_value);
    info.settings.push_back({s.name, dump(value), s.doc});
  }
  return info;
}

/// Exact displacement of a body in free fall with damping: dv/dt = g - c v.
double exact_fall_m(double time_s, double gravity, double velocity, double damping) {
  if (damping == 0) return velocity * time_s + gravity * time_s * time_s / 2;
  const double end = gravity / damping;
  return end * time_s - (velocity - end) * std::expm1(-damping * time_s) / damping;
}

SolverEntry entry_of(const std::string& path, const ClothbenchPlugin& c) {
  SolverEntry entry;
  entry.info = describe(path, c);
  entry.make = [&c, info = entry.info](const nlohmann::json& settings, const DeviceOptions&) {
    return make_solver(c, info, settings);
  };
  entry.free_fall_m = [&c](const Scene& s, const nlohmann::json& settings, int frames) {
    const double g = s.gravity_m_per_s2[1], v = s.cloth.initial_velocity_m_per_s[1], damping = s.material.damping_per_s;
    if (c.free_fall_m == nullptr) return exact_fall_m(s.time.at(frames), g, v, damping);
    return c.free_fall_m(setting_values(c, settings).data(), s.time.dt(), g, v, damping, frames);
  };
  return entry;
}

/// Adds a library to $CLOTHBENCH_PLUGINS, for processes started from this one.
void remember(const std::string& path) {
  const char* before = std::getenv(kPluginsVariable);
  const std::string all = before != nullptr ? before : "";
  if ((":" + all + ":").find(":" + path + ":") == std::string::npos)
    setenv(kPluginsVariable, (all.empty() ? path : all + ":" + path).c_str(), 1);
}

}  // namespace

const SolverEntry& load(const std::string& given) {
  std::error_code missing;
  const fs::path file = fs::canonical(given, missing);
  if (missing)
    throw Error(given + ": " + missing.message() +
                "; expected a solver as a shared library (solvers/plugin/README.md)");
  const std::string path = file.string();
  for (const Loaded& l : loaded())
    if (l.path == path) return l.entry;
  if (!solvers_in_process()) probe(path);
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse(path, fmt::format("cannot be loaded: {}", dlerror()));
  const Entrance enter = entrance(library);
  if (enter == nullptr) refuse(path, fmt::format("has no function {}: expected a clothbench plugin", kSymbol));
  const ClothbenchPlugin& plugin = checked(path, enter());
  for (const Loaded& l : loaded())
    if (l.entry.info.name == plugin.name)
      refuse(path, fmt::format("name: \"{}\" is already the name of {}; expected another", plugin.name, l.path));
  loaded().push_back({path, entry_of(path, plugin)});
  remember(path);
  return loaded().back().entry;
}

const SolverEntry* find(const std::string& name) {
  const auto among = [&]() -> const SolverEntry* {
    for (const Loaded& l : loaded())
      if (l.entry.info.name == name) return &l.entry;
    return nullptr;
  };
  if (const SolverEntry* e = among()) return e;
  const char* listed = std::getenv(kPluginsVariable);
  std::istringstream paths(listed != nullptr ? listed : "");
  for (std::string path; std::getline(paths, path, ':');)
    if (!path.empty()) load(path);
  return among();
}

}  // namespace clothbench::plugin
