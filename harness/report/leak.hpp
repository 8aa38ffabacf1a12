#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/penetration.hpp"

namespace clothbench {

/// What of a cell is a leak, or nothing: how it ended if not well; cloth through a mesh; cloth on the wrong side of a hand or
/// a vertex over 1 mm inside it; an edge beyond 1.25 times what hands impose while they pull, 1.10 times once they hold, or
/// a mean strain of over 1 % a second after they let go; of a strip pulled by bars, a greatest strain that is in any frame more than
/// a tenth of v0/c (what one wave brings) off the exact one. A value that is not known where it should be is a leak too.
std::string leak_of(const std::string& kind, const CellRecord&);

/// The same scene at several imposed speeds, run by one solver.
struct SpeedSweep {
  std::string kind, scene;  ///< kind as in ContactSetUp; scene without the labels of its speeds
  Series series;
  struct At {
    double speed_m_per_s;
    std::string leak;
  };
  std::vector<At> speeds;  ///< ascending

  /// The first speed with a leak.
  std::optional<At> first_leak() const;
};

/// Scenes at three or more speeds (`imposed_speed_m_per_s`), by the name in their file and what touches the cloth; cells that are
/// not supported and solvers that touch nothing are left out. In the order of the set-ups.
std::vector<SpeedSweep> speed_sweeps(const std::vector<ContactSetUp>&);

/// Rows: swept scenes; columns: solvers; entries: speed of the first leak, or up to which there was none.
Table leak_table(const std::vector<SpeedSweep>&);

nlohmann::json leak_json(const std::vector<SpeedSweep>&);

}  // namespace clothbench
