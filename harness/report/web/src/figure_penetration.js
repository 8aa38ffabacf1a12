// Penetration over time.
import {across_of, beside, colour, dashes, fade, kCross, kFailed, picked, still_name, unique, without_floor} from './figure_parts.js';

/// Title of the axis, and the factor from SI to its unit.
const kMetrics = {
  contact_length_m: ['contour [mm]', 1e3],
  depth_m: ['depth [mm]', 1e3],
  stretch_max: ['greatest strain [%]', 100]
};
/// The metrics that distinguish solvers, by set-up. A metric that no run has is not drawn.
const kShown = {
  rooms: ['contact_length_m', 'depth_m'],
  hand: ['contact_length_m', 'depth_m'],
  capsules: ['contact_length_m', 'depth_m'],
  shapes: ['contact_length_m', 'depth_m'],
  grip: ['stretch_max'],
  wave: ['stretch_max']
};
const kDeep_mm =
    50;  // from here on an axis of depth is logarithmic above 1 mm, since a cloth that fell through keeps falling

function series_rows(scene, metric) {
  return without_floor(scene.rows)
      .flatMap(
          r => (r.metrics[metric]?.values ?? [])
                   .map(
                       (value, k) =>
                           ({label: r.label, time: r.time_s[k], raw: value, value: kMetrics[metric][1] * value}))
                   .filter(d => d.raw !== null));
}

/// Where runs of a scene failed: the time of the last frame.
const failed_rows = scene => without_floor(scene.rows)
                                 .filter(r => kFailed.includes(r.status))
                                 .map(r => ({label: r.label, time: r.time_s.at(-1) ?? 0, status: r.status}));

function panel(scene, metric, labels, theme, width, height) {
  const rows = series_rows(scene, metric), most = Math.max(0, ...rows.map(r => r.value)), title = kMetrics[metric][0];
  const x = {
    field: 'time',
    type: 'quantitative',
    title: 'time [s]',
    axis: {tickCount: theme === 'paper' ? 4 : 10, grid: false}
  };
  const log = /depth/.test(metric) && most > kDeep_mm, top = most > 1e-3 ? 1.04 * most : 1;
  const legend = {symbolType: 'stroke', symbolSize: 500};
  const color = {...colour(labels, theme), legend};
  const y = {
    field: 'value',
    type: 'quantitative',
    title,
    // A line at 0 must be distinguished from the axis.
    scale: log ? {type: 'symlog', constant: 1, domain: [-0.15, 1.1 * most]} : {domain: [-0.04 * top, top], nice: false},
    axis: {
      format: '.6~g',
      ...(log ? {values: [0, 1, 10, 100, 1e3, 1e4, 1e5].filter(v => v <= 10 * most)} :
                {tickCount: theme === 'paper' ? 4 : 6})
    }
  };
  return {
    width,
    height,
    data: {values: rows},
    layer: [
      {
        name: 'lines',
        mark: {type: 'line', strokeWidth: theme === 'paper' ? 1.4 : 1.8},
        encoding: {x, y, color, strokeDash: {...dashes(labels), legend}, opacity: fade(theme)}
      },
      // For hover alone.
      ...(theme === 'paper' ? [] : [{
        name: 'points',
        ...picked(theme),
        mark: {type: 'point', filled: true, size: 50, aria: false},
        encoding: {
          x,
          y,
          color,
          opacity: {value: 0},
          tooltip: [
            {field: 'label', title: 'solver'}, {field: 'time', format: '.3f', title: 's'},
            {field: 'value', format: '.4~g', title}
          ]
        }
      }]),
      {name: 'failed', data: {values: failed_rows(scene)}, mark: kCross, encoding: {x, y: {value: height}, color}},
    ]
  };
}

const labels_of = scenes => unique(scenes.flatMap(s => without_floor(s.rows)).map(r => r.label)).sort();

/// A row of panels a scene; scenes of one metric share a row.
function still(up) {
  const file = still_name(`penetration-${up.kind}`), title = `${up.title}: penetration over time`;
  const metrics = (kShown[up.kind] ?? Object.keys(kMetrics)).filter(m => up.scenes.some(s => series_rows(s, m).length));
  const labels = labels_of(up.scenes), failed = up.scenes.some(s => failed_rows(s).length);
  if (!metrics.length) return {file, title, empty: 'No run of this set-up was measured.'};
  const across = metrics.length > 1 ? metrics.length : across_of(up.scenes.length, 3);
  const panels =
      up.scenes.flatMap(scene => metrics.map((metric, k) => ({scene, metric, heading: k ? '' : scene.name})));
  const make = width => ({
    columns: across,
    concat: panels.map(({scene, metric, heading}, k) => {
      const p = panel(scene, metric, labels, 'paper', Math.max(130, width / across - 50), 90);
      for (const layer of p.layer) {
        layer.name += `_${k}`;  // names must be unique
        // The time stands below the lowest row.
        if (k + across < panels.length) layer.encoding.x = {...layer.encoding.x, title: null};
      }
      return {...p, title: heading ? {text: heading, anchor: 'start', fontWeight: 'bold'} : null};
    })
  });
  return {file, title, labels, notes: [failed ? '×: time at which a run failed' : ''], make};
}

export function penetration_figure(ups) {
  const scenes = ups.flatMap(u => u.scenes), named = Object.fromEntries(scenes.map(s => [s.name, s]));
  const at = state => named[state.Scene];
  const metrics = scene => Object.keys(kMetrics).filter(m => scene.rows.some(r => m in r.metrics));
  // The first metric with a value above 0: most scenes expect zeros.
  const first = scene => metrics(scene).find(m => series_rows(scene, m).some(d => d.value > 0));
  const rows = state => state.Metric ? series_rows(at(state), state.Metric) : [];
  return {
    id: 'penetration-series',
    title: 'Penetration over time',
    spec: (theme, width, state) =>
        panel(at(state), state.Metric, labels_of([at(state)]), theme, beside(theme, width, 220), 320),
    empty: 'No run of this scene has this metric.',
    choices: [
      {label: 'Scene', options: () => scenes.map(s => ({value: s.name, text: s.name}))}, {
        label: 'Metric',
        options: state => metrics(at(state)).map(m => ({value: m, text: kMetrics[m][0]})),
        first: state => first(at(state))
      }
    ],
    caption: 'One line for each solver, one value for each frame. A cross on the lower edge marks the time at ' +
        'which a run failed. Ballistic, which handles no contact, is not drawn.',
    rows: state => [
        ['scene', 'metric', 'solver', 'time_s', 'value'],
        ...rows(state).map(d => [state.Scene, state.Metric, d.label, d.time, d.raw])],
    stills: ups.map(still)
  };
}
