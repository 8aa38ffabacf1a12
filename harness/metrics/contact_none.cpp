// Built without CGAL, as on a device: scenes with colliders are not measured, and motion_check serves scenes without
// any.
#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench {
namespace {

[[noreturn]] void refuse_contact() { throw Error("this build has no contact metrics"); }

}  // namespace

struct ColliderContact::Probes {};

ColliderContact::ColliderContact(const Scene&, const std::vector<double>&) { refuse_contact(); }
ColliderContact::~ColliderContact() = default;
SceneContact ColliderContact::probe(int, const std::vector<double>&) { refuse_contact(); }
SceneTouch ColliderContact::touch(int, const std::vector<double>&) { refuse_contact(); }

SelfContact self_contact(const std::vector<double>&, const std::vector<std::array<std::uint32_t, 3>>&) {
  refuse_contact();
}

}  // namespace clothbench

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
