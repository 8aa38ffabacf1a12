// Built without CGAL: scenes with colliders are not measured, and these functions serve scenes without any.
#include "metrics/motion_check/bodies.hpp"

namespace clothbench::motion_check {

struct Bodies::State {};
Bodies::Bodies(const Motion&, std::span<const double>) {}
Bodies::~Bodies() = default;
bool Bodies::empty() const { return true; }
bool Bodies::any_moves() const { return false; }
double Bodies::speed() const { return 0; }
const std::vector<Contact>& Bodies::contacts(std::size_t) {
  static const std::vector<Contact> none;
  return none;
}
bool Bodies::touched(std::size_t, std::size_t) const { return false; }
const Face& Bodies::face(std::size_t) const {
  static const Face none;
  return none;
}
double Bodies::depth_ratio(std::size_t) const { return 0; }
bool Bodies::near(std::size_t, std::span<const V3>, double) const { return false; }
int Bodies::passages(std::size_t) const { return 0; }

}  // namespace clothbench::motion_check
