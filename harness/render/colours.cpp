#include "render/colours.hpp"

#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"

namespace clothbench::render {
namespace {

constexpr std::size_t kEntries = 256;
constexpr Rgb kNothing = {0.82, 0.89, 0.95};

double to_linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }
double to_srgb(double l) { return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055; }

// sRGB (IEC 61966-2-1) to CIE XYZ over the white D65.
constexpr double kToXyz[3][3] = {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};

std::array<double, 3> to_xyz(const std::array<double, 3>& l) {
  std::array<double, 3> out{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) out[r] += kToXyz[r][c] * l[c];
  return out;
}

/// Solves kToXyz x = b (Cramer).
std::array<double, 3> from_xyz(const std::array<double, 3>& b) {
  const auto determinant = [](const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    double m[3][3];
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) m[r][c] = c == k ? b[r] : kToXyz[r][c];
    out[k] = determinant(m) / determinant(kToXyz);
  }
  return out;
}

/// CIE 15: L*, a*, b*.
std::array<double, 3> to_lab(const Rgb& s) {
  constexpr double kStep = 6.0 / 29;
  const auto white = to_xyz({1, 1, 1}), xyz = to_xyz({to_linear(s[0]), to_linear(s[1]), to_linear(s[2])});
  std::array<double, 3> f{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double t = xyz[k] / white[k];
    f[k] = t > kStep * kStep * kStep ? std::cbrt(t) : t / (3 * kStep * kStep) + 4.0 / 29;
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

Rgb from_lab(const std::array<double, 3>& lab) {
  constexpr double kStep = 6.0 / 29;
  const double y = (lab[0] + 16) / 116;
  const std::array<double, 3> f = {y + lab[1] / 500, y, y - lab[2] / 200};
  const auto white = to_xyz({1, 1, 1});
  std::array<double, 3> xyz{};
  for (std::size_t k = 0; k < 3; ++k)
    xyz[k] = white[k] * (f[k] > kStep ? f[k] * f[k] * f[k] : 3 * kStep * kStep * (f[k] - 4.0 / 29));
  Rgb out = from_xyz(xyz);
  for (double& x : out) x = std::clamp(to_srgb(std::max(x, 0.0)), 0.0, 1.0);
  return out;
}

constexpr double kRounding = 1 + 1e-6;  // values are float32

/// 1, 2 or 5 times a power of ten, at least x.
double round_up(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double m : {1.0, 2.0, 5.0})
    if (m * power * kRounding >= x) return m * power;
  return 10 * power;
}

}  // namespace

Colour colour_from(const std::string& name) {
  for (const Colour c : {Colour::Checker, Colour::Strain, Colour::Depth})
    if (name == name_of(c)) return c;
  throw Error("--colour " + name + ": expected checker, strain or depth");
}

const char* name_of(Colour c) { return c == Colour::Checker ? "checker" : c == Colour::Strain ? "strain" : "depth"; }

Rgb between(std::span<const Rgb> stops, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const auto a = to_lab(stops[k]), b = to_lab(stops[k + 1]);
  const double w = at - static_cast<double>(k);
  return from_lab({a[0] + w * (b[0] - a[0]), a[1] + w * (b[1] - a[1]), a[2] + w * (b[2] - a[2])});
}

Rgb Scale::colour(double value) const {
  if (zero_apart && value <= 0) return kNothing;
  return between(stops, (value - low) / (high - low));
}

Scale scale_for(Colour colour, std::span<const float> values) {
  std::vector<double> size;
  double least = 0, most = 0;
  for (const float v : values) {
    if (!std::isfinite(v)) continue;
    least = std::min(least, static_cast<double>(v));
    most = std::max(most, static_cast<double>(v));
    if (colour != Colour::Depth || v > 0) size.push_back(std::abs(static_cast<double>(v)));
  }
  std::sort(size.begin(), size.end());
  const double wanted = size.empty() ? 0 : size[static_cast<std::size_t>(0.995 * static_cast<double>(size.size() - 1))];
  Scale s;
  if (colour == Colour::Strain) {
    constexpr double kLeast = 0.001;  // below it every real-time cloth would look torn
    s.high = round_up(std::max(wanted, kLeast));
    s.low = -s.high;
    s.title = "stretch";
    s.unit = "%";
    s.per_unit = 0.01;
    s.stops = {{0.13, 0.40, 0.67}, {0.95, 0.95, 0.95}, {0.70, 0.09, 0.17}};
  } else {
    constexpr double kLeast_m = 0.001;
    s.high = round_up(std::max(wanted, kLeast_m));
    s.title = "depth";
    s.unit = "mm";
    s.per_unit = 0.001;
    s.stops = {{1.0, 0.88, 0.45}, {0.93, 0.45, 0.20}, {0.65, 0.05, 0.25}, {0.20, 0.0, 0.28}};
    s.zero_apart = true;
  }
  s.clipped_low = least < s.low * kRounding;
  s.clipped_high = most > s.high * kRounding;
  return s;
}

std::vector<vec4> table_of(const Scale& s) {
  std::vector<vec4> out;
  for (std::size_t k = 0; k < kEntries; ++k) {
    const Rgb c = s.colour(s.low + (s.high - s.low) * static_cast<double>(k) / (kEntries - 1));
    out.push_back({static_cast<float>(to_linear(c[0])), static_cast<float>(to_linear(c[1])),
                   static_cast<float>(to_linear(c[2])), 1});
  }
  return out;
}

std::vector<float> positions_on(const Scale& s, std::span<const float> values) {
  std::vector<float> out;
  for (const float v : values)
    out.push_back(std::isfinite(v)
                      ? static_cast<float>(std::clamp((static_cast<double>(v) - s.low) / (s.high - s.low), 0.0, 1.0))
                      : NAN);
  return out;
}

}  // namespace clothbench::render
