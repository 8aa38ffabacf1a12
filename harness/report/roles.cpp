#include "report/roles.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "report/paths.hpp"

namespace clothbench {
namespace {

bool has_role(const std::string& solver, const char* role) {
  static const nlohmann::json roles = nlohmann::json::parse(kSolverRoles);
  const nlohmann::json& names = roles.at(role);
  return std::find(names.begin(), names.end(), solver) != names.end();
}

}  // namespace

bool is_floor(const std::string& solver) { return has_role(solver, "floor"); }
bool is_baseline(const std::string& solver) { return has_role(solver, "baseline"); }

}  // namespace clothbench
