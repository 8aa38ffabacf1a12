#include "check/junit.hpp"

#include <fmt/format.h>

namespace clothbench {
namespace {

/// Valid UTF-8, whatever a solver put into its message.
std::string valid_utf8(const std::string& text) {
  using nlohmann::json;
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

/// For element text and attributes alike. Line breaks are written as references, or attributes would lose them.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : valid_utf8(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        continue;
      case '<':
        out += "&lt;";
        continue;
      case '>':
        out += "&gt;";
        continue;
      case '"':
        out += "&quot;";
        continue;
      case '\n':
        out += "&#10;";
        continue;
      case '\r':
        out += "&#13;";
        continue;
      case '\t':
        out += "&#9;";
        continue;
      default:
        break;
    }
    out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;  // the other control characters exist in no XML 1.0 text
  }
  for (const char* no_character : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"})  // U+FFFE and U+FFFF neither
    for (std::size_t at = 0; (at = out.find(no_character, at)) != std::string::npos;) out.replace(at, 3, "?");
  return out;
}

std::string test_case(const CheckedRun& run) {
  std::string name = run.key.solver;
  if (!run.key.setting.empty()) name += " " + run.key.setting;
  if (!run.key.assets.empty()) name += " [" + run.key.assets + "]";
  std::string out = fmt::format("    <testcase classname=\"{}\" name=\"{}\"", escaped(run.key.scene), escaped(name));
  if (run.verdict() == Verdict::Same) return out + "/>\n";
  out += ">\n";
  if (const std::string text = run.sentences([](Verdict v) { return v == Verdict::Failed; }); !text.empty()) {
    const std::string first = text.substr(0, text.find('\n'));
    out +=
        fmt::format("      <failure type=\"regression\" message=\"{}\">{}</failure>\n", escaped(first), escaped(text));
  }
  if (const std::string text = run.sentences([](Verdict v) { return v != Verdict::Failed; }); !text.empty())
    out += fmt::format("      <system-out>{}</system-out>\n", escaped(text));
  return out + "    </testcase>\n";
}

}  // namespace

std::string junit_xml(const Checked& checked) {
  const std::string counts = fmt::format("tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"0\"", checked.runs.size(),
                                         checked.count(Verdict::Failed));
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out += fmt::format("<testsuites name=\"clothbench check\" {}>\n  <testsuite name=\"clothbench check\" {}>\n", counts,
                     counts);
  for (const CheckedRun& run : checked.runs) out += test_case(run);
  if (!checked.differing.empty())
    out += fmt::format("    <system-out>{}</system-out>\n", escaped(checked.differing.marks()));
  return out + "  </testsuite>\n</testsuites>\n";
}

}  // namespace clothbench
