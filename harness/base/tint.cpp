#include "base/tint.hpp"

#include <fmt/color.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <vector>

#include "base/words.hpp"

namespace clothbench {
namespace {

bool on_output = false;

fmt::text_style style_of(Tone tone) {
  switch (tone) {
    case Tone::Good:
      return fg(fmt::terminal_color::green);
    case Tone::Bad:
      return fg(fmt::terminal_color::red);
    case Tone::Doubtful:
      return fg(fmt::terminal_color::yellow);
    case Tone::Faint:
      return fmt::emphasis::faint;
    case Tone::Heading:
      return fmt::emphasis::bold;
    case Tone::Plain:
      break;
  }
  return {};
}

}  // namespace

void colour_output(bool on) { on_output = on; }

bool takes_colour(int file_descriptor) {
  const char *refused = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  return isatty(file_descriptor) != 0 && (refused == nullptr || *refused == '\0') &&
         (terminal == nullptr || std::strcmp(terminal, "dumb") != 0);
}

std::string tinted(Tone tone, const std::string& text) {
  return on_output && tone != Tone::Plain && !text.empty() ? format(style_of(tone), "{}", text) : text;
}

Tone tone_of(const std::string& cell) {
  static const std::pair<Tone, std::vector<std::string>> kVerdicts[] = {
      {Tone::Good, {"pass", "ok", "yes", "stable", "faster", "improved"}},
      {Tone::Bad,
       {"fail", "failed", "FAILED", "NO", "crashed", "error", "not_finite", "diverged", "device_lost", "slower",
        "worse"}},
      {Tone::Doubtful,
       {"unsupported", "refused", "over_budget", "timed_out", "degraded", "declared", "changed", "new"}},
      {Tone::Faint, {"noise", "ignored", "no", "–"}}};
  const std::size_t from = cell.find_first_not_of("*");
  const std::string word =
      from == std::string::npos ? "" : cell.substr(from, cell.find_first_of(" *(,:;", from) - from);
  for (const auto& [tone, words] : kVerdicts)
    if (contains(words, word)) return tone;
  return cell.ends_with("✓") ? Tone::Good : Tone::Plain;
}

}  // namespace clothbench
