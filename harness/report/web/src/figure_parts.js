// What several figures share.
import {palette} from './theme.js';

export const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'error'];
export const unique = list => [...new Set(list)];
export const colour = (labels, theme, title = null) => {
  const colours = palette(labels, theme);
  return {field: 'label', type: 'nominal', title, scale: {domain: labels, range: labels.map(l => colours[l])}};
};
export const picked = {
  params: [{name: 'pick', select: {type: 'point', fields: ['label']}, bind: 'legend'}]
};
export const fade = {
  condition: {param: 'pick', value: 1, empty: true},
  value: 0.1
};

/// Ticks of a logarithmic axis: powers of ten, and 2 and 5 times them where there would be few.
export function decades(values) {
  const first = Math.floor(Math.log10(Math.min(...values))), last = Math.ceil(Math.log10(Math.max(...values))),
        out = [];
  for (let e = first; e <= last; ++e)
    for (const m of last - first > 2 ? [1] : [1, 2, 5]) out.push(Number(`${m}e${e}`));
  return out;
}
