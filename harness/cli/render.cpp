#include <tuple>

#include "cli/command.hpp"
#include "render/pictures.hpp"
#include "runner/interrupt.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

struct RenderArguments {
  std::vector<std::string> files;
  std::string out, frames, size;
  bool no_movie = false;
  DeviceFlags device;
};

void render_all(const RenderArguments& a, const Console& console) {
  render::Shots shots;
  std::tie(shots.width, shots.height) = pixels_of("--size", a.size);
  shots.movie = !a.no_movie;
  shots.out = a.out;
  nlohmann::json reported = {{"pictures", nlohmann::json::array()}, {"movies", nlohmann::json::array()}};
  for (const std::string& file : a.files) {
    const render::Motion m = render::stored_motion(file);
    shots.frames = render::frames_from(a.frames, m.frames());
    render::Taken taken;
    {
      StatusLine line(!console.json);
      taken = render::take(m, shots, a.device.options, [&](const std::string& what, std::size_t done, std::size_t of) {
        if (interrupt_requested())
          throw Error("interrupted; the images rendered so far are kept", ExitCode::Interrupted);
        line.show(what, done, of);
      });
    }
    for (const fs::path& p : taken.pictures) reported["pictures"].push_back(p.string());
    if (!taken.movie.empty()) reported["movies"].push_back(taken.movie.string());
    if (!taken.no_movie.empty()) reported["no_movie"] = taken.no_movie;
    if (!console.json) fmt::print("{}", render::taken_text(taken));
  }
  if (console.json) Console::print(reported);
}

}  // namespace

void add_render(CLI::App& app, Console& console) {
  RenderArguments& a = console.arguments<RenderArguments>();
  a.out = "pictures";
  a.frames = ":";
  a.size = "1200x900";
  CLI::App* cmd =
      app.add_subcommand("render", "Draw images (PNG) and a movie (MP4, if ffmpeg is present) of stored motions");
  cmd->add_option("file", a.files, "Result files (.h5)")->required();
  cmd->add_option("-o,--out", a.out, "Folder to write to")->capture_default_str();
  cmd->add_option("--frames", a.frames,
                  "FRAME, FIRST:LAST or FIRST:LAST:STEP, both included; -1 is the last. Default: all");
  cmd->add_option("--size", a.size, "Size of an image: WIDTHxHEIGHT in pixels")->capture_default_str();
  cmd->add_flag("--no-movie", a.no_movie, "Images only, no movie");
  a.device.add_to(*cmd);
  cmd->footer("Example: clothbench render results/runs/mine/desk-flat-low__xpbd__default.h5 --frames -1");
  cmd->callback([&console, &a] { render_all(a, console); });
}

}  // namespace clothbench
