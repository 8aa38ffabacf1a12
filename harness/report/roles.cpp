#include "report/roles.hpp"

#include <algorithm>

#include "report/paths.hpp"

namespace clothbench {
namespace {

bool has_role(const std::string& solver, const char* role) {
  const nlohmann::json& names = solver_roles().at(role);
  return std::find(names.begin(), names.end(), solver) != names.end();
}

}  // namespace

const nlohmann::json& solver_roles() {
  static const nlohmann::json all = nlohmann::json::parse(kSolverRoles);
  return all;
}

bool is_floor(const std::string& solver) { return has_role(solver, "floor"); }
bool is_baseline(const std::string& solver) { return has_role(solver, "baseline"); }

}  // namespace clothbench
