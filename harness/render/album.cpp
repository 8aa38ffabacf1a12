#include "render/album.hpp"

#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <optional>

#include "clothbench/error.hpp"
#include "render/legend.hpp"
#include "render/movie.hpp"
#include "render/offscreen.hpp"
#include "render/vertex_values.hpp"

namespace clothbench::render {
namespace {

using Progress = std::function<void(const std::string&, std::size_t, std::size_t)>;

/// Numbers to colour the cloth by, of all frames one after another; none for checkers.
std::vector<float> values_of(const Motion& m, const Shots& shots) {
  std::vector<float> out;
  const auto add = [&](const std::vector<float>& v) { out.insert(out.end(), v.begin(), v.end()); };
  if (shots.colour == Colour::Strain)
    for (const std::size_t f : shots.frames) add(vertex_strain(m.scene.cloth, m.at(f)));
  if (shots.colour != Colour::Depth) return out;
  VertexDepth depth(m.scene);
  auto wanted = shots.frames.begin();
  for (std::size_t f = 0; wanted != shots.frames.end(); ++f) {
    const bool want = f == *wanted;
    add(depth.at(static_cast<int>(f), m.at(f), want));
    if (want) ++wanted;
  }
  return out;
}

constexpr double kMargin = 0.04;

/// Nothing of the cloth is in the picture.
bool has_left(const Camera& camera, std::span<const double> x) {
  for (std::size_t v = 0; v + 2 < x.size(); v += 3)
    if (const auto at = seen_at(camera, {x[v], x[v + 1], x[v + 2]}))
      if ((*at)[0] >= 0 && (*at)[0] <= 1 && (*at)[1] >= 0 && (*at)[1] <= 1) return false;
  return true;
}

std::string caption(const Motion& m, std::size_t frame, bool followed, bool left) {
  std::string text = fmt::format("{} · {:.3f} s", m.title, m.time_s[frame]);
  if (followed) text += " · camera falls with it";
  if (left) text += " · the cloth has left the picture";
  if (!m.outcome.empty() && frame + 1 == m.frames()) text += " · " + m.outcome;
  return text;
}

/// One motion being shown.
class Shoot {
 public:
  Shoot(const Motion& motion, const Shots& shots, const DeviceOptions& options)
      : m_(motion),
        shots_(shots),
        layout_(layout_of(shots.width, shots.height, shots.plain, shots.colour != Colour::Checker)),
        framing_(framing_of(motion, framed_by(motion, shots.frames))),
        values_(values_of(motion, shots)),
        scale_(scale_for(shots.colour, values_)),
        colours_(table_of(scale_)),
        device_(vulkan::Device::get(options)),
        renderer_(device_, Offscreen::kFormat),
        images_(device_, {static_cast<std::uint32_t>(layout_.width), static_cast<std::uint32_t>(layout_.height)}, 1) {
    if (!shots.plain) pen_.emplace(layout_.text_px);
    renderer_.set_cloth(m_.scene.cloth, framing_.origin_m);
    if (framing_.followed) {
      const std::vector<double> start = m_.at(0);
      const std::size_t v = 3 * *framing_.followed;
      renderer_.follow(*framing_.followed, {start[v], start[v + 1], start[v + 2]});
    }
  }

  void take(View view, Taken& taken, const Progress& progress) {
    const Camera camera =
        frame(view, framing_.points, static_cast<double>(layout_.width) / layout_.height, kMargin, framing_.turn_deg);
    const std::string stem = fmt::format("{}__{}__{}", m_.name, name_of(view), name_of(shots_.colour));
    std::unique_ptr<Movie> movie;
    if (shots_.movie && shots_.frames.size() > 1) {
      const std::size_t step = shots_.frames[1] - shots_.frames[0];
      taken.movies.push_back(shots_.out / (stem + ".mp4"));
      movie = std::make_unique<Movie>(taken.movies.back(), shots_.width, shots_.height,
                                      m_.scene.time.frame_rate_hz / static_cast<double>(step));
    }
    for (std::size_t k = 0; k < shots_.frames.size(); ++k) {
      if (progress) progress(stem, k, shots_.frames.size());
      const Picture picture = draw(k, camera);
      taken.pictures.push_back(shots_.out / fmt::format("{}__{:06d}.png", stem, shots_.frames[k]));
      write_png(taken.pictures.back(), picture);
      if (movie) movie->add(picture);
    }
    if (movie) movie->finish();
  }

 private:
  Picture draw(std::size_t k, const Camera& camera) {
    const std::size_t f = shots_.frames[k], count = m_.scene.cloth.vertex_count();
    const std::vector<double> x = m_.at(f);
    renderer_.write_positions(x);
    if (!values_.empty())
      renderer_.write_values(positions_on(scale_, std::span(values_).subspan(k * count, count)), colours_);
    if (!surfaces_set_ || !m_.scene.motion.empty())
      renderer_.set_surfaces(surfaces(m_.scene, static_cast<int>(f), framing_.near));
    surfaces_set_ = true;
    images_.draw(renderer_, std::span(&camera, 1));
    Picture out(shots_.width, shots_.height, 255);
    out.put(images_.read(0), 0, 0);
    if (!pen_) return out;
    if (!values_.empty()) draw_legend(out, layout_, scale_, *pen_);
    draw_caption(out, layout_, caption(m_, f, framing_.followed.has_value(), !framing_.followed && has_left(camera, x)),
                 *pen_);
    return out;
  }

  const Motion& m_;
  const Shots& shots_;
  Layout layout_;
  Framing framing_;
  std::vector<float> values_;
  Scale scale_;
  std::vector<vec4> colours_;
  std::shared_ptr<vulkan::Device> device_;
  SceneRenderer renderer_;
  Offscreen images_;
  std::optional<Pen> pen_;
  bool surfaces_set_ = false;
};

}  // namespace

Taken take(const Motion& motion, const Shots& shots, const DeviceOptions& options, const Progress& progress) {
  for (const std::size_t f : shots.frames)
    if (f >= motion.frames()) throw Error(fmt::format("frame {}: {} has {}", f, motion.name, motion.frames()));
  Taken taken;
  if (shots.frames.empty()) return taken;
  Shots wanted = shots;
  if (shots.movie && shots.frames.size() > 1 && !Movie::possible()) {
    wanted.movie = false;
    taken.no_movie = "no movie: ffmpeg is not on the PATH (Debian: ffmpeg)";
  }
  std::filesystem::create_directories(shots.out);
  Shoot shoot(motion, wanted, options);
  for (const View v : wanted.views) shoot.take(v, taken, progress);
  return taken;
}

std::vector<std::size_t> frames_from(const std::string& text, std::size_t count) {
  const auto fail = [&](const std::string& why) {
    return Error("--frames " + text + ": " + why +
                 "; expected FRAME, FIRST:LAST or FIRST:LAST:STEP, such as 0:71 or -1");
  };
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == ':')
      parts.emplace_back();
    else
      parts.back() += c;
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
  for (const std::filesystem::path& m : t.movies) text += m.string() + "\n";
  return text + (t.no_movie.empty() ? "" : t.no_movie + "\n");
}

}  // namespace clothbench::render
