#pragma once
#include <string>

namespace clothbench {

/// Colour for people: off until switched on, so that what goes to pipes and files is plain.
void colour_output(bool on);

/// Whether a file descriptor is a terminal that takes colour; NO_COLOR (no-color.org) and TERM=dumb say no.
bool takes_colour(int file_descriptor);

enum class Tone { Plain, Good, Bad, Doubtful, Faint, Heading };

/// In that tone if colour is on.
std::string tinted(Tone, const std::string& text);

/// By the verdict that a table's cell begins with (pass, fail, unsupported, noise, …) or the tick at its end; Plain
/// for any other.
Tone tone_of(const std::string& cell);

}  // namespace clothbench
