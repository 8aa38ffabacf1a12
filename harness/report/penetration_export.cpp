// CSV and JSON export of the penetration tables, and of the series in their figures.
#include <fmt/format.h>

#include <cmath>

#include "metrics/registry.hpp"
#include "report/penetration.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

std::string six_digits(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : ""; }

/// Key columns of a run, for ContactRow and records with the same members.
template <class Row>
Columns<Row> contact_keys() {
  return {{"set_up", In::Both, &Row::kind},
          {"scene", In::Both, &Row::scene},
          {"solver", In::Both, [](auto& r) { return r.series.solver; }},
          {"setting", In::Both, [](auto& r) { return r.series.setting; }},
          {"sides", In::Both, [](auto& r) { return r.series.sides; }},
          {"repeat", In::Csv, [](auto& r) { return r.series.repeat; }},
          {"status", In::Both, status_of},
          {"failed_frame", In::Both, failed_frame_of}};
}

struct Frame : ContactRow {
  std::size_t frame = 0;
};

Value value_at(const Frame& f, const std::string& name) {
  for (const MetricSeries& m : f.run->accuracy.metrics)
    if (m.name == name) return six_digits(f.frame < m.values.size() ? m.values[f.frame] : kMissing);
  return "";
}

}  // namespace

json penetration_json(const std::vector<ContactSetUp>& ups) {
  return contact_keys<ContactRow>()
      .add({{"expect", In::Both, [](auto& r) { return verdict(*r.run); }},
            {"held_at_least_m", In::Both, [](auto& r) { return held_at_m(*r.run).first; }},
            {"held_at_most_m", In::Both, [](auto& r) { return held_at_m(*r.run).second; }}})
      .add(summary_columns<ContactRow>(penetration_columns()))
      .json(contact_rows(ups));
}

std::string series_csv(const std::vector<ContactSetUp>& ups) {
  Columns<Frame> columns = contact_keys<Frame>();
  columns.push_back(
      {"time_s", In::Both, [](auto& f) { return fmt::format("{:.6g}", f.run->accuracy.time_s[f.frame]); }});
  for (const std::string& name : series_columns())
    columns.push_back({name, In::Both, [name](auto& f) { return value_at(f, name); }});
  std::vector<Frame> frames;
  for (const ContactRow& r : contact_rows(ups))
    for (std::size_t k = 0; k < r.run->accuracy.time_s.size(); ++k) frames.push_back({r, k});
  return columns.csv(frames);
}

}  // namespace clothbench
