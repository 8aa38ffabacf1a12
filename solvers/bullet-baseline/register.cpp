#include "bullet-baseline/bullet_solver.hpp"

namespace clothbench {

void register_bullet_baseline(std::vector<SolverEntry>& out) {
  out.push_back(bullet_baseline::soft_entry());
  out.push_back(bullet_baseline::deformable_entry());
}

}  // namespace clothbench
