// The verdict on a motion from its stored positions (verdict/README.md).
#include "metrics/verdict/verdict.hpp"

#include <string_view>
#include <utility>

#include "metrics/reduction.hpp"

namespace clothbench {
namespace {

const verdict::Finding* finding(const RunView& r, const char* name) {
  for (const verdict::Finding& f : r.findings())
    if (f.statistic->name == std::string_view(name)) return &f;
  return nullptr;
}

template <std::size_t K>
Scalar scalar() {
  const verdict::Statistic& s = verdict::statistics()[K];
  Scalar out{kVerdict + s.name, own(
                                    {}, std::string(s.what) + ", over its tolerance: the largest of all frames",
                                    [](const RunView& r) {
                                      const verdict::Finding* f = finding(r, verdict::statistics()[K].name);
                                      return f == nullptr ? kMissing : f->ratio;
                                    },
                                    "1")};
  out.present = [](const RunView& r) { return finding(r, verdict::statistics()[K].name) != nullptr; };
  return out;
}

template <std::size_t... K>
std::vector<Scalar> all_scalars(std::index_sequence<K...>) {
  return {scalar<K>()...};
}

}  // namespace

MetricGroup verdict_metrics() {
  std::vector<Scalar> all = all_scalars(std::make_index_sequence<verdict::kStatistics>());
  Scalar frame{"verdict_frame", own(
                                    {}, "frame in which the statistic with the largest ratio has it",
                                    [](const RunView& r) {
                                      const verdict::Finding* f = verdict::worst(r.findings());
                                      return f == nullptr ? kMissing : f->frame;
                                    },
                                    "1")};
  frame.present = [](const RunView& r) { return !r.findings().empty(); };
  all.push_back(std::move(frame));
  return {{}, std::move(all)};
}

}  // namespace clothbench
