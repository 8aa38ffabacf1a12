// Numbers of the penetration tables for machines, and the series their figures are drawn from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_number.hpp"
#include "report/penetration.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

const std::vector<std::string> kSeries = {"contact_length_m", "tunnelled_fraction", "tunnelled_depth_m",
                                          "depth_m",          "depth_vertex_m",     "stretch_max"};

const MetricSeries* find(const CellRecord& c, const std::string& name) {
  for (const MetricSeries& m : c.accuracy.metrics)
    if (m.name == name) return &m;
  return nullptr;
}

}  // namespace

const std::vector<std::string>& contact_names() {
  static const std::vector<std::string> names = {"tunnelled_fraction_max",
                                                 "tunnelled_fraction_end",
                                                 "tunnelled_depth_max_m",
                                                 "contact_length_max_m",
                                                 "contact_length_settled_m",
                                                 "depth_max_m",
                                                 "depth_vertex_max_m",
                                                 "depth_p99_m",
                                                 "depth_mean_m",
                                                 "penetrating_area_max_m2",
                                                 "wrong_side_samples_max",
                                                 "wrong_side_fraction_max",
                                                 "wrong_side_fraction_end",
                                                 "self_contact_pairs_max",
                                                 "self_contact_pairs_end",
                                                 "self_contact_length_max_m",
                                                 "self_contact_length_settled_m",
                                                 "contact_length_mean_m",
                                                 "depth_time_mean_m",
                                                 "contact_violated_longest_s",
                                                 "untangle_s",
                                                 "pop_displacement_m",
                                                 "pop_speed_m_per_s",
                                                 "pop_speed_ratio",
                                                 "slip_m",
                                                 "slip_settled_m",
                                                 "rest_jitter_m",
                                                 "rest_drift_m_per_s",
                                                 "fold_roughness_end",
                                                 "fold_angle_rms_end_rad",
                                                 "grip_error_max_m",
                                                 "grip_edge_ratio_max",
                                                 "grip_edge_ratio_held",
                                                 "strain_mean_released",
                                                 "imposed_speed_m_per_s",
                                                 "truth_quantity_error_max",
                                                 "truth_quantity_error",
                                                 "truth_e2",
                                                 "stretch_max",
                                                 "stretch_max_end",
                                                 "frame_wall_median_s",
                                                 "frame_device_median_s"};
  return names;
}

json penetration_json(const std::vector<ContactSetUp>& ups) {
  json out = json::array();
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        json row = {{"set_up", u.kind},          {"scene", s.name},
                    {"solver", r.series.solver}, {"setting", r.series.setting},
                    {"sides", r.series.sides},   {"status", r.cell->outcome.status},
                    {"expect", verdict(*r.cell)}};
        if (r.cell->outcome.failed_frame >= 0) row["failed_frame"] = r.cell->outcome.failed_frame;
        for (const std::string& name : contact_names()) row[name] = finite_or_null(summary_value(*r.cell, name));
        if (const std::string why = withheld_of(*r.cell, contact_names()); !why.empty()) row["withheld"] = why;
        out.push_back(std::move(row));
      }
  return out;
}

std::string series_csv(const std::vector<ContactSetUp>& ups) {
  std::vector<std::string> head = {"set_up", "scene",  "solver",       "setting", "sides",
                                   "repeat", "status", "failed_frame", "time_s"};
  head.insert(head.end(), kSeries.begin(), kSeries.end());
  std::string out = csv_row(head);
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        const CellRecord& c = *r.cell;
        std::vector<const MetricSeries*> found;
        for (const std::string& name : kSeries) found.push_back(find(c, name));
        for (std::size_t frame = 0; frame < c.accuracy.time_s.size(); ++frame) {
          std::vector<std::string> row = {u.kind,
                                          s.name,
                                          r.series.solver,
                                          r.series.setting,
                                          r.series.sides,
                                          std::to_string(r.series.repeat),
                                          c.outcome.status,
                                          c.outcome.failed_frame < 0 ? "" : std::to_string(c.outcome.failed_frame),
                                          fmt::format("{:.6g}", c.accuracy.time_s[frame])};
          for (const MetricSeries* m : found) {
            const double v = m != nullptr && frame < m->values.size() ? m->values[frame] : kMissing;
            row.push_back(std::isfinite(v) ? fmt::format("{:.6g}", v) : "");
          }
          out += csv_row(row);
        }
      }
  return out;
}

}  // namespace clothbench
