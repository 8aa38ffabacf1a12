#pragma once
#include <string>

namespace clothbench {

/// Switches coloured output on or off. It is off by default, so that pipes and files get plain text.
void colour_output(bool on);

/// Whether a file descriptor is a terminal that shows colour; false with NO_COLOR (no-color.org) or TERM=dumb.
bool takes_colour(int file_descriptor);

enum class Tone { Plain, Good, Bad, Doubtful, Faint, Heading };

/// `text` in that tone if colour is on, else unchanged.
std::string tinted(Tone, const std::string& text);

/// Tone of a table's cell, from the verdict it begins with (pass, fail, unsupported, noise, …) or a tick at its end;
/// Plain for any other cell.
Tone tone_of(const std::string& cell);

}  // namespace clothbench
