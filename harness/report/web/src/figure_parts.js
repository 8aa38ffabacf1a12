// What several figures share. A figure is a description, which the page draws with controls and hover (plot.js) and the
// report as pictures (stills.js):
//   {id, title, caption, hint?, empty?, choices?, spec(theme, width, state), rows(state), remark?(state), stills}
// `caption` stands under both, `hint` on the page alone. `choices`: [{label, options(state), first?(state)}], the
// select boxes; `state` has the value of each by its label. `rows`: the data as a table, header first; with the header
// alone nothing is drawn. `stills`: the pictures, [{file, title, make(width), labels?, notes?, empty?}], in theme
// 'paper': `labels` of the legend, `notes` below, `empty`: words in place of a plot.
import {palette} from './theme.js';

export const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'error'];
export const kCross = {
  type: 'point',
  shape: 'cross',
  angle: 45,
  filled: true,
  size: 60
};
export const unique = list => [...new Set(list)];
export const colour = (labels, theme, title = null) => {
  const colours = palette(labels, theme);
  return {field: 'label', type: 'nominal', title, scale: {domain: labels, range: labels.map(l => colours[l])}};
};
/// Distinguishes labels without colour, by symbols or dashes, in the legend of the colours.
const by_label = range => labels => ({
  field: 'label',
  type: 'nominal',
  title: null,
  scale: {domain: labels, range: labels.map((_, k) => range[k % range.length])}
});
export const symbols = by_label(
    ['circle', 'square', 'triangle-up', 'diamond', 'triangle-down', 'cross', 'triangle-right', 'triangle-left']);
export const dashes = by_label([[1, 0], [7, 3], [2, 2], [7, 2, 2, 2], [4, 1]]);
export const picked = theme =>
    theme === 'paper' ? {} : {params: [{name: 'pick', select: {type: 'point', fields: ['label']}, bind: 'legend'}]};
export const fade = theme =>
    theme === 'paper' ? {value: 1} : {condition: {param: 'pick', value: 1, empty: true}, value: 0.1};
/// Width that is left beside a legend. On paper the legend is below.
export const beside = (theme, width, legend) => theme === 'paper' ? width : width - legend;

/// The harness without a cloth model is decades faster than every solver. It is drawn only if no other solver is.
let floor = [];
export const set_floor = solvers => floor = solvers;
export const is_floor = row => floor.includes(row.solver);
export const without_floor = rows => rows.every(is_floor) ? rows : rows.filter(r => !is_floor(r));

/// The devices, for a figure that is shown without its report.
export const device_note = points => unique(points.map(p => p.gpu).filter(Boolean)).sort().join(', ');
/// A valid file name for any scene.
export const still_name = name => name.replace(/[^A-Za-z0-9._=-]+/g, '-');

/// Pareto front of each label: points that no point of the same label dominates in both keys.
export const on_front = (points, a, b) => points.filter(
    p => !points.some(q => q.label === p.label && q[a] <= p[a] && q[b] <= p[b] && (q[a] < p[a] || q[b] < p[b])));

/// Number of panels side by side, at most `most`; without gaps in the last row if possible.
export function across_of(panels, most) {
  for (let n = Math.min(most, panels); n > 1; --n)
    if (panels % n === 0) return n;
  return Math.max(1, Math.min(most, panels));
}

/// A logarithmic axis with ticks at the decades of `values`. `scale` and `axis`: more than that.
export const log_axis = (field, title, values, {scale = {}, axis = {}} = {}) => ({
  field,
  type: 'quantitative',
  title,
  scale: {type: 'log', ...scale},
  axis: {format: '~g', values: decades(values), ...axis}
});

/// Ticks of a logarithmic axis: powers of ten; also 2 and 5 times them on short axes; every other one on long axes.
function decades(values) {
  const first = Math.floor(Math.log10(Math.min(...values))), last = Math.ceil(Math.log10(Math.max(...values))),
        out = [];
  for (let e = first; e <= last; e += last - first > 8 ? 2 : 1)
    for (const m of last - first > 2 ? [1] : [1, 2, 5]) out.push(Number(`${m}e${e}`));
  return out;
}
