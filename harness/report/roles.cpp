#include "report/roles.hpp"

#include "base/words.hpp"
#include "report/paths.hpp"

namespace clothbench {
namespace {

bool has_role(const std::string& solver, const char* role) { return contains(solver_roles().at(role), solver); }

}  // namespace

const nlohmann::json& solver_roles() {
  static const nlohmann::json all = nlohmann::json::parse(kSolverRoles);
  return all;
}

bool is_floor(const std::string& solver) { return has_role(solver, "floor"); }
bool is_baseline(const std::string& solver) { return has_role(solver, "baseline"); }

}  // namespace clothbench
