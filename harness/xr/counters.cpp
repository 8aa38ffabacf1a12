#include "xr/counters.hpp"

#include "clothbench/record.hpp"

namespace clothbench::xr {
namespace {

const char* units_of(int unit) {
  constexpr const char* kUnits[] = {"1", "%", "ms", "B", "Hz"};
  return unit >= 0 && unit < 5 ? kUnits[unit] : "1";
}

}  // namespace

Counters::Counters(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  if (!xr.has(kPerformanceMetrics)) return;
  const auto enumerate = xr.function<EnumerateMetricsCounterPaths>("xrEnumeratePerformanceMetricsCounterPathsMETA");
  const auto set = xr.function<SetMetricsState>("xrSetPerformanceMetricsStateMETA");
  query_ = xr.function<QueryMetricsCounter>("xrQueryPerformanceMetricsCounterMETA");
  const MetricsState on{kTypeMetricsState, nullptr, XR_TRUE};
  std::uint32_t count = 0;
  // Measurements are welcome, not needed.
  if (enumerate == nullptr || set == nullptr || query_ == nullptr || XR_FAILED(set(session.handle(), &on)) ||
      XR_FAILED(enumerate(xr.handle(), 0, &count, nullptr)))
    return;
  std::vector<XrPath> paths(count);
  if (XR_FAILED(enumerate(xr.handle(), count, &count, paths.data()))) return;
  for (const XrPath path : paths) {
    char name[XR_MAX_PATH_LENGTH] = "";
    std::uint32_t length = 0;
    if (XR_SUCCEEDED(xr.xr().xrPathToString(xr.handle(), path, sizeof name, &length, name)))
      counters_.push_back({path, name});
  }
}

void Counters::read(const std::function<void(const std::string&, const std::string&, double)>& take) const {
  for (const Counter& c : counters_) {
    MetricsCounter m{kTypeMetricsCounter, nullptr, 0, 0, 0, 0};
    const bool there = XR_SUCCEEDED(query_(session_.handle(), c.path, &m));
    double value = kMissing;
    if (there && (m.flags & kCounterFloatValid) != 0)
      value = static_cast<double>(m.float_value);
    else if (there && (m.flags & kCounterUintValid) != 0)
      value = m.uint_value;
    take(c.name, units_of(m.unit), value);
  }
}

}  // namespace clothbench::xr
