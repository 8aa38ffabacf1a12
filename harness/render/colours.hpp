#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "render/render_shared.h"

namespace clothbench::render {

using Rgb = std::array<double, 3>;  ///< sRGB, 0..1

enum class Colour { Checker, Strain, Depth };
/// "checker", "strain", "depth". Throws Error naming them.
Colour colour_from(const std::string& name);
const char* name_of(Colour);

/// Interpolates between evenly spaced `stops` in CIELAB, where equal steps look equal; `t` from 0 to 1.
Rgb between(std::span<const Rgb> stops, double t);

/// Maps numbers to colours. Both maps are readable with red-green colour blindness, and get darker away from 0.
struct Scale {
  double low = 0, high = 1;                        ///< values at the ends of the bar
  bool clipped_low = false, clipped_high = false;  ///< there are values beyond this end
  std::string title, unit;                         ///< "stretch", "%"
  double per_unit = 1;                             ///< value of one unit: 0.01 for %
  std::vector<Rgb> stops;
  bool zero_apart = false;  ///< 0 has a colour of its own

  Rgb colour(double value) const;  ///< clamped at the ends
};

/// A scale whose ends are round numbers and enclose 99.5 % of the values: -x..x for strain (a ratio), 0..x for depth
/// [m]. Ignores values that are not finite.
Scale scale_for(Colour, std::span<const float> values);

/// The arguments of SceneRenderer::write_values: the scale's colours in linear RGB, and values mapped to 0..1.
std::vector<vec4> table_of(const Scale&);
std::vector<float> positions_on(const Scale&, std::span<const float> values);

}  // namespace clothbench::render
