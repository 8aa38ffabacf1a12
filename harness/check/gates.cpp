#include "check/gates.hpp"

#include <fmt/format.h>

#include <cmath>

namespace clothbench {
namespace {

constexpr Gate kVerdict{};  // its tolerance is in the scene

}  // namespace

const Gate* find_gate(const std::string& name) {
  if (is_verdict(name)) return &kVerdict;
  const Scalar* s = find_scalar(name);
  return s == nullptr ? nullptr : s->gate;
}

bool is_verdict(const std::string& name) { return name.starts_with(kExpect); }

std::vector<std::string> gated_names() {
  std::vector<std::string> names = {kExpect + "*"};
  for (const Scalar& s : scalars())
    if (s.gate != nullptr) names.push_back(s.name);
  return names;
}

double slack(const Gate& g, double baseline, double length_m) {
  if (g.zero_stays_zero && baseline == 0) return 0;
  const double unit = g.unit == SlackUnit::Length ? length_m : 1;
  return g.absolute * unit + g.relative * std::fabs(baseline);
}

std::string slack_text(const Gate& g) {
  const char* unit = g.unit == SlackUnit::Length ? " L" : "";
  std::string text;
  if (g.absolute > 0) text = fmt::format("{}{}", g.absolute, unit);
  if (g.relative > 0) text += (text.empty() ? "" : " + ") + fmt::format("{} %", 100 * g.relative);
  if (text.empty()) return "none";
  return text + (g.zero_stays_zero ? "; none at 0" : "");
}

}  // namespace clothbench
