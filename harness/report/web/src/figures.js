// Which figures stand in which section.
import {penetration_figure} from './figure_penetration.js';
import {bandwidth_figure, rates_figure} from './figure_rates.js';
import {stability_figure} from './figure_stability.js';
import {work_figure} from './figure_work.js';

/// {section id: figures}, for the sections that have data.
export function make_figures(doc) {
  return {
    rates: doc.rates.flatMap((family, k) => [rates_figure(family, k), bandwidth_figure(family, k)]),
    'work-precision': doc.work.length ? [work_figure(doc.work)] : [],
    stability: doc.maps.length ? [stability_figure(doc.maps)] : [],
    penetration: doc.penetration.length ? [penetration_figure(doc.penetration)] : [],
  };
}
