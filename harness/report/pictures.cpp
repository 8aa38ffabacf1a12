#include "report/pictures.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "base/data_folder.hpp"
#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A word that the shell takes as it stands.
std::string quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// A Python with matplotlib; empty if there is none.
std::string find_python() {
  for (const char* python : {"/usr/bin/python3", "python3"})
    if (std::system((std::string(python) + " -c 'import matplotlib' >/dev/null 2>&1").c_str()) == 0) return python;
  return "";
}

/// A folder for the time of drawing.
class Scratch {
 public:
  explicit Scratch(fs::path path) : path_(std::move(path)) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool is_file_name(const std::string& name) {
  return !name.empty() && fs::path(name).filename() == name && name != "." && name != "..";
}

/// What an earlier report wrote. One of a version without the list is known by its report.md, which shows every
/// picture.
std::set<std::string> listed_pictures(const fs::path& out) {
  std::set<std::string> names;
  const auto add = [&](const std::string& name) {
    if (is_file_name(name)) names.insert(name);
  };
  if (fs::exists(out / kPicturesList)) {
    const json j = json::parse(text_of(out / kPicturesList), nullptr, false);
    if (!j.is_object() || j.value("format", "") != "clothbench-report-pictures" || !j.contains("pictures") ||
        !j["pictures"].is_array())
      throw Error((out / kPicturesList).string() +
                  ": expected the list of a report's pictures; move it away, or give another -o");
    for (const json& name : j["pictures"])
      if (name.is_string()) add(name.get<std::string>());
    return names;
  }
  const std::string report = text_of(out / "report.md");
  if (!report.starts_with("# clothbench report\n")) return names;
  static const std::regex picture(R"(!\[[^\]\n]*\]\(([A-Za-z0-9._=-]+)\.svg\))");
  for (std::sregex_iterator at(report.begin(), report.end(), picture), end; at != end; ++at)
    for (const char* kind : {".svg", ".png"}) add((*at)[1].str() + kind);
  return names;
}

void write_list(const fs::path& out, const std::set<std::string>& names) {
  const json j = {{"format", "clothbench-report-pictures"}, {"format_version", 1}, {"pictures", names}};
  write_file_atomically(out / kPicturesList, j.dump(1) + "\n");
}

void put_in_place(const fs::path& out, const fs::path& from) {
  const std::set<std::string> old = listed_pictures(out);
  std::set<std::string> drawn;
  for (const auto& entry : fs::directory_iterator(from))
    if (entry.path().extension() == ".svg" || entry.path().extension() == ".png")
      drawn.insert(entry.path().filename().string());
  for (const std::string& name : drawn)
    if (!old.contains(name) && fs::exists(out / name))
      throw Error(
          (out / name).string() +
          ": is in the way of a picture of that name, and no report wrote it; move it away, or give another -o");
  // First both, so that whatever a kill leaves here is known to be a report's.
  std::set<std::string> both = old;
  both.insert(drawn.begin(), drawn.end());
  if (!both.empty()) write_list(out, both);
  for (const std::string& name : drawn) fs::rename(from / name, out / name);
  for (const std::string& name : old)
    if (!drawn.contains(name)) fs::remove(out / name);
  if (!both.empty()) write_list(out, drawn);
}

}  // namespace

Drawn draw_pictures(const fs::path& out, const std::vector<Drawing>& drawings) {
  const std::string python = find_python();
  const std::string older =
      listed_pictures(out).empty() ? "" : " The pictures in this folder are those of an earlier report.";
  if (python.empty())
    return {"Figures were left out: no Python with matplotlib (Debian: python3-matplotlib)." + older, false};
  fs::path scripts, published;
  try {
    scripts = find_data(kScriptFolder);
    published = find_data(kResultFolder) / "paper-table3.json";
  } catch (const Error& e) {  // the tables do not depend on it
    return {std::string("Figures were left out: ") + e.what() + older, true};
  }
  const Scratch scratch(temporary_name(out / "pictures"));
  for (const Drawing& d : drawings) {
    const fs::path from = scratch.path() / d.from.filename();
    fs::copy_file(d.from, from);
    const auto command = [&](const fs::path& data) {
      return fmt::format("{} {} {} {}", python, quoted(scripts / d.script), quoted(data),
                         d.published      ? quoted(published)
                         : d.also.empty() ? ""
                                          : quoted(d.also));
    };
    if (std::system(command(from).c_str()) != 0)
      return {"Figures were left out: this command failed: " + command(d.from) + "." + older, true};
  }
  put_in_place(out, scratch.path());
  return {};
}

}  // namespace clothbench
