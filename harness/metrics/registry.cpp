#include "metrics/registry.hpp"

#include <algorithm>

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
  for (const Scalar& s : scalars())
    if (s.name.starts_with(start) && s.from.value && (s.present == nullptr || s.present(run)))
      out[s.name] = s.from.value(run);
  return out;
}

bool is_of_machine(const std::string& summary_name) {
  const Scalar* s = find_scalar(summary_name.starts_with(kExpect) ? summary_name.substr(kExpect.size()) : summary_name);
  return s != nullptr && s->of_machine;
}

}  // namespace clothbench
