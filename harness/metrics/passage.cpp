// Where the cloth passed through the colliders of its scene and how it slides on them: results of ColliderPassage.
#include <algorithm>

#include "metrics/collider_contact.hpp"
#include "metrics/reduction.hpp"

namespace clothbench {
namespace {

bool can_be_passed(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), has_centre_line);
}

bool has_friction(const Scene& s) {
  return kWithContactMetrics &&
         std::any_of(s.colliders.begin(), s.colliders.end(), [](const Collider& c) { return c.friction > 0; });
}

auto passage_field(double ScenePassage::*field) {
  return [field](const MetricFrame& f) { return f.passage->*field; };
}

/// Distance [m] slid in the last half second.
double slip_settled(const RunView& r) {
  const std::vector<double>* slip = r.series("slip_m");
  if (slip == nullptr || !r.whole()) return kMissing;
  const std::size_t from = r.settled_from();
  if (slip->size() - from < 3) return kMissing;
  double way = 0;
  for (std::size_t f = from + 1; f < slip->size(); ++f) way += (*slip)[f];
  return way;
}

/// A frame that is not known counts as hooked.
double hooked_longest(const RunView& r) {
  const std::vector<double>* axes = r.series("hooked_axes");
  if (axes == nullptr) return kMissing;
  std::vector<bool> hooked;
  for (const double n : *axes) hooked.push_back(!(n == 0));
  return longest_time(hooked, r.pass.time_s);
}

}  // namespace

MetricGroup passage_metrics() {
  using P = ScenePassage;
  using enum SlackUnit;
  static constexpr Gate kShare{2e-3, One, 0.1, true, "two vertices of a 32 × 32 cloth"},
      kSamples{4, One, 0.1, true, "two vertices and two cells"}, kMoment{0.05, One, 0.25, true, "four frames at 72 Hz"},
      kAxes{0, One, 0, true, "none"}, kSlip{1e-2, Length, 0.5, false, "a fold that slides elsewhere"};
  constexpr Needs kPassed{"moving capsules and hands", can_be_passed}, kFriction{"friction", has_friction};
  return {
      {{"wrong_side_fraction", "1", "share of the cloth on the wrong side of a moving collider's centre line", kPassed,
        passage_field(&P::wrong_side_fraction)},
       {"wrong_side_samples", "1", "vertices and cell centres on the wrong side", kPassed,
        passage_field(&P::wrong_side_samples)},
       {"laid_over_samples", "1", "vertices and cell centres laid over a moving collider's centre line", kPassed,
        passage_field(&P::laid_over_samples)},
       {"hooked_axes", "1", "axes of moving capsules and fingers that go through the cloth", kPassed,
        passage_field(&P::hooked_axes)},
       {"touching_fraction", "1", "share of the cloth's triangles within the margin of a collider, by area", kColliders,
        passage_field(&P::touching_fraction)},
       {"slip_m", "m", "mean distance that touching vertices slid on the surface in the frame", kFriction,
        passage_field(&P::slip_m)}},
      {{"wrong_side_samples_max", greatest("wrong_side_samples"), Expect::Yes, &kSamples, 110},
       {"wrong_side_fraction_max", greatest("wrong_side_fraction"), Expect::Yes, &kShare, 120},
       {"wrong_side_fraction_end", last("wrong_side_fraction"), Expect::No, &kShare, 130},
       {"laid_over_samples_max", greatest("laid_over_samples"), Expect::Yes, nullptr, 131},
       {"laid_over_samples_end", last("laid_over_samples"), Expect::Yes, nullptr, 132},
       {"hooked_longest_s",
        own({"hooked_axes"}, "longest time without a break in which an axis goes through the cloth", hooked_longest,
            "s"),
        Expect::Yes, &kMoment, 133},
       {"hooked_end", last("hooked_axes"), Expect::Yes, &kAxes, 134},
       {"slip_m", sum("slip_m"), Expect::Yes, &kSlip, 250},
       {"slip_settled_m", own({"slip_m"}, "distance that touching vertices slid in the last 0.5 s", slip_settled, "m"),
        Expect::No, nullptr, 260}}};
}

}  // namespace clothbench
