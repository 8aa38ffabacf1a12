// What a study's file says without its scenes, and names.
#include "base/json_text.hpp"
#include "scenario/study.hpp"

namespace clothbench {

using nlohmann::json;

namespace {

json protocol_in(const std::string& name_or_path) {
  const std::filesystem::path file = find_scenario(name_or_path);
  const json j = parse_json(read_text(file), file.string());
  return j.is_object() ? j.value("protocol", json()) : json();
}

}  // namespace

bool is_study(const std::string& name_or_path) { return !protocol_in(name_or_path).is_null(); }

bool is_study_of(const std::string& name_or_path, const std::string& protocol) {
  return protocol_in(name_or_path) == protocol;
}

std::string StudySolver::name() const { return label == "default" ? solver : solver + " " + label; }

bool is_drawn(const Study& study) { return study.protocol == "contact"; }

}  // namespace clothbench
