#pragma once
#include <nlohmann/json.hpp>

#include "assets/mesh.hpp"
#include "clothbench/collider.hpp"

namespace clothbench {

/// Converts a JSON array of three numbers, already validated by the schema.
inline Vec3 vec3(const nlohmann::json& j) { return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()}; }
inline Vec3 to_vec3(const assets::Vector& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace clothbench
