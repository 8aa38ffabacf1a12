#include "truth/tolerance.hpp"

#include <algorithm>

#include "clothbench/error.hpp"

namespace clothbench::truth {
namespace {

// Twice the 1 % at which work-precision diagrams read off a time: a run that is farther off is of no stated accuracy.
constexpr double kOfMotion = 0.02;
// A strip turns on a cylinder row by row. At 9 rows on it, the fewest that are drawn, a row that comes onto it or
// leaves it can lose (pi / 18)^2 = 3 % of its kinetic energy to the contact.
constexpr double kOnCylinder = 0.03;

}  // namespace

const std::vector<Tolerance>& tolerances() {
  static const std::vector<Tolerance> all = {
      {"free-fall", kOfMotion, 0, "Newton's law: no parameter of the cloth enters"},
      {"pendulum", kOfMotion, 0, "one degree of freedom, half a swing at most"},
      {"swing-strip", kOfMotion, 0, "the chain is not chaotic until the end of the scene"},
      {"swing-sheet", kOfMotion, 0, "the same of springs"},
      {"heavy-strip", kOfMotion, 1e-3, "statics; 10^-3 of the length is what stability class F3 takes for no stretch"},
      {"catenary", kOfMotion, 0, "statics"},
      {"cantilever", kOfMotion, 0, "statics"},
      {"two-hand-pull", kOfMotion, 0, "waves that the ramp makes longer than a cell"},
      {"pulled-sheet", kOfMotion, 0, "the same with shear"},
      {"incline", kOfMotion, 1e-4, "Coulomb's law; at rest 25 um of a sheet of 0.25 m"},
      {"capstan", kOnCylinder, 5e-3, "a polygon on a cylinder; at rest a fifth of a cell"},
      {"atwood", kOnCylinder, 0, "a polygon on a cylinder"}};
  return all;
}

const Tolerance& tolerance_of(const std::string& reference_case) {
  const auto at = std::find_if(tolerances().begin(), tolerances().end(),
                               [&](const Tolerance& t) { return t.reference_case == reference_case; });
  if (at == tolerances().end()) throw Error("reference case \"" + reference_case + "\": it has no tolerance");
  return *at;
}

}  // namespace clothbench::truth
