#include "render/legend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"

namespace clothbench::render {
namespace {

constexpr int kSmallestText_px = 9, kLeastScene_px = 32;

std::string number(double x) {
  std::string text = fmt::format("{:.3g}", x);
  // A minus, not a hyphen.
  if (!text.empty() && text[0] == '-') text = "−" + text.substr(1);
  return text;
}

void fill(Picture& p, int x, int y, int width, int height, const Rgb& c) {
  for (int row = std::max(0, y); row < std::min(p.height, y + height); ++row)
    for (int column = std::max(0, x); column < std::min(p.width, x + width); ++column)
      for (std::size_t k = 0; k < 3; ++k)
        p.at(column, row)[k] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(c[k], 0.0, 1.0)));
}

}  // namespace

Layout layout_of(int width, int height, bool plain, bool legend) {
  Layout l{width, height, 0, 0, std::max(kSmallestText_px, height / 32)};
  if (!plain) {
    l.caption_height = 2 * l.text_px;
    l.legend_width = legend ? 6 * l.text_px : 0;
    l.width -= l.legend_width;
    l.height -= l.caption_height;
  }
  if (l.width < kLeastScene_px || l.height < kLeastScene_px)
    throw Error(fmt::format("--size {}x{}: too small for the scene{}", width, height,
                            plain ? "" : " beside text (--plain draws none)"));
  return l;
}

void draw_legend(Picture& p, const Layout& l, const Scale& s, const Pen& pen) {
  const int unit = l.text_px, left = l.width + unit / 2, bar_width = unit, top = 4 * unit;
  const int bar_height = std::max(1, l.height - top - unit);
  pen.write(p, left, static_cast<int>(1.4 * unit), s.title);
  pen.write(p, left, static_cast<int>(2.6 * unit), "[" + s.unit + "]");
  fill(p, left - 1, top - 1, bar_width + 2, bar_height + 2, {0.3, 0.3, 0.3});
  for (int row = 0; row < bar_height; ++row) {
    const double t = bar_height > 1 ? 1 - static_cast<double>(row) / (bar_height - 1) : 0;
    fill(p, left, top + row, bar_width, 1, s.colour(s.low + t * (s.high - s.low)));
  }
  const int marks = bar_height > 12 * unit ? 4 : 2;
  for (int k = 0; k <= marks; ++k) {
    const double t = static_cast<double>(k) / marks, value = s.low + t * (s.high - s.low);
    const int y = top + static_cast<int>(std::lround((1 - t) * (bar_height - 1)));
    fill(p, left + bar_width, y, unit / 3, std::max(1, unit / 12), {0.3, 0.3, 0.3});
    const std::string beyond = k == marks && s.clipped_high ? "≥ " : k == 0 && s.clipped_low ? "≤ " : "";
    pen.write(p, left + bar_width + unit / 2, y + unit / 3, beyond + number(value / s.per_unit));
  }
}

void draw_caption(Picture& p, const Layout& l, const std::string& text, const Pen& pen) {
  pen.write(p, l.text_px / 2, p.height - static_cast<int>(0.65 * l.text_px), text);
}

}  // namespace clothbench::render
