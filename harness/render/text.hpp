#pragma once
#include <memory>
#include <string>

#include "render/picture.hpp"

namespace clothbench::render {

/// Writes black text in DejaVu Sans (Debian: fonts-dejavu-core).
class Pen {
 public:
  /// Throws Error if the font is missing.
  explicit Pen(int height_px);
  ~Pen();
  Pen(const Pen&) = delete;
  Pen& operator=(const Pen&) = delete;

  int height_px() const { return height_px_; }
  int width_of(const std::string& utf8) const;
  /// Writes `utf8`; (x, baseline) is the left end of the baseline.
  void write(Picture&, int x, int baseline, const std::string& utf8) const;

 private:
  struct Font;
  std::unique_ptr<Font> font_;
  int height_px_;
};

}  // namespace clothbench::render
