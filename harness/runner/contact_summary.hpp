#pragma once
#include <map>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// What becomes of contact over the time of an accuracy pass; harness/metrics/README.md has the definitions. Every
/// name is there; NaN where a value is not defined or the pass does not tell.
std::map<std::string, double> summarise_contact(const Scene&, const AccuracyPass&);

/// Speed [m/s] that the scene imposes: of the sweep or pull that a hand was told ("speed_m_per_s"), else the greatest
/// of any collider or grip from frame to frame, else that at which the cloth starts.
double imposed_speed(const Scene&);

}  // namespace clothbench
