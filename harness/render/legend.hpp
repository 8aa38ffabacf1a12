#pragma once
#include <string>

#include "render/colours.hpp"
#include "render/picture.hpp"
#include "render/text.hpp"

namespace clothbench::render {

/// Layout of scene, colour bar and caption in a picture: the scene gets the space that the others leave.
struct Layout {
  int width = 0, height = 0;  ///< of the scene
  int legend_width = 0, caption_height = 0;
  int text_px = 0;  ///< height of letters
};

/// Letters are a 32nd of the picture's height, and at least 9 pixels: readable in a figure half a page wide. Throws
/// Error if no space is left for the scene.
Layout layout_of(int width, int height, bool plain, bool legend);

/// Draws a colour bar with three or five numbers to the right of the scene.
void draw_legend(Picture&, const Layout&, const Scale&, const Pen&);
/// Draws the caption below the scene.
void draw_caption(Picture&, const Layout&, const std::string& text, const Pen&);

}  // namespace clothbench::render
