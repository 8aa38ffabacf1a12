#include "render/pictures.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <sstream>

#include "base/child_process.hpp"
#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "results/store.hpp"

namespace clothbench::render {
namespace {

namespace fs = std::filesystem;

std::uint32_t middle_vertex(const Cloth& c) {
  return static_cast<std::uint32_t>((c.rows / 2) * c.columns + c.columns / 2);
}

bool is_free(const Scene& s) { return s.colliders.empty() && s.grips.vertices.empty() && s.pins.vertices.empty(); }

/// An MP4 movie of equally large images, made by the program ffmpeg, which reads the images from a pipe.
class Movie {
 public:
  // H.264 with 4:2:0 chroma, which every player shows, needs even sizes.
  Movie(fs::path file, int width, int height, double frames_per_s)
      : file_(std::move(file)),
        log_(file_.string() + ".log"),
        ffmpeg_({"ffmpeg",      "-loglevel",
                 "error",       "-y",
                 "-f",          "rawvideo",
                 "-pix_fmt",    "rgb24",
                 "-s",          fmt::format("{}x{}", width, height),
                 "-r",          fmt::format("{:.6g}", frames_per_s),
                 "-i",          "pipe:0",
                 "-vf",         "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                 "-c:v",        "libx264",
                 "-crf",        "18",
                 "-pix_fmt",    "yuv420p",
                 "-movflags",   "+faststart",
                 "-f",          "mp4",
                 file_.string()},
                {.socket = true, .out = "/dev/null", .err = log_}) {}

  void add(const Picture& picture) {
    if (ffmpeg_.write({reinterpret_cast<const char*>(picture.rgb.data()), picture.rgb.size()})) return;
    finish();  // throws with ffmpeg's output, if there is any
    throw Error(file_.string() + ": ffmpeg ended too early");
  }

  /// Waits until the file is complete.
  void finish() {
    ffmpeg_.close_socket();
    const ChildEnd end = ffmpeg_.wait();
    const std::string printed = content_of(log_);
    std::error_code ignored;
    fs::remove(log_, ignored);
    if (end.how != ChildEnd::How::Exited || end.code != 0) throw Error(file_.string() + ": ffmpeg failed: " + printed);
  }

