#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/interval.hpp"
#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// True if the run's scene was drawn by a study of protocol contact (has a "drawn" block).
bool is_drawn_contact(const RunRecord&);

/// Share of drawn scenes that keep all their bounds. A run that is unsupported, timed out or ended otherwise has not
/// passed.
struct ContactRate {
  std::string solver, setting;
  std::string kind;  ///< "all": of every kind
  std::string band;  ///< of speeds [m/s], "all": of every speed
  std::string assets;
  std::size_t passed = 0, drawn = 0;
  std::size_t unsupported = 0, not_ended = 0;  ///< of those drawn; not_ended: timed out, crashed, diverged, ...
  std::string held_at = {};                    ///< distances [mm] at which the solver holds the cloth; empty: none ran
  Interval interval() const { return wilson_95(passed, drawn); }
};

/// For each solver: every kind and speed band with a run, the sums over bands, kinds and both. In the order of tables.
/// Runs whose verdict must not be printed (withheld.hpp) and runs that are still missing are left out.
std::vector<ContactRate> contact_rates(const std::vector<RunRecord>& runs);

/// One solver a row and kind; columns: speed bands.
Table contact_rate_table(const std::vector<RunRecord>& runs);

/// For each solver and kind the run that is furthest from passing, with the command that runs it again. Furthest: one
/// that did not end, then the most broken bounds, then the longest contour.
struct WorstContact {
  const RunRecord* run = nullptr;
  std::string kind, assets;
  double speed_m_per_s = 0;
  std::string command;
};
std::vector<WorstContact> worst_contacts(const std::vector<RunRecord>& runs);
Table worst_contact_table(const std::vector<WorstContact>&);

/// Both in full precision.
std::string contact_rates_csv(const std::vector<RunRecord>& runs);
nlohmann::json contact_rates_json(const std::vector<RunRecord>& runs);

}  // namespace clothbench
