// Whether a motion is possible, from its stored positions (motion_check/README.md).
#include "metrics/motion_check/motion_check.hpp"

#include <string_view>
#include <utility>

#include "metrics/registry.hpp"

namespace clothbench {
namespace {

const motion_check::Finding* finding(const RunView& r, const char* name) {
  for (const motion_check::Finding& f : r.findings())
    if (f.statistic->name == std::string_view(name)) return &f;
  return nullptr;
}

template <std::size_t K>
Scalar scalar() {
  const motion_check::Statistic& s = motion_check::statistics()[K];
  Scalar out{kMotionCheck + s.name, own(
                                        {}, std::string(s.what) + ", over its tolerance: the largest of all frames",
                                        [](const RunView& r) {
                                          const motion_check::Finding* f =
                                              finding(r, motion_check::statistics()[K].name);
                                          return f == nullptr ? kMissing : f->ratio;
                                        },
                                        "1")};
  out.present = [](const RunView& r) { return finding(r, motion_check::statistics()[K].name) != nullptr; };
  return out;
}

template <std::size_t... K>
std::vector<Scalar> all_scalars(std::index_sequence<K...>) {
  return {scalar<K>()...};
}

}  // namespace

MetricGroup motion_check_metrics() {
  std::vector<Scalar> all = all_scalars(std::make_index_sequence<motion_check::kStatistics>());
  Scalar frame{kMotionCheck + "frame", own(
                                           {}, "frame in which the statistic with the largest ratio has it",
                                           [](const RunView& r) {
                                             const motion_check::Finding* f = motion_check::worst(r.findings());
                                             return f == nullptr ? kMissing : f->frame;
                                           },
                                           "1")};
  frame.better = Better::Neither;
  frame.present = [](const RunView& r) { return !r.findings().empty(); };
  all.push_back(std::move(frame));
  return {{}, std::move(all)};
}

}  // namespace clothbench
