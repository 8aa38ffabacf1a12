#pragma once
#include <string>

#include "check/compare.hpp"

namespace clothbench {

/// JUnit XML as CI servers read it: one test case per run (class = scene, name = solver, setting and assets), with a
/// <failure> if it failed. Improvements and new runs are in <system-out>. Text that XML 1.0 or UTF-8 does not allow is
/// replaced.
std::string junit_xml(const Checked&);

}  // namespace clothbench
