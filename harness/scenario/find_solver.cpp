#include <cctype>

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
  std::string known, near = nearest(name, names);
  for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
  throw Error("no solver \"" + name + "\" in this build" + (near.empty() ? "" : "; nearest known: " + near) +
              " (built in: " + known + "; others may have been left out with -DCLOTHBENCH_WITH_…=OFF)");
}

}  // namespace clothbench
