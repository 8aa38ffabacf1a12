#include <algorithm>

#include "xr/session.hpp"

namespace clothbench::xr {

Counters::Counters(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  for (const Metrics& m : kMetrics)
    if (kind_ == nullptr && xr.has(m.extension)) kind_ = &m;
  if (kind_ == nullptr) return;
  const auto enumerate = xr.function<XrResult(XRAPI_PTR*)(XrInstance, std::uint32_t, std::uint32_t*, XrPath*)>(
      std::string("xrEnumeratePerformanceMetricsCounterPaths") + kind_->suffix);
  const auto set = xr.function<XrResult(XRAPI_PTR*)(XrSession, const MetricsState*)>(
      std::string("xrSetPerformanceMetricsState") + kind_->suffix);
  query_ = xr.function<decltype(query_)>(std::string("xrQueryPerformanceMetricsCounter") + kind_->suffix);
  const MetricsState on{kind_->state, nullptr, XR_TRUE};
  std::uint32_t count = 0;
  // Counters are an extra, so a failure does not end the session.
  if (XR_FAILED(set(session.handle(), &on)) || XR_FAILED(enumerate(xr.handle(), 0, &count, nullptr))) return;
  std::vector<XrPath> paths(count);
  if (XR_FAILED(enumerate(xr.handle(), count, &count, paths.data()))) return;
  for (const XrPath path : paths) {
    char text[XR_MAX_PATH_LENGTH] = "";
    if (XR_FAILED(xr.xr().xrPathToString(xr.handle(), path, sizeof text, &count, text))) continue;
    std::string name = text;  // such as /perfmetrics_meta/app/gpu_frametime
    name.erase(0, name.find('/', 1) + 1);
    std::replace(name.begin(), name.end(), '/', '_');
    paths_.push_back(path);
    group_.arrays.push_back({name, "1", std::string("the runtime's counter ") + text, {"frame"}, {0}});
  }
}

void Counters::read() {
  constexpr std::array kUnits = {"1", "%", "ms", "B", "Hz"};  // by XrPerformanceMetricsCounterUnitMETA
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    auto c = blank<MetricsCounter>(kind_->counter);
    const bool read = XR_SUCCEEDED(query_(session_.handle(), paths_[k], &c));
    StoredArray& a = group_.arrays[k];
    a.values.push_back(read && (c.flags & kRealValid) != 0    ? static_cast<double>(c.real)
                       : read && (c.flags & kWholeValid) != 0 ? c.whole
                                                              : kMissing);
    a.shape = {a.values.size()};
    if (read && c.unit < kUnits.size()) a.units = kUnits[c.unit];
  }
}

}  // namespace clothbench::xr
