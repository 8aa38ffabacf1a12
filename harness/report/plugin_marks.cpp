#include "report/plugin_marks.hpp"

#include <algorithm>
#include <cctype>

#include "report/grid.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr char kMark[] = "†";
constexpr char kWhat[] = "†: a plugin, built outside of clothbench.";

/// Of the names of solvers, settings and scenes.
bool in_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-' || c == '/';
}

bool names_solvers(const std::string& head) {
  static const std::set<std::string> others = {"scene", "scenes", "setting", "message", "runs it again", "map", "case"};
  return !others.contains(head);
}

}  // namespace

PluginMarks::PluginMarks(const std::vector<RunRecord>& runs) {
  for (const RunRecord& c : runs)
    if (environment_of(c, "plugin").is_object()) names_.insert(c.header.solver);
}

std::string PluginMarks::text(const std::string& text) const {
  if (names_.empty()) return text;
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto from = text.begin() + static_cast<std::ptrdiff_t>(at);
    const bool word = in_word(text[at]);
    const auto end = std::find_if(from, text.end(), [&](char c) { return in_word(c) != word; });
    const std::string part(from, end);
    out += part;
    at += part.size();
    if (word && names_.contains(part) && text.compare(at, sizeof kMark - 1, kMark) != 0) out += kMark;
  }
  return out;
}

Table PluginMarks::table(Table t) const {
  if (names_.empty() || t.rows.empty()) return t;
  bool any = false;
  const std::vector<std::string> head = t.rows.front();
  for (auto& row : t.rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k < head.size() && !names_solvers(head[k])) continue;
      std::string marked = text(row[k]);
      any = any || marked.find(kMark) != std::string::npos;
      row[k] = std::move(marked);
    }
  if (any && t.note.find(kWhat) == std::string::npos) t.note += (t.note.empty() ? "" : " ") + std::string(kWhat);
  return t;
}

std::vector<Table> PluginMarks::tables(std::vector<Table> all) const {
  for (Table& t : all) t = table(std::move(t));
  return all;
}

json PluginMarks::data(const json& value) const {
  if (names_.empty()) return value;
  if (value.is_array()) {
    json out = json::array();
    for (const json& v : value) out.push_back(data(v));
    return out;
  }
  if (!value.is_object()) return value;
  json out = json::object();
  for (const auto& [key, v] : value.items()) {
    const bool shown = key == "solver" || key == "solvers" || key == "label";
    const std::string to = names_.contains(key) ? key + kMark : key;
    if (shown && v.is_string()) {
      out[to] = text(v.get<std::string>());
    } else if (shown && v.is_array() && std::all_of(v.begin(), v.end(), [](const json& x) { return x.is_string(); })) {
      for (const json& x : v) out[to].push_back(text(x.get<std::string>()));
    } else {
      out[to] = data(v);
    }
  }
  return out;
}

std::string engine_of(const RunRecord& c) {
  const json plugin = environment_of(c, "plugin");
  return plugin.is_object() ? plugin.value("engine", std::string()) : "";
}

}  // namespace clothbench
