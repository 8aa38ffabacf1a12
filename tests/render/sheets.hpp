#pragma once
#include <png.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"
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

/// A folder that is gone with the test.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const std::string& name)
      : path(std::filesystem::temp_directory_path() / ("clothbench-" + name + "-" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

}  // namespace clothbench::render
