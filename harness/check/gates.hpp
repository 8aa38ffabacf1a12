#pragma once
#include <string>
#include <vector>

#include "metrics/registry.hpp"

namespace clothbench {

/// How a summary scalar is held to its baseline, or nullptr if it is not. By the registry; a bound's outcome has no
/// slack.
const Gate* find_gate(const std::string& name);

/// Whether it is a bound's outcome, 1 pass or 0 fail: fail after pass fails, pass after fail is an improvement.
bool is_verdict(const std::string& name);

std::vector<std::string> gated_names();

/// How far a value may lie from `baseline` on either side [unit of the scalar]. `length_m`: shorter side of the cloth.
double slack(const Gate&, double baseline, double length_m);

/// "0.01 L + 10 %; none at 0", L the shorter side.
std::string slack_text(const Gate&);

}  // namespace clothbench
