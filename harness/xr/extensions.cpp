#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

Counters::Counters(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  for (const Metrics& m : kMetrics)
    if (kind_ == nullptr && xr.has(m.extension)) kind_ = &m;
  if (kind_ == nullptr) return;
  const Block<0> on{.type = kind_->state, .number = XR_TRUE};
  xr.call(std::string("xrSetPerformanceMetricsState") + kind_->suffix, session.handle(), &on);
  std::array<XrPath, 1024> paths{};
  std::uint32_t count = 0;
  const XrResult listed = xr.call(std::string("xrEnumeratePerformanceMetricsCounterPaths") + kind_->suffix, xr.handle(),
                                  std::uint32_t{paths.size()}, &count, paths.data());
  query_ = xr.function<decltype(query_)>(std::string("xrQueryPerformanceMetricsCounter") + kind_->suffix);
  if (XR_FAILED(listed) || query_ == nullptr) return;  // counters are an extra: the session goes on
  for (const XrPath path : std::span(paths).first(count)) {
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
    if (XR_FAILED(query_(session_.handle(), paths_[k], &c))) c = {};
    StoredArray& a = group_.arrays[k];
    if (c.flags != 0 && c.unit < kUnits.size()) a.units = kUnits[c.unit];
    const double whole = (c.flags & kWholeValid) != 0 ? c.whole : kMissing;
    a.values.push_back((c.flags & kRealValid) != 0 ? static_cast<double>(c.real) : whole);
    a.shape = {a.values.size()};
  }
}

TableSearch::TableSearch(const Session& session, const Vec3& near_m) : session_(session), near_m_(near_m) {
  for (const char* name : kPlanes)
    if (const Instance& xr = session.instance(); !xr.has(name))
      throw Error(fmt::format("{} does not offer {}, which --table needs; leave --table out", xr.runtime_name(), name),
                  ExitCode::NoDevice);
}

nlohmann::json TableSearch::step(XrTime time) {
  const Instance& xr = session_.instance();
  const auto count = static_cast<std::uint32_t>(components_.size());
  if (future_ == nullptr) {
    const Block<1000741000> planes{.number = kPlaneTracking, .count = count, .data = components_.data()};
    const void* configurations[] = {&planes};
    const Block<1000740001> context{.number = 1, .data = configurations};
    const Block<1000740003> snapshot{.number = static_cast<int>(count), .data = components_.data()};
    const XrResult begun = context_ == nullptr
                               ? xr.call("xrCreateSpatialContextAsyncEXT", session_.handle(), &context, &future_)
                               : xr.call("xrCreateSpatialDiscoverySnapshotAsyncEXT", context_, &snapshot, &future_);
    if (begun == kComponentUnsupported && components_.back() == kLabel) return components_.pop_back(), nullptr;
    xr.check(begun, "the search for a table (XR_EXT_spatial_plane_tracking)");
  }
  if (context_ == nullptr) {  // completions say whether they are ready, so futures need no other polling
    Block<1000740002> done;
    if (xr.call("xrCreateSpatialContextCompleteEXT", session_.handle(), future_, &done) == kFuturePending)
      return nullptr;
    context_ = done.data;  // null if it failed: it is created again until the time-out
    return future_ = nullptr, nullptr;
  }
  Block<1000740005> done;
  const SnapshotCompletionInfo info{.base = session_.space(), .time = time, .future = future_};
  if (xr.call("xrCreateSpatialDiscoverySnapshotCompleteEXT", context_, &info, &done) == kFuturePending) return nullptr;
  future_ = nullptr;
  if (done.data == nullptr) return nullptr;
  nlohmann::json table = choose(done.data);
  xr.call("xrDestroySpatialSnapshotEXT", done.data);
  // The runtime's tracking of planes would cost time during the session.
  if (!table.is_null()) xr.call("xrDestroySpatialContextEXT", context_);
  return table;
}

nlohmann::json TableSearch::choose(const void* snapshot) const {
  constexpr int kMost = 1024;  // planes
  std::array<std::uint64_t, kMost> ids{};
  std::array<int, kMost> states{}, alignments{}, labels{};
  std::array<Bounds2D, kMost> bounds{};
  const bool labelled = components_.back() == kLabel;
  const Block<1000741004> third{.number = kMost, .data = labels.data()};
  const Block<1000741001> second{.next = labelled ? &third : nullptr, .number = kMost, .data = alignments.data()};
  const Block<1000740009> first{.next = &second, .number = kMost, .data = bounds.data()};
  const Block<1000740006> all{.number = static_cast<int>(components_.size()), .data = components_.data()};
  QueryResult found{
      .next = &first, .id_capacity = kMost, .ids = ids.data(), .state_capacity = kMost, .states = states.data()};
  const Instance& xr = session_.instance();
  xr.check(xr.call("xrQuerySpatialComponentDataEXT", snapshot, &all, &found), "xrQuerySpatialComponentDataEXT");
  const auto up = [&](std::size_t k) { return states[k] == kTracked && alignments[k] == kFacesUp; };
  std::set<double> heights;
  for (std::size_t k = 0; k < found.id_count; ++k)
    if (up(k)) heights.insert(bounds[k].center.position.y);
  nlohmann::json best;
  double best_score = 0;
  for (std::size_t k = 0; k < found.id_count; ++k) {
    const auto& [p, q] = std::pair(bounds[k].center.position, bounds[k].center.orientation);
    const double above_floor = p.y - (heights.empty() ? 0 : *heights.begin());
    const bool fits = heights.size() == 1 || (above_floor >= 0.4 && above_floor <= 1.3);
    const Vec3 center = {p.x, p.y, p.z}, away = minus(center, near_m_);
    const double score = bounds[k].extent_m.width * bounds[k].extent_m.height / (1 + dot(away, away));
    if (!up(k) || !(labelled ? labels[k] == kTable : fits) || !(score > best_score)) continue;
    constexpr double kThickness_m = 0.04;
    const Eigen::Matrix3d m = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
    const Eigen::Vector3d zyx = m.eulerAngles(2, 1, 0) * 180 / EIGEN_PI;
    best_score = score;
    best = {{"type", "box"},
            {"center_m", minus(center, scaled(kThickness_m / 2, {m(0, 2), m(1, 2), m(2, 2)}))},
            {"size_m", {bounds[k].extent_m.width, bounds[k].extent_m.height, kThickness_m}},
            {"rotation_deg", {zyx[2], zyx[1], zyx[0]}}};
  }
  return best;
}

}  // namespace clothbench::xr
