#include "metrics/friction_forms.hpp"

#include <fmt/format.h>

#include <cmath>

#include "clothbench/error.hpp"
#include "truth/norms.hpp"

namespace clothbench {
namespace {

constexpr double kLow = 0.5, kHigh = 1.5, kFinest = 1e-3;

double quantity_of(const RunRecord& run) {
  const auto at = run.summary.find("truth_quantity");
  return at == run.summary.end() ? kMissing : at->second;
}

}  // namespace

const std::vector<FrictionForm>& friction_forms() {
  static const std::vector<FrictionForm> all = [] {
    const truth::Tolerance &slope = truth::tolerance_of("incline"), &cylinder = truth::tolerance_of("capstan");
    const auto share = [](const char* scene, const std::string& what, double at_most) {
      return FrictionForm{scene, fmt::format("{}, ≤ {:g}", what, 100 * at_most), false, 100, 100 * at_most};
    };
    return std::vector<FrictionForm>{
        {"incline-stick", "critical angle [°], ≤ 0.1", true, 1, 0.1},
        share("incline-stick", "creep in 2 s [% L]", slope.at_rest),
        share("incline-slip", "slip distance [%]", slope.of_motion),
        share("incline-stop", "stopping distance [%]", slope.of_motion),
        {"capstan-hold", fmt::format("overhang held [%], ≤ {:g}", 100 * cylinder.of_motion), true, 100,
         100 * cylinder.of_motion},
        share("capstan-slip", "slip round the capstan [%]", cylinder.of_motion)};
  }();
  return all;
}

FoundThreshold search_threshold(const truth::Threshold& t, const std::function<std::optional<bool>(double)>& holds) {
  FoundThreshold out;
  out.exact = t.exact;
  const auto ask = [&](double friction) {
    if (out.failed) return false;
    ++out.runs;
    const std::optional<bool> answer = holds(friction);
    out.failed = !answer;
    return answer.value_or(false);
  };
  double low = kLow * t.exact, high = kHigh * t.exact;
  if (!ask(high)) {
    out.slips_at_most = true;
    out.found = high;
  } else if (ask(low)) {
    out.holds_at_least = true;
    out.found = low;
  } else {
    while (!out.failed && high - low > kFinest * t.exact) (ask((low + high) / 2) ? high : low) = (low + high) / 2;
    out.found = (low + high) / 2;
  }
  if (out.failed) {
    out.found = out.error = kMissing;
    out.holds_at_least = out.slips_at_most = false;
    return out;
  }
  out.error = t.error(out.found);
  return out;
}

std::string tried_scene(const std::string& scene, double friction) {
  return fmt::format("{}-friction={}", scene, friction);
}

std::optional<bool> stayed(const truth::Threshold& t, const RunRecord& run) {
  if (run.outcome.status != "ok" || run.withheld.contains("truth_quantity")) return std::nullopt;
  return std::abs(quantity_of(run)) <= t.held_below_m;
}

double end_error(const Scene& scene, const RunRecord& run) {
  const auto known = truth::reference_case_of(scene);
  if (!known) throw Error(scene.source + ": /truth: missing");
  if (run.outcome.status != "ok") return kMissing;
  return truth::quantity_error(quantity_of(run), known->quantity(known->columns(scene.time.frames())),
                               known->quantity_scale);
}

}  // namespace clothbench
