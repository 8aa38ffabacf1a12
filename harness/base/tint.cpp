#include "base/tint.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <map>

namespace clothbench {
namespace {

bool on_output = false;

const char* code(Tone tone) {
  switch (tone) {
    case Tone::Good:
      return "32";
    case Tone::Bad:
      return "31";
    case Tone::Doubtful:
      return "33";
    case Tone::Faint:
      return "2";
    case Tone::Heading:
      return "1";
    case Tone::Plain:
      return nullptr;
  }
  return nullptr;
}

}  // namespace

void colour_output(bool on) { on_output = on; }

bool takes_colour(int file_descriptor) {
  const char *refused = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  return isatty(file_descriptor) != 0 && (refused == nullptr || *refused == '\0') &&
         (terminal == nullptr || std::strcmp(terminal, "dumb") != 0);
}

std::string tinted(Tone tone, const std::string& text) {
  const char* sgr = code(tone);
  return on_output && sgr != nullptr && !text.empty() ? std::string("\x1b[") + sgr + "m" + text + "\x1b[0m" : text;
}

Tone tone_of(const std::string& cell) {
  static const std::map<std::string, Tone> kVerdicts = {{"pass", Tone::Good},
                                                        {"ok", Tone::Good},
                                                        {"yes", Tone::Good},
                                                        {"stable", Tone::Good},
                                                        {"faster", Tone::Good},
                                                        {"improved", Tone::Good},
                                                        {"fail", Tone::Bad},
                                                        {"failed", Tone::Bad},
                                                        {"FAILED", Tone::Bad},
                                                        {"NO", Tone::Bad},
                                                        {"crashed", Tone::Bad},
                                                        {"error", Tone::Bad},
                                                        {"not_finite", Tone::Bad},
                                                        {"diverged", Tone::Bad},
                                                        {"device_lost", Tone::Bad},
                                                        {"slower", Tone::Bad},
                                                        {"worse", Tone::Bad},
                                                        {"unsupported", Tone::Doubtful},
                                                        {"refused", Tone::Doubtful},
                                                        {"over_budget", Tone::Doubtful},
                                                        {"timed_out", Tone::Doubtful},
                                                        {"degraded", Tone::Doubtful},
                                                        {"declared", Tone::Doubtful},
                                                        {"changed", Tone::Doubtful},
                                                        {"new", Tone::Doubtful},
                                                        {"noise", Tone::Faint},
                                                        {"ignored", Tone::Faint},
                                                        {"no", Tone::Faint},
                                                        {"–", Tone::Faint}};
  const std::size_t from = cell.find_first_not_of("*");
  const std::string word =
      from == std::string::npos ? "" : cell.substr(from, cell.find_first_of(" *(,:;", from) - from);
  const auto at = kVerdicts.find(word);
  if (at != kVerdicts.end()) return at->second;
  return cell.ends_with("✓") ? Tone::Good : Tone::Plain;
}

}  // namespace clothbench
