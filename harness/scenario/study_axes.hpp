#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clothbench {

/// Most runs of a study: each is a file, and all are planned before the first begins.
inline constexpr std::size_t kMostRuns = 100000;

/// One form of a scene of a study: a choice of a value on each axis.
struct Variant {
  std::string suffix;                        ///< of the scene's name: "-32-single"
  std::vector<std::string> overrides, tags;  ///< overrides: as `--set` takes them; tags: labels of its values
  bool timed = true;
  bool merged = false;  ///< an override fixes the value on an axis, for all that differed in it
};

/// Cartesian product of a scene's axes; the first varies slowest. Where one of `set` (`key=value`, as in `--set`) fixes
/// an axis, that axis has this one value: under its own label if the axis lists it, else under the value as a label.
/// It then has every label of the axis as a tag. Throws Error naming `source` and the JSON
/// pointer if the numbers of values and labels differ, or if there would be more than `kMostRuns` scenes.
std::vector<Variant> expand(const nlohmann::json& axes, const std::string& pointer, const std::string& source,
                            const std::vector<std::string>& set);

}  // namespace clothbench
