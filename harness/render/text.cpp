#include "render/text.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <cstdlib>

#include "clothbench/error.hpp"

namespace clothbench::render {
namespace {

/// Code points of UTF-8; a byte that does not belong where it is counts as '?'.
std::u32string code_points(const std::string& utf8) {
  std::u32string out;
  for (std::size_t k = 0; k < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[k++]);
    const int more = lead < 0x80 ? 0 : lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc0 ? 1 : -1;
    char32_t c = more <= 0 ? lead : lead & (0x3fu >> more);
    bool whole = more >= 0;
    for (int i = 0; whole && i < more; ++i) {
      whole = k < utf8.size() && (static_cast<unsigned char>(utf8[k]) & 0xc0) == 0x80;
      if (whole) c = c << 6 | (static_cast<unsigned char>(utf8[k++]) & 0x3fu);
    }
    out.push_back(whole ? c : U'?');
  }
  return out;
}

/// $CLOTHBENCH_FONT, else where this system had the font when the program was built.
std::string font_file() {
  const char* named = std::getenv("CLOTHBENCH_FONT");
  return named != nullptr && *named != '\0' ? named : CLOTHBENCH_FONT;
}

}  // namespace

struct Pen::Font {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  ~Font() {
    if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }
};

Pen::Pen(int height_px) : font_(std::make_unique<Font>()), height_px_(height_px) {
  if (FT_Init_FreeType(&font_->library) != 0) throw Error("FreeType cannot be used");
  const std::string file = font_file();
  if (FT_New_Face(font_->library, file.c_str(), 0, &font_->face) != 0)
    throw Error(
        file +
        ": no such font (Debian: fonts-dejavu-core; $CLOTHBENCH_FONT names another file); --plain draws without text");
  FT_Set_Pixel_Sizes(font_->face, 0, static_cast<FT_UInt>(height_px));
}

Pen::~Pen() = default;

int Pen::width_of(const std::string& utf8) const {
  long width = 0;
  for (const char32_t c : code_points(utf8))
    if (FT_Load_Char(font_->face, c, FT_LOAD_DEFAULT) == 0) width += font_->face->glyph->advance.x;
  return static_cast<int>(width / 64);
}

void Pen::write(Picture& picture, int x, int baseline, const std::string& utf8) const {
  for (const char32_t c : code_points(utf8)) {
    if (FT_Load_Char(font_->face, c, FT_LOAD_RENDER) != 0) continue;
    const FT_GlyphSlot glyph = font_->face->glyph;
    for (int row = 0; row < static_cast<int>(glyph->bitmap.rows); ++row)
      for (int column = 0; column < static_cast<int>(glyph->bitmap.width); ++column) {
        const int px = x + glyph->bitmap_left + column, py = baseline - glyph->bitmap_top + row;
        if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
        const int ink = glyph->bitmap.buffer[row * glyph->bitmap.pitch + column];
        for (int k = 0; k < 3; ++k) {
          std::uint8_t& to = picture.at(px, py)[k];
          to = static_cast<std::uint8_t>(to * (255 - ink) / 255);
        }
      }
    x += static_cast<int>(glyph->advance.x / 64);
  }
}

}  // namespace clothbench::render
