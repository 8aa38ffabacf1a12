#include <algorithm>
#include <limits>
#include <numeric>

#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

constexpr double kSettled_s = 0.5, kLast_s = 1;

/// A reduction of a series from a given frame on; NaN if the run does not have those frames.
Reduction of(const char* name, const char* how, std::size_t (*from)(const RunView&),
             double (*reduce)(const std::vector<double>& values, std::size_t from)) {
  return {{name}, how, [=, series = std::string(name)](const RunView& r) {
            const std::vector<double>* v = r.series(series);
            const std::size_t first = from(r);
            return v == nullptr || first >= v->size() ? kMissing : reduce(*v, first);
          }};
}

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

std::size_t from_start(const RunView&) { return 0; }
std::size_t if_settled(const RunView& r) { return r.whole() ? r.settled_from() : kNever; }

/// Half a frame later than one second before the end, so that rounding adds no frame.
std::size_t last_second(const RunView& r) {
  if (!r.whole()) return kNever;
  const std::vector<double>& t = r.pass.time_s;
  const double from_s = t.back() - kLast_s + 0.5 * r.scene.time.dt();
  return static_cast<std::size_t>(std::find_if(t.begin(), t.end(), [&](double s) { return s >= from_s; }) - t.begin());
}

double greatest_from(const std::vector<double>& v, std::size_t from) { return greatest_of(&v, from); }

double sum_from(const std::vector<double>& v, std::size_t from) {
  return std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(from), v.end(), 0.0);
}

}  // namespace

RunView::RunView(const Scene& s, const AccuracyPass& p, Outcome o) : scene(s), pass(p), outcome(std::move(o)) {}

RunView::RunView(const Scene& s, const RunRecord& c, const Plan& its_plan, bool gpu)
    : scene(s), pass(c.accuracy), outcome(c.outcome), run(&c), plan(&its_plan), on_gpu(gpu) {}

const truth::ReferenceCase& RunView::reference_case() const {
  if (!case_) case_ = truth::reference_case_of(scene);
  return case_.value();
}

std::span<const motion_check::Finding> RunView::findings() const {
  if (!findings_) {
    findings_.emplace();
    const bool known = kWithContactMetrics || scene.colliders.empty();
    if (known && !pass.time_s.empty() && pass.position.size() == 3 * scene.cloth.vertex_count() * pass.time_s.size())
      findings_ = motion_check::verify(scene, {pass.time_s, pass.position},
                                       plan == nullptr ? std::vector<double>() : plan->contact_margins_m);
  }
  return *findings_;
}

const ExactBound& RunView::exact_bound() const {
  if (!bound_) bound_ = clothbench::exact_bound(TruthJudge(scene));
  return *bound_;
}

bool RunView::whole() const { return pass.time_s.size() == static_cast<std::size_t>(scene.time.frames()) + 1; }

const std::vector<double>* RunView::series(const std::string& name) const {
  for (const MetricSeries& m : pass.metrics)
    if (m.name == name && !m.values.empty() && m.values.size() == pass.time_s.size()) return &m.values;
  return nullptr;
}

std::size_t RunView::settled_from() const {
  std::size_t from = pass.time_s.size() - 1;
  // Half a frame earlier, so that rounding omits no frame.
  while (from > 0 && pass.time_s[from - 1] >= pass.time_s.back() - kSettled_s - 0.5 * scene.time.dt()) --from;
  return from;
}

double greatest_of(const std::vector<double>* values, std::size_t from) {
  if (values == nullptr || from >= values->size()) return kMissing;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t f = from; f < values->size(); ++f) most = max_or_nan(most, (*values)[f]);
  return most;
}

Reduction greatest(const char* series) { return of(series, "maximum over the frames", from_start, greatest_from); }

Reduction least(const char* series) {
  return of(series, "minimum over the frames", from_start, [](const std::vector<double>& v, std::size_t) {
    double out = -v[0];
    for (const double x : v) out = max_or_nan(out, -x);
    return -out;
  });
}

Reduction last(const char* series) {
  return of(series, "last frame", from_start, [](const std::vector<double>& v, std::size_t) { return v.back(); });
}

Reduction sum(const char* series) { return of(series, "sum over the frames", from_start, sum_from); }

Reduction greatest_settled(const char* series) {
  return of(series, "maximum over the last 0.5 s", if_settled, greatest_from);
}

Reduction greatest_last_second(const char* series) {
  return of(series, "maximum over the last second", last_second, greatest_from);
}

Reduction mean_last_second(const char* series) {
  return of(series, "mean over the last second", last_second, [](const std::vector<double>& v, std::size_t from) {
    return sum_from(v, from) / static_cast<double>(v.size() - from);
  });
}

}  // namespace clothbench
