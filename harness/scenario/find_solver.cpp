#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

const SolverEntry& find_solver(const std::string& name) {
  std::vector<std::string> names;
  for (const SolverEntry& e : solvers()) {
    if (e.info.name == name) return e;
    names.push_back(e.info.name);
  }
  if (const SolverEntry* external = external_solver(name)) return *external;
  throw Error("no solver " + in_quotes(name) + " in this build" + nearest_known(name, names) +
              " (built in: " + joined(names) + "; others may have been left out with -DCLOTHBENCH_WITH_…=OFF)");
}

}  // namespace clothbench
