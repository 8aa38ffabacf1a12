#include "check/github.hpp"

#include <fmt/format.h>

namespace clothbench {
namespace {

/// As @actions/core escapes them: %, CR and LF in the message; also : and , in a property.
std::string escaped(const std::string& text, bool property) {
  std::string out;
  for (const char c : text) {
    if (c == '%')
      out += "%25";
    else if (c == '\r')
      out += "%0D";
    else if (c == '\n')
      out += "%0A";
    else if (property && c == ':')
      out += "%3A";
    else if (property && c == ',')
      out += "%2C";
    else
      out += c;
  }
  return out;
}

std::string command(const char* kind, const std::string& file, const std::string& title, const std::string& message) {
  return fmt::format("::{} file={},title={}::{}\n", kind, escaped(file, true), escaped(title, true),
                     escaped(message, false));
}

auto is(Verdict verdict) {
  return [verdict](Verdict of_finding) { return of_finding == verdict; };
}

}  // namespace

std::string github_commands(const Checked& checked, const std::string& file) {
  std::string out, improved, fresh;
  for (const CheckedRun& run : checked.runs) {
    if (run.verdict() == Verdict::Failed)
      out += command("error", file, run.key.text(), run.sentences(is(Verdict::Failed)));
    const auto append = [&](std::string& to, Verdict verdict) {
      if (const std::string text = run.sentences(is(verdict)); !text.empty())
        to += (to.empty() ? "" : "\n") + run.key.text() + ": " + text;
    };
    append(improved, Verdict::Improved);
    append(fresh, Verdict::New);
  }
  if (!improved.empty()) out += command("notice", file, "better than the baseline; --update accepts it", improved);
  if (!checked.differing.empty())
    out += command("warning", file, "other conditions than the baseline's", checked.differing.marks());
  if (!fresh.empty()) out += command("notice", file, "not in the baseline", fresh);
  return out;
}

}  // namespace clothbench
