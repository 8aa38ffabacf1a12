#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/penetration.hpp"

namespace clothbench {

/// Why a run fails; empty if it does not. Its status if it did not end well; otherwise the first bound of its scene's
/// `expect` that is broken or not known, the same bounds that `verdict` uses. Without bounds, by kind of scene: cloth
/// through a mesh; cloth on the wrong side of a hand or a vertex more than 1 mm inside it; an edge more than twice as
/// long as hands impose; in a strip pulled by bars, greatest strain off the exact one by more than a tenth of v0/c (the
/// strain of one wave) in any frame. "–" if the answer depends on a withheld value.
std::string leak_of(const std::string& kind, const RunRecord&);

/// Runs of one scene by one solver at several imposed speeds.
struct SpeedSweep {
  std::string kind, scene;  ///< kind as in ContactSetUp; scene without the labels of its speeds
  Series series;
  struct At {
    double speed_m_per_s;
    std::string leak;
  };
  std::vector<At> speeds;  ///< ascending

  /// The lowest speed with a leak, or with "–" if it is not known whether that speed has one.
  std::optional<At> failure_speed() const;
  /// The least number of runs at one speed.
  std::size_t paths() const;
  std::vector<ContactRow> runs = {};
};

/// Scenes at three or more speeds (`imposed_speed_m_per_s`), grouped by scene name, kind of set-up and solver, in the
/// order of the set-ups. Unsupported runs and solvers that ignore contact are left out.
std::vector<SpeedSweep> speed_sweeps(const std::vector<ContactSetUp>&);

/// Rows: swept scenes, below a row of the distances at which solvers hold the cloth; columns: solvers; entries: failure
/// speed, or the greatest speed if none failed.
Table leak_table(const std::vector<SpeedSweep>&);

nlohmann::json leak_json(const std::vector<SpeedSweep>&);

}  // namespace clothbench