 private:
  fs::path file_, log_;
  ChildProcess ffmpeg_;
};

}  // namespace

std::vector<double> Motion::at(std::size_t frame) const {
  const std::size_t count = 3 * scene.cloth.vertex_count();
  const auto from = position.begin() + static_cast<std::ptrdiff_t>(frame * count);
  return {from, from + static_cast<std::ptrdiff_t>(count)};
}

Motion stored_motion(const fs::path& path) {
  if (const fs::path end = path.extension(); end != ".h5" && end != ".cbor" && end != ".part")
    throw Error(path.string() + ": expected a result file (.h5, .cbor, .part); `clothbench run` makes them");
  const RunRecord record = read_run_summary(path);
  StoredMotion stored = read_motion(path);
  Motion m{std::move(stored.scene), run_name(record.header), std::move(stored.time_s), std::move(stored.position)};
  if (m.frames() == 0)
    throw Error(fmt::format("{}: {} has no trajectory ({})", path.string(), m.name, record.outcome.status));
  return m;
}

Framing framing_of(const Motion& m) {
  constexpr double kSeenBeside = 0.12;  // fraction of the sheet's size: colliders this close to the cloth are in view,
  constexpr double kDrawnBeside = 0.5;  // and colliders this close are drawn
  constexpr std::size_t kSamples = 48;  // number of frames
  Framing f;
  const Cloth& cloth = m.scene.cloth;
  const double size = std::max({cloth.width_m, cloth.height_m, 1e-9});
  const std::vector<double> start = m.at(0);
  Bounds place = Bounds::none();
  for (std::size_t v = 0; v < cloth.vertex_count(); ++v)
    if (const Vec3 p = vertex_at(start, v); std::isfinite(p[0] + p[1] + p[2])) place.add(p);
  if (place.empty()) place.add({0, 0, 0});
  Bounds zone = place, seen = Bounds::none();
  zone.grow(size);
  std::vector<std::size_t> frames;
  for (std::size_t k = 0; k < std::min(kSamples, m.frames()); ++k)
    frames.push_back(k * (m.frames() - 1) / std::max<std::size_t>(1, std::min(kSamples, m.frames()) - 1));
  const std::uint32_t middle = middle_vertex(cloth);
  if (is_free(m.scene))
    for (const std::size_t k : frames)
      for (const double x : minus(vertex_at(m.at(k), middle), vertex_at(start, middle)))
        f.follows = f.follows || std::abs(x) > size;
  for (const std::size_t k : frames) {
    const std::vector<double> x = m.at(k);
    const Vec3 moved = f.follows ? minus(vertex_at(x, middle), vertex_at(start, middle)) : Vec3{};
    for (std::size_t v = 0; v < cloth.vertex_count(); ++v)
      if (const Vec3 p = minus(vertex_at(x, v), moved); zone.holds(p)) seen.add(p);
  }
  if (seen.empty()) seen = place;
  f.near = seen;
  f.near.grow(kDrawnBeside * size);
  f.origin_m = scaled(0.5, plus(seen.low, seen.high));
  if (!m.scene.colliders.empty()) seen.grow(kSeenBeside * size);
  for (unsigned corner = 0; corner < 8; ++corner)
    for (std::size_t k = 0; k < 3; ++k) f.points.push_back((corner >> k & 1u) != 0 ? seen.high[k] : seen.low[k]);
  return f;
}

Taken take(const Motion& m, const Shots& shots, const DeviceOptions& options,
           const std::function<void(const std::string&, std::size_t, std::size_t)>& progress) {
  for (const std::size_t f : shots.frames)
    if (f >= m.frames()) throw Error(fmt::format("frame {}: {} has {} frames", f, m.name, m.frames()));
  Taken taken;
  if (shots.frames.empty()) return taken;
  const bool moves = shots.movie && shots.frames.size() > 1;
  fs::create_directories(shots.out);
  const Framing framing = framing_of(m);
  const auto device = vulkan::Device::get(options);
  SceneRenderer renderer(device, Offscreen::kFormat);
  Offscreen images(device, {static_cast<std::uint32_t>(shots.width), static_cast<std::uint32_t>(shots.height)}, 1);
  renderer.set_cloth(m.scene.cloth, framing.origin_m);
  const std::uint32_t middle = middle_vertex(m.scene.cloth);
  const Camera camera = frame(framing.points, static_cast<double>(shots.width) / shots.height);
  std::unique_ptr<Movie> movie;
  if (moves) try {
      const auto step = static_cast<double>(shots.frames[1] - shots.frames[0]);
      const fs::path file = shots.out / (m.name + ".mp4");
      movie = std::make_unique<Movie>(file, shots.width, shots.height, m.scene.time.frame_rate_hz / step);
      taken.movie = file;
    } catch (const Error& e) {
      taken.no_movie = std::string("no movie: ") + e.what() + " (Debian: ffmpeg)";
    }
  for (std::size_t k = 0; k < shots.frames.size(); ++k) {
    const std::size_t f = shots.frames[k];
    if (progress) progress(m.name, k, shots.frames.size());
    renderer.write_positions(m.at(f));
    if (k == 0 || !m.scene.motion.empty()) renderer.set_surfaces(surfaces(m.scene, static_cast<int>(f), framing.near));
    Camera here = camera;
    if (framing.follows) {
      const Vec3 moved = minus(vertex_at(m.at(f), middle), vertex_at(m.at(0), middle));
      if (std::isfinite(dot(moved, moved))) here.eye_m = plus(camera.eye_m, moved);
    }
    images.draw(renderer, std::span(&here, 1));
    const Picture picture = images.read(0);
    taken.pictures.push_back(shots.out / fmt::format("{}__{:06d}.png", m.name, f));
    write_png(taken.pictures.back(), picture);
    if (movie) movie->add(picture);
  }
  if (movie) movie->finish();
  return taken;
}

std::vector<std::size_t> frames_from(const std::string& text, std::size_t count) {
  const auto fail = [&](const std::string& why) {
    return Error("--frames " + text + ": " + why +
                 "; expected FRAME, FIRST:LAST or FIRST:LAST:STEP, such as 0:71 or -1");
  };
  std::vector<std::string> parts;
  std::istringstream in(text + ":");
  for (std::string part; std::getline(in, part, ':');) parts.push_back(part);
  if (parts.size() > 3 || text.empty()) throw fail("expected one to three numbers");
  const auto number = [&](const std::string& part, long otherwise) {
    if (part.empty()) return otherwise;
    long value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) throw fail("\"" + part + "\": expected a number");
    return value;
  };
  const auto last_there = static_cast<long>(count) - 1;
  const auto within = [&](long f) {
    const long k = f < 0 ? f + last_there + 1 : f;
    if (k < 0 || k > last_there) throw fail(fmt::format("expected frames from 0 to {}", last_there));
    return k;
  };
  const long first = within(number(parts[0], 0));
  const long last = parts.size() == 1 ? first : within(number(parts[1], -1)),
             step = parts.size() == 3 ? number(parts[2], 1) : 1;
  if (step < 1) throw fail("expected a step of at least 1");
  if (last < first) throw fail("expected the last frame at or after the first");
  std::vector<std::size_t> frames;
  for (long f = first; f <= last; f += step) frames.push_back(static_cast<std::size_t>(f));
  return frames;
}

std::string taken_text(const Taken& t) {
  std::string text;
  if (t.pictures.size() == 1)
    text = t.pictures[0].string() + "\n";
  else if (!t.pictures.empty())
    text = fmt::format("{} pictures: {} … {}\n", t.pictures.size(), t.pictures.front().string(),
                       t.pictures.back().filename().string());
  if (!t.movie.empty()) text += t.movie.string() + "\n";
  return text + (t.no_movie.empty() ? "" : t.no_movie + "\n");
}

void write_png(const fs::path& path, const Picture& picture) {
  const fs::path unfinished = path.string() + ".part";
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  const bool written = png_image_write_to_file(&image, unfinished.c_str(), 0, picture.rgb.data(), 0, nullptr) != 0;
  std::error_code error;
  if (written) fs::rename(unfinished, path, error);
  if (written && !error) return;
  const std::string why = written ? error.message() : image.message;
  fs::remove(unfinished, error);
  throw Error(path.string() + ": cannot be written: " + why);
}

}  // namespace clothbench::render
