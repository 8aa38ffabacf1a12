#pragma once
#include <png.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/vector.hpp"
#include "render/offscreen.hpp"

namespace clothbench::render {

/// A sheet in the plane z = 0 about the origin, its front (axis_u x axis_v) towards +z.
inline Cloth upright(int columns, int rows, double width_m = 1, double height_m = 1) {
  Cloth c;
  c.columns = columns;
  c.rows = rows;
  c.width_m = width_m;
  c.height_m = height_m;
  c.axis_u = {1, 0, 0};
  c.axis_v = {0, 1, 0};
  return c;
}

inline std::vector<double> positions_of(const Cloth& cloth) {
  Scene s;
  s.cloth = cloth;
  return initial_positions(s);
}

/// A camera in front of the origin that looks along -z and sees a square of 2 m there.
inline Camera front_camera() {
  Camera c;
  c.eye_m = {0, 0, 5};
  c.right = {1, 0, 0};
  c.up = {0, 1, 0};
  c.back = {0, 0, 1};
  c.tan_half_width = c.tan_half_height = 0.22;
  c.near_m = 1;
  c.far_m = 20;
  return c;
}

/// Position of a point in the image: 0..1 from left and from top; empty if it is behind the camera.
inline std::optional<std::array<double, 2>> seen_at(const Camera& c, const Vec3& p) {
  const Vec3 d = minus(p, c.eye_m);
  const double depth = -dot(d, c.back);
  if (!(depth > 0)) return std::nullopt;
  return std::array<double, 2>{0.5 + 0.5 * dot(d, c.right) / depth / c.tan_half_width,
                               0.5 - 0.5 * dot(d, c.up) / depth / c.tan_half_height};
}

/// Throws Error naming the file unless it is a whole PNG.
inline Picture read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) throw Error(path.string() + ": " + image.message);
  image.format = PNG_FORMAT_RGB;
  Picture out(static_cast<int>(image.width), static_cast<int>(image.height));
  if (png_image_finish_read(&image, nullptr, out.rgb.data(), 0, nullptr) == 0)
    throw Error(path.string() + ": " + image.message);
  return out;
}

}  // namespace clothbench::render
