#include "metrics/registry.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "metrics/collider_contact.hpp"
#include "metrics/stability/judge.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {
namespace {

template <class T>
std::vector<T> of_all_groups(std::vector<T> MetricGroup::*list) {
  std::vector<T> all;
  for (const MetricGroup& g : metric_groups()) all.insert(all.end(), (g.*list).begin(), (g.*list).end());
  return all;
}

bool fits(const std::string& pattern, const std::string& name) {
  if (pattern.back() != '*') return pattern == name;
  return name.starts_with(pattern.substr(0, pattern.size() - 1));
}

constexpr double kSettled_s = 0.5, kLast_s = 1;

/// A reduction of a series from a given frame on; NaN if the run has no such frames.
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

/// Searches from half a frame later than one second before the end, so that rounding adds no frame.
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

const char* name_of(Better better) {
  static constexpr const char* kNames[] = {"less", "more", "neither"};
  return kNames[static_cast<std::size_t>(better)];
}

const std::vector<Metric>& metrics() {
  static const std::vector<Metric> all = of_all_groups(&MetricGroup::series);
  return all;
}

const std::vector<Scalar>& scalars() {
  static const std::vector<Scalar> all = [] {
    std::vector<Scalar> v = of_all_groups(&MetricGroup::scalars);
    for (Scalar& s : v) {
      s.units = s.from.units;
      s.doc = s.from.how;
      for (const Metric& m : metrics())
        if (s.units.empty() && m.name == s.from.series.at(0)) {
          s.units = m.units;
          s.doc = m.long_name + "; " + s.doc;
        }
    }
    return v;
  }();
  return all;
}

const Scalar* find_scalar(const std::string& name) {
  const auto at = std::find_if(scalars().begin(), scalars().end(), [&](const Scalar& s) { return fits(s.name, name); });
  return at == scalars().end() ? nullptr : &*at;
}

std::vector<std::string> series_columns() {
  std::map<int, std::string> names;
  for (const Metric& m : metrics())
    if (m.series_column > 0) names[m.series_column] = m.name;
  std::vector<std::string> out;
  for (const auto& [unused, name] : names) out.push_back(name);
  return out;
}

std::map<std::string, double> scalars_of(const RunView& run, const std::string& start) {
  std::map<std::string, double> out;
  const std::map<std::string, double> none;
  const auto& known = run.run == nullptr ? none : run.run->summary;
  const RunView untimed(run.scene, run.pass, run.outcome);
  for (const Scalar& s : scalars()) {
    if (!s.name.starts_with(start) || !s.from.value || (s.present != nullptr && !s.present(run))) continue;
    const bool of_trials = s.present != nullptr && !s.present(untimed);
    const auto at = of_trials ? known.end() : known.find(s.name);
    out[s.name] = at != known.end() ? at->second : s.from.value(run);
  }
  return out;
}

bool is_of_machine(const std::string& summary_name) {
  const Scalar* s = find_scalar(summary_name.starts_with(kExpect) ? summary_name.substr(kExpect.size()) : summary_name);
  return s != nullptr && s->of_machine;
}

MetricPass::MetricPass(const MetricContext& context) : context_(context) {
  for (const Metric& m : metrics()) {
    if (!m.applies(context.scene)) continue;
    wanted_.push_back(&m);
    series_.push_back({m.name, m.units, m.long_name, {}});
  }
  if (kWithContactMetrics && !context.scene.colliders.empty())
    contact_ = collider_contact(context.scene, context.contact_margins_m);
  if (kWithContactMetrics && context.scene.needs.has(Feature::SelfCollision))
    triangles_ = triangles(context.scene.cloth);
  if (!context.scene.reference_case.empty()) judge_ = std::make_unique<TruthJudge>(context.scene);
  if (!context.scene.stability.name.empty()) stability_ = std::make_unique<StabilityJudge>(context.scene);
}

MetricPass::~MetricPass() = default;

void MetricPass::add(const ClothState& state) {
  MetricFrame frame{context_, frame_, state};
  if (contact_) {
    frame.contact = contact_->probe(frame_, state.position);
    frame.touch = contact_->touch(frame_, state.position);
  }
  if (!triangles_.empty()) frame.self_contact = self_contact(state.position, triangles_);
  if (judge_) frame.truth = judge_->judge(frame_, state);
  if (stability_) frame.stability = stability_->judge(frame_, state, frame.truth);
  lost_ = lost_ || (stability_ && frame.stability->lost());
  for (std::size_t m = 0; m < wanted_.size(); ++m) series_[m].values.push_back(wanted_[m]->value(frame));
  ++frame_;
}

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

const motion_check::Finding* RunView::finding(std::string_view name) const {
  const auto all = findings();
  const auto at = std::find_if(all.begin(), all.end(), [&](const auto& f) { return f.statistic->name == name; });
  return at == all.end() ? nullptr : &*at;
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
  // Starts half a frame earlier, so that rounding omits no frame.
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
