#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/penetration.hpp"

namespace clothbench {

/// How a run fails, or nothing: how it ended if not well, else the first bound of its scene's `expect` that is broken
/// or not known, the same bounds that `verdict` uses. Where a scene expects nothing: cloth through a mesh, on
/// the wrong side of a hand or a vertex over 1 mm inside it, an edge of more than twice the length that hands impose,
/// or a strip pulled by bars whose greatest strain is in any frame more than a tenth of v0/c (what one wave brings) off
/// the exact one. "–" where that hangs on what must not be printed.
std::string leak_of(const std::string& kind, const RunRecord&);

/// The same scene at several imposed speeds, run by one solver.
struct SpeedSweep {
  std::string kind, scene;  ///< kind as in ContactSetUp; scene without the labels of its speeds
  Series series;
  struct At {
    double speed_m_per_s;
    std::string leak;
  };
  std::vector<At> speeds;  ///< ascending

  /// The first speed with a leak; one of "–" where it is not known whether that speed has one.
  std::optional<At> failure_speed() const;
  std::vector<const RunRecord*> runs = {};
};

/// Scenes at three or more speeds (`imposed_speed_m_per_s`), by the name in their file and what touches the cloth;
/// runs that are not supported and solvers that touch nothing are left out. In the order of the set-ups.
std::vector<SpeedSweep> speed_sweeps(const std::vector<ContactSetUp>&);

/// Rows: swept scenes; columns: solvers; entries: speed of the failure speed, or up to which there was none.
Table leak_table(const std::vector<SpeedSweep>&);

nlohmann::json leak_json(const std::vector<SpeedSweep>&);

}  // namespace clothbench
