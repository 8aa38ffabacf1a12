#pragma once
#include "runner/stability_study.hpp"

namespace clothbench {

/// With `resume`: throws Error naming the file if stored probes are of other scenes, definitions or versions of
/// solvers.
void require_same_maps(const Study&, const StabilityOptions&);

/// Runs the study's maps: for every row (y) and solver the values of x in order, then the boundary by bisection, for
/// every seed. Each probe is a run in a RunWorker process. Its answer is appended to stability-probes.jsonl; with
/// `resume` stored answers are read back instead of run again. Writes stability.json after every row:
///   {maps: [{name, title, scene, good, headline, x: {label, unit}, y: {label, unit},
///            theory: [{name, label, points: [[x, y]]}],
///            solvers: [{solver, setting, on_gpu, unsupported, probes: [{x, y, seed, status, class, grade, frame,
///                       message}],
///                       rows: [{y, seeds: [{last_good, first_bad}]}], largest, open}]}]}
/// `largest` is the least `last_good` over rows and seeds. `open` means that no row has a boundary. first_bad null
/// means that no value is bad.
StabilityCounts run_stability_maps(const Study&, const StabilityOptions&);

}  // namespace clothbench
