#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/json_text.hpp"
#include "base/table.hpp"
#include "base/words.hpp"
#include "check/compare.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// Names of the two sides of a comparison, and the word for a failure.
struct Sides {
  const char *a = "baseline", *b = "found", *worse = "FAILED";
};

/// One row per finding, worst verdict first. Adds their messages to `messages`.
Table findings_table(Table t, const std::vector<CheckedRun>& runs, const Sides& sides, std::string& messages) {
  t.rows = {{"run", "quantity", "verdict", sides.a, sides.b, "allowed"}};
  for (const Verdict verdict : {Verdict::Failed, Verdict::Changed, Verdict::Improved, Verdict::New})
    for (const CheckedRun& run : runs)
      for (const Finding& f : run.findings) {
        if (f.verdict != verdict) continue;
        t.rows.push_back({run.key.file_name(), f.quantity, verdict == Verdict::Failed ? sides.worse : word_for(verdict),
                          f.baseline, f.found, f.allowed});
        if (!f.message.empty() && verdict != Verdict::New)
          messages +=
              wrapped(fmt::format("{}: {}: {}", run.key.file_name(), f.quantity, f.message), 2, console_columns());
      }
  return t;
}

/// Table and messages of `runs`; empty if they have no findings.
std::string findings_text(const std::string& title, const std::vector<CheckedRun>& runs, const Sides& sides = {}) {
  std::string messages;
  const Table t = findings_table({title, "", {}}, runs, sides, messages);
  return t.rows.size() <= 1 ? "" : t.console() + messages + "\n";
}

std::string percent(double ratio) { return std::isfinite(ratio) ? fmt::format("{:+.1f} %", 100 * (ratio - 1)) : "–"; }

/// Times of the runs that were timed on both sides.
Table times_table(const Checked& c) {
  std::vector<std::vector<std::string>> rows = {
      {"run", "A [ms]", "B [ms]", "change", "processes", "95 % interval", "p", "verdict"}};
  for (const CheckedRun& r : c.runs) {
    const TimeRatio& t = r.time;
    if (!std::isfinite(t.ratio)) continue;
    rows.push_back({r.key.file_name(), significant(1e3 * r.time_a_s, 4), significant(1e3 * r.time_b_s, 4),
                    percent(t.ratio), fmt::format("{} and {}", t.processes_a, t.processes_b),
                    t.enough() ? percent(t.low) + " … " + percent(t.high) : "–", significant(t.p, 2),
                    r.time_verdict()});
  }
  const std::size_t timed = rows.size() - 1;
  return {"Time per frame, A against B",
          fmt::format("Median over the processes; runs that shared the machine with other clothbench processes are "
                      "omitted. Change: ratio of the geometric means. p: exact permutation test over the processes. "
                      "*noise*: the interval contains 0 %. If none of the {} runs differed, about {:.0f} would be "
                      "called faster or slower by chance.",
                      timed, 0.05 * static_cast<double>(timed)),
          rows};
}

json key_json(const RunKey& key) { return {{"scene", key.scene}, {"solver", key.solver}, {"setting", key.setting}}; }

json time_json(const CheckedRun& run) {
  return {{"verdict", run.time_verdict()},           {"processes", {run.time.processes_a, run.time.processes_b}},
          {"ratio", finite_or_null(run.time.ratio)}, {"low", finite_or_null(run.time.low)},
          {"high", finite_or_null(run.time.high)},   {"p", finite_or_null(run.time.p)}};
}

json run_json(const CheckedRun& run) {
  json j = key_json(run.key);
  j["verdict"] = word_for(run.verdict());
  j["findings"] = json::array();
  for (const Finding& f : run.findings)
    j["findings"].push_back({{"verdict", word_for(f.verdict)},
                             {"quantity", f.quantity},
                             {"baseline", f.baseline},
                             {"found", f.found},
                             {"allowed", f.allowed},
                             {"message", f.message}});
  return j;
}

std::string runs_word(std::size_t n) { return fmt::format("{} run{}", n, n == 1 ? "" : "s"); }

/// Valid UTF-8 for any bytes in a solver's message.
std::string valid_utf8(const std::string& text) {
  return json_from(dump(json(text), -1, false, json::error_handler_t::replace)).get<std::string>();
}

/// Escapes element text and attributes alike. Line breaks become references, because attributes would lose them; other
/// control characters, U+FFFE and U+FFFF are not allowed in XML 1.0.
std::string xml_escaped(const std::string& text) {
  static const std::map<char, const char*> kReferences = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\n', "&#10;"}, {'\r', "&#13;"}, {'\t', "&#9;"}};
  std::string out;
  for (const char c : valid_utf8(text)) {
    const auto reference = kReferences.find(c);
    if (reference != kReferences.end())
      out += reference->second;
    else
      out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  }
  for (const char* no_character : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"})
    for (std::size_t at = 0; (at = out.find(no_character, at)) != std::string::npos;) out.replace(at, 3, "?");
  return out;
}

std::string test_case(const CheckedRun& run) {
  std::string name = run.key.solver;
  if (!run.key.setting.empty()) name += " " + run.key.setting;
  std::string out =
      fmt::format("    <testcase classname=\"{}\" name=\"{}\"", xml_escaped(run.key.scene), xml_escaped(name));
  if (run.verdict() == Verdict::Same) return out + "/>\n";
  out += ">\n";
  if (const std::string text = run.sentences([](Verdict v) { return v == Verdict::Failed; }); !text.empty()) {
    const std::string first = text.substr(0, text.find('\n'));
    out += fmt::format("      <failure type=\"regression\" message=\"{}\">{}</failure>\n", xml_escaped(first),
                       xml_escaped(text));
  }
  if (const std::string text = run.sentences([](Verdict v) { return v != Verdict::Failed; }); !text.empty())
    out += fmt::format("      <system-out>{}</system-out>\n", xml_escaped(text));
  return out + "    </testcase>\n";
}

}  // namespace

