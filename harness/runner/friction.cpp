#include "runner/friction.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "runner/threshold.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

json told(const FrictionForm& form, const json& error, const std::string& text) {
  return {{"scene", form.scene}, {"what", form.head}, {"error", error}, {"at_most", form.at_most}, {"text", text}};
}

json ask(const FrictionForm& form, const SolverEntry& entry, const json& settings, const std::vector<std::string>& set,
         const DeviceOptions& device) {
  const Scene scene = load_scene(std::string("validation/") + form.scene, set);
  if (!unsupported(entry.info, scene.needs).empty()) return told(form, nullptr, "unsupported");
  FoundThreshold t;
  if (form.threshold)
    t = find_threshold(scene, entry, settings, device);
  else
    t.error = end_error(scene, entry, settings, device);
  const double error = form.scale * t.error;
  if (!std::isfinite(error)) return told(form, nullptr, "failed");
  if (t.holds_at_least) return told(form, error, "holds at half of it");
  if (t.slips_at_most) return told(form, error, "slips at 1.5 of it");
  return told(form, error,
              fmt::format("{}{:.2g}{}", form.threshold && error > 0 ? "+" : "", error,
                          std::abs(error) <= form.at_most ? " ✓" : ""));
}

}  // namespace

const std::vector<FrictionForm>& friction_forms() {
  static const std::vector<FrictionForm> all = {{"incline-stick", "critical angle [°], ≤ 0.1", true, 1, 0.1},
                                                {"incline-stick", "creep in 2 s [% L], ≤ 0.01", false, 100, 0.01},
                                                {"incline-slip", "way down [%], ≤ 2", false, 100, 2},
                                                {"incline-stop", "way to stop [%], ≤ 2", false, 100, 2},
                                                {"capstan-hold", "overhang held [%], ≤ 3", true, 100, 3},
                                                {"capstan-slip", "way round [%], ≤ 3", false, 100, 3},
                                                {"atwood", "way of Atwood's strip [%], ≤ 3", false, 100, 3}};
  return all;
}

json ask_friction(Guard& guard, const FrictionForm& form, const SolverEntry& entry, const json& settings,
                  const std::vector<std::string>& set, const DeviceOptions& device, std::string& crash) {
  const Guard::Answer given = guard.run(entry, [&] { return ask(form, entry, settings, set, device); });
  crash = given.crash;
  return crash.empty() ? given.value : told(form, nullptr, "crashed");
}

}  // namespace clothbench
