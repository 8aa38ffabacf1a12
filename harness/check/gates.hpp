#pragma once
#include <string>
#include <vector>

#include "metrics/registry.hpp"

namespace clothbench {

/// Rule that compares a summary scalar with its baseline, from the metric registry; nullptr if it is not compared. The
/// result of a bound has no slack.
const Gate* find_gate(const std::string& name);

/// Whether it is the result of a bound, 1 pass or 0 fail: fail after pass fails, pass after fail is an improvement.
bool is_verdict(const std::string& name);

std::vector<std::string> gated_names();

/// Allowed deviation from `baseline` in either direction [unit of the scalar]. `length_m`: shorter side of the cloth.
double slack(const Gate&, double baseline, double length_m);

/// "0.01 L + 10 %; none at 0", where L is the shorter side.
std::string slack_text(const Gate&);

}  // namespace clothbench