std::string check_text(const Checked& checked, const std::string& file) {
  std::string out = checked.differing.marks();
  out += findings_text("Different from " + file, checked.runs);
  out +=
      fmt::format("check {}: {}: {} failed, {} improved, {} new, {} as in {}", checked.passed() ? "passed" : "FAILED",
                  runs_word(checked.runs.size()), checked.count(Verdict::Failed), checked.count(Verdict::Improved),
                  checked.count(Verdict::New), checked.count(Verdict::Same), file);
  if (checked.passed() && checked.count(Verdict::Improved) > 0) out += "; --update accepts the improved ones";
  return out + "\n";
}

json check_json(const Checked& checked, const std::string& file) {
  json j = {{"baseline", file},
            {"passed", checked.passed()},
            {"overridden", checked.differing.json()},
            {"failed", checked.count(Verdict::Failed)},
            {"improved", checked.count(Verdict::Improved)},
            {"new", checked.count(Verdict::New)},
            {"same", checked.count(Verdict::Same)},
            {"runs", json::array()}};
  for (const CheckedRun& run : checked.runs) j["runs"].push_back(run_json(run));
  return j;
}

std::string update_text(const Updated& u, const std::string& file) {
  std::string out = findings_text("Changed in " + file, u.changes, {.worse = "changed"});
  for (const RunKey& key : u.removed) out += "  removed, no result: " + key.file_name() + "\n";
  return out + fmt::format("{}: {}: {} changed or new, {} removed, {} with different values within tolerance\n", file,
                           runs_word(u.baseline.runs.size()), u.changes.size(), u.removed.size(), u.within_slack);
}

json update_json(const Updated& u, const std::string& file) {
  json j = {{"baseline", file},
            {"runs", u.baseline.runs.size()},
            {"within_slack", u.within_slack},
            {"changes", json::array()},
            {"removed", json::array()}};
  for (const CheckedRun& run : u.changes) j["changes"].push_back(run_json(run));
  for (const RunKey& key : u.removed) j["removed"].push_back(key_json(key));
  return j;
}

std::string comparison_text(const Checked& c) {
  std::string out = c.differing.marks(), messages;
  const Table results{"Results that differ",
                      fmt::format("{} runs have the same outcome and the same results. Values that depend on the "
                                  "machine are not compared here.",
                                  c.count(Verdict::Same)),
                      {}};
  for (const Table& t : {times_table(c), findings_table(results, c.runs, {"A", "B"}, messages)})
    out += t.rows.size() > 1 ? t.console() : fmt::format("\n{}: none\n  {}\n", t.title, t.note);
  return out + messages;
}

json comparison_json(const Checked& c) {
  json out = {{"overridden", c.differing.json()}, {"runs", json::array()}};
  for (const CheckedRun& run : c.runs) {
    out["runs"].push_back(run_json(run));
    out["runs"].back()["time"] = time_json(run);
  }
  return out;
}

std::string junit_xml(const Checked& checked) {
  const std::string counts = fmt::format("tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"0\"", checked.runs.size(),
                                         checked.count(Verdict::Failed));
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out += fmt::format("<testsuites name=\"clothbench check\" {}>\n  <testsuite name=\"clothbench check\" {}>\n", counts,
                     counts);
  for (const CheckedRun& run : checked.runs) out += test_case(run);
  if (!checked.differing.empty())
    out += fmt::format("    <system-out>{}</system-out>\n", xml_escaped(checked.differing.marks()));
  return out + "  </testsuite>\n</testsuites>\n";
}

std::string github_annotations(const Checked& checked) {
  std::string out;
  for (const CheckedRun& run : checked.runs)
    for (const Finding& f : run.findings) {
      if (f.verdict != Verdict::Failed) continue;
      out += "::error::";
      for (const char c : valid_utf8(run.key.file_name() + ": " + f.sentence()))
        out += c == '%' ? "%25" : c == '\n' || c == '\r' ? "%0A" : std::string(1, c);
      out += "\n";
    }
  return out;
}

std::string log_line(const std::vector<RunRecord>& runs, const std::string& command) {
  // Besides values with a regression rule: what a frame costs. Times of software devices or side by side mean nothing.
  constexpr const char *kCosts[] = {"read_B_per_frame", "write_B_per_frame", "device_memory_B"},
                       *kTime = "frame_device_median_s";
  json out = {{"commit", ""},
              {"created", ""},
              {"dirty", false},
              {"command", regex_replaced(command, " (--out|--device)[ =]\\S+| --resume", "")},
              {"runs", json::array()}};
  for (const RunRecord& r : runs) {
    const BaselineRun part = gated_part(r);
    // A missing run has no environment.
    const json e = r.header.environment.is_object() ? r.header.environment : json::object();
    if (out["commit"] == "")
      out.update({{"commit", e.value("git_commit", "")},
                  {"created", e.value("created", "")},
                  {"dirty", e.value("git_dirty", false)}});
    json run = key_json(part.key), values = json::object();
    for (const auto& [name, value] : part.scalars)
      if (!is_verdict(name)) values[name] = value;
    const auto add = [&](const char* name) {
      const auto at = r.summary.find(name);
      if (at != r.summary.end() && std::isfinite(at->second)) values[name] = at->second;
    };
    for (const char* name : kCosts) add(name);
    if (!e.value("gpu_is_software", true) && r.withheld.empty()) add(kTime);
    run.update({{"gpu", e.value("gpu", "")}, {"status", part.status}, {"values", values}});
    out["runs"].push_back(std::move(run));
  }
  return dump(out) + "\n";
}

}  // namespace clothbench
