// The manual page, made from the commands and options that there are.
#include <sstream>

#include "cli/command.hpp"
#include "cli/texts.hpp"
#include "runner/build_info.hpp"

namespace clothbench {
namespace {

/// Text as roff takes it: its own marks are escaped, and all is in ASCII, which every output of man(1) has.
std::string roff(std::string text) {
  const std::string dots = "…";
  for (std::size_t at; (at = text.find(dots)) != std::string::npos;) text.replace(at, dots.size(), "...");
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string without_emphasis(std::string text) {
  std::erase_if(text, [](char c) { return c == '`' || c == '*'; });
  return text;
}

std::string entry(const std::string& name, const std::string& text) {
  return fmt::format(".TP\n\\fB{}\\fP\n{}\n", roff(name), roff(text));
}

/// As it stands, line by line.
std::string verbatim(const std::string& text) {
  return text.empty() ? "" : fmt::format(".PP\n.nf\n{}\n.fi\n", roff(text));
}

std::string options_of(const CLI::App& app) {
  const CLI::Formatter words;
  std::string out;
  for (const bool positional : {true, false})
    for (const CLI::Option* o : app.get_options())
      if (o->get_positional() == positional && (positional || o->nonpositional()) && !o->get_group().empty())
        out += entry(words.make_option_name(o, positional) + words.make_option_opts(o), o->get_description());
  return out;
}

std::string manual_page(const CLI::App& app) {
  std::string out = fmt::format(
      ".\\\" Made by clothbench manual.\n.TH CLOTHBENCH 1 \"\" \"clothbench {}\" \"User Commands\"\n.SH "
      "NAME\nclothbench \\- benchmark of real-time cloth "
      "solvers\n.SH SYNOPSIS\n.B clothbench\n.I command\n.RI [ options ]\n.SH DESCRIPTION\n",
      build_info::kVersion);
  out +=
      "Runs interchangeable cloth solvers on the same scenes and stores error, run time, stability, "
      "penetration, frames per second and bandwidth in one HDF5 file per run. All options of a command are "
      "listed by\n.BR \"clothbench \" \\fIcommand\\fP \" \\-\\-help\" .\n";
  out += ".SH OPTIONS\nOptions of every command:\n" + options_of(app) + ".SH COMMANDS\n";
  for (const CLI::App* c : app.get_subcommands({})) {
    if (c->get_group().empty()) continue;
    out += fmt::format(".SS {}\n{}\n", roff(c->get_name()), roff(c->get_description()));
    out += options_of(*c) + verbatim(c->get_footer());
  }
  out += ".SH GLOSSARY\n";
  for (const auto& [term, meaning] : glossary()) out += entry(term, meaning);
  return out + texts::kManual + ".SH EXAMPLES\n" + verbatim(app.get_footer());
}

}  // namespace

std::vector<std::pair<std::string, std::string>> glossary() {
  std::vector<std::pair<std::string, std::string>> out;
  std::istringstream lines(texts::kGlossary);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t middle = line.find(" | ");
    if (!line.starts_with("| ") || middle == std::string::npos || line.starts_with("| term |")) continue;
    out.emplace_back(without_emphasis(line.substr(2, middle - 2)),
                     without_emphasis(line.substr(middle + 3, line.rfind(" |") - middle - 3)));
  }
  return out;
}

void add_manual(CLI::App& app, Console& console) {
  CLI::App* cmd = app.add_subcommand("manual", "Print the manual page for man(1)");
  cmd->group("");  // for packages
  cmd->callback([&app, &console] {
    const std::string page = manual_page(app);
    console.print([&] { return nlohmann::json{{"page", page}}; }, [&] { return page; });
  });
}

}  // namespace clothbench
