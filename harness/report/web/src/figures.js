// Which figures stand in which section.
import {set_floor} from './figure_parts.js';
import {penetration_figure} from './figure_penetration.js';
import {bandwidth_figure, rates_figure} from './figure_rates.js';
import {cases_figure, stability_figure} from './figure_stability.js';
import {stretch_figure} from './figure_stretch.js';
import {work_figure} from './figure_work.js';
import {ask_colours} from './theme.js';

/// Bytes are known of GPU solvers alone.
const on_gpu = family => family.series.some(s => s.points.some(p => p.gpu));

/// {section id: figures} for the sections that have data; `rates` has one list per family. Figs. 4 and 5 are those of
/// the paper's table if it was run, else those of the first family.
export function make_figures(doc) {
  set_floor(doc.solvers.floor);
  ask_colours(doc.solvers.colours);
  const main = doc.rates.find(f => f.paper_table === 3) ?? doc.rates[0];
  const file = (family, name) => family === main ? name : null;
  return {
    rates: doc.rates.map(
        (family, k) => [rates_figure(family, k, file(family, 'fig4')),
                        on_gpu(family) ? bandwidth_figure(family, k, file(family, 'fig5')) : null,
                        stretch_figure(family, k)]
                           .filter(Boolean)),
    'work-precision': doc.work.length ? [work_figure(doc.work)] : [],
    penetration: doc.penetration.length ? [penetration_figure(doc.penetration)] : [],
    stability: [
      ...(doc.cases.length ? [cases_figure(doc.cases)] : []), ...(doc.maps.length ? [stability_figure(doc.maps)] : [])
    ],
  };
}
