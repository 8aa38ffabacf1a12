#include <png.h>

#include "clothbench/error.hpp"
#include "render/picture.hpp"

namespace clothbench::render {

void write_png(const std::filesystem::path& path, const Picture& picture) {
  const std::filesystem::path unfinished = path.string() + ".part";
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  const bool written = png_image_write_to_file(&image, unfinished.c_str(), 0, picture.rgb.data(), 0, nullptr) != 0;
  std::error_code error;
  if (written) std::filesystem::rename(unfinished, path, error);
  if (written && !error) return;
  const std::string why = written ? error.message() : image.message;
  std::filesystem::remove(unfinished, error);
  throw Error(path.string() + ": cannot be written: " + why);
}

Picture read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0)
    throw Error(path.string() + ": not a PNG: " + image.message);
  image.format = PNG_FORMAT_RGB;
  Picture out(static_cast<int>(image.width), static_cast<int>(image.height), 0);
  if (png_image_finish_read(&image, nullptr, out.rgb.data(), 0, nullptr) == 0)
    throw Error(path.string() + ": not a whole PNG: " + image.message);
  return out;
}

}  // namespace clothbench::render
