// What is drawn of which data, as Vega-Lite specifications.
import {select} from './dom.js';
import {plot_figure} from './plot.js';
import {palette} from './theme.js';

const kSides = {domain: ['single', 'double-duplicated', 'double', 'not stated'], dash: [[1, 0], [6, 4], [2, 3], [1, 0]], shape: ['circle', 'square', 'triangle-up', 'circle']};
const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'error'];
const is_floor = s => s.solver === 'ballistic';  // what the harness itself costs: no cloth solver
const unique = list => [...new Set(list)];
const colour = (labels, theme, title = null) => {
  const colours = palette(labels, theme);
  return {field: 'label', type: 'nominal', title, scale: {domain: labels, range: labels.map(l => colours[l])}};
};
const picked = {params: [{name: 'pick', select: {type: 'point', fields: ['label']}, bind: 'legend'}]};
const fade = {condition: {param: 'pick', value: 1, empty: true}, value: 0.1};

/// Ticks of a logarithmic axis: powers of ten, and 2 and 5 times them where there would be few.
function decades(values) {
  const first = Math.floor(Math.log10(Math.min(...values))), last = Math.ceil(Math.log10(Math.max(...values))), out = [];
  for (let e = first; e <= last; ++e) for (const m of last - first > 2 ? [1] : [1, 2, 5]) out.push(Number(`${m}e${e}`));
  return out;
}

function rate_rows(family) {
  const rows = [];
  for (const s of family.series)
    for (const p of s.points)
      if (!is_floor(s)) rows.push({label: s.label, sides: s.sides || 'not stated', width: p.width, resolution: p.resolution, status: p.status, fps: p.fps,
        low: p.fps * (1 - (p.spread ?? 0)), high: p.fps * (1 + (p.spread ?? 0)), read: p.read_B_per_s, write: p.write_B_per_s});
  for (const s of family.published ?? [])
    for (const p of s.points)
      rows.push({label: `published: ${s.label}`, sides: kSides.domain.includes(s.sides) ? s.sides : 'not stated', width: p.width, resolution: `${p.width}²`, status: 'ok', fps: p.fps, low: p.fps, high: p.fps});
  return rows;
}

const width_axis = rows => ({field: 'width', type: 'quantitative', title: 'vertices along one side', scale: {type: 'log', base: 2, nice: false, padding: 14},
  axis: {values: unique(rows.map(r => r.width)).sort((a, b) => a - b), format: '.4~g', grid: false}});
const side_encoding = rows => {
  const used = kSides.domain.filter(s => rows.some(r => r.sides === s));
  const pick = list => used.map(s => list[kSides.domain.indexOf(s)]);
  const title = 'sides';
  return {strokeDash: {field: 'sides', type: 'nominal', title, scale: {domain: used, range: pick(kSides.dash)}},
    shape: {field: 'sides', type: 'nominal', title, scale: {domain: used, range: pick(kSides.shape)}}};
};

function rates_figure(family, index) {
  const all = rate_rows(family), good = all.filter(r => r.fps > 0), failed = all.filter(r => kFailed.includes(r.status));
  const labels = unique(all.map(r => r.label)), sides = side_encoding(all);
  const tip = [{field: 'label', title: 'solver'}, {field: 'sides'}, {field: 'resolution'}, {field: 'fps', format: ',.4~r', title: 'frames/s'}, {field: 'low', format: ',.4~r'}, {field: 'high', format: ',.4~r'}];
  const spec = (theme, width) => {
    const x = width_axis(all), color = colour(labels, theme);
    const y = {field: 'fps', type: 'quantitative', title: 'frames per second', scale: {type: 'log', nice: true}, axis: {format: '~s', values: decades([...good.map(r => r.fps), 72])}};
    return {width: width - 270, height: 360, data: {values: good}, layer: [
      {name: 'cap', data: {values: [{fps: 72}]}, mark: {type: 'rule', strokeDash: [3, 3]}, encoding: {y}},
      {name: 'cap_text', data: {values: [{fps: 72}]}, mark: {type: 'text', align: 'left', baseline: 'top', dx: 4, dy: 5, text: '72 Hz, the display'}, encoding: {x: {value: 0}, y}},
      {name: 'spread', mark: {type: 'rule', aria: false}, encoding: {x, y: {...y, field: 'low'}, y2: {field: 'high'}, color, opacity: fade}},
      {name: 'lines', mark: {type: 'line', strokeWidth: 1.8}, encoding: {x, y, color, strokeDash: sides.strokeDash, opacity: fade}},
      {name: 'points', ...picked, mark: {type: 'point', filled: true, size: 46}, encoding: {x, y, color, shape: sides.shape, opacity: fade, tooltip: tip}},
      {name: 'failed', data: {values: failed}, mark: {type: 'point', shape: 'cross', size: 60, filled: true, angle: 45}, encoding: {x, y: {value: 360}, color, tooltip: [{field: 'label'}, {field: 'resolution'}, {field: 'status'}]}},
    ]};
  };
  const paper = family.paper_table === 3;
  return plot_figure({id: `rates-${index}`, title: `${paper ? 'Fig. 4: ' : ''}Frames per second by resolution (${family.name})`, spec,
    caption: 'Uncapped, median of the trials; bars: half their range; a cross on the lower edge: a cell that failed. ' +
      (paper ? 'Grey: published (Quest 3, capped at 72 Hz, rendering included). ' : '') + 'Ballistic, the harness without a cloth model, is left out. Click a name to show it alone.',
    rows: () => [['solver', 'sides', 'width', 'fps', 'low', 'high', 'status'], ...all.map(r => [r.label, r.sides, r.width, r.fps, r.low, r.high, r.status])]});
}

function bandwidth_figure(family, index) {
  const rows = rate_rows(family).flatMap(r => [{...r, way: 'read', GB_per_s: r.read / 1e9}, {...r, way: 'written', GB_per_s: r.write / 1e9}]).filter(r => r.GB_per_s > 0);
  const labels = unique(rows.map(r => r.label)), sides = side_encoding(rows);
  const spec = (theme, width) => {
    const x = width_axis(rows), color = colour(labels, theme);
    const y = {field: 'GB_per_s', type: 'quantitative', title: 'GB/s', scale: {type: 'log'}, axis: {format: '~g', values: decades(rows.map(r => r.GB_per_s))}};
    return {data: {values: rows}, facet: {column: {field: 'way', title: null}}, spec: {width: (width - 330) / 2, height: 280, layer: [
      {name: 'lines', mark: {type: 'line', strokeWidth: 1.8}, encoding: {x, y, color, strokeDash: sides.strokeDash, opacity: fade}},
      {name: 'points', ...picked, mark: {type: 'point', filled: true, size: 46}, encoding: {x, y, color, shape: sides.shape, opacity: fade,
        tooltip: [{field: 'label', title: 'solver'}, {field: 'sides'}, {field: 'resolution'}, {field: 'way'}, {field: 'GB_per_s', format: '.4~g', title: 'GB/s'}]}}]}};
  };
  return plot_figure({id: `bandwidth-${index}`, title: `${family.paper_table === 3 ? 'Fig. 5: ' : ''}Peak bandwidth by resolution (${family.name})`, spec,
    empty: 'No cell has counted bytes.',
    caption: 'Counted bytes per second of wall time. CPU solvers are absent: their bytes are not counted, and never modelled. The paper’s values are published as a graph alone.',
    rows: () => [['solver', 'sides', 'width', 'way', 'GB_per_s'], ...rows.map(r => [r.label, r.sides, r.width, r.way, r.GB_per_s])]});
}

/// Points with nothing of the same solver both faster and more accurate, by the given clock.
function on_front(points, time) {
  return points.filter(p => !points.some(q => q.label === p.label && q[time] <= p[time] && q.error <= p.error && (q[time] < p[time] || q.error < p.error)));
}

function work_figure(diagrams) {
  let at = diagrams[0], clock = 'wall';
  let figure = null;
  const data = () => {
    const rows = at.points.map(p => ({label: p.solver, setting: p.setting, status: p.status, wall: p.wall_ms_per_s, error: p.error, stored_front: p.on_front,
      // A CPU has one clock.
      time: clock === 'wall' ? p.wall_ms_per_s : p.device_ms_per_s ?? p.wall_ms_per_s}));
    const good = rows.filter(r => r.status === 'ok' && r.error > 0 && r.time > 0);
    return {rows, good, front: clock === 'wall' ? good.filter(r => r.stored_front) : on_front(good, 'time'), failed: rows.filter(r => !good.includes(r) && r.status !== 'unsupported')};
  };
  const spec = (theme, width) => {
    const {rows, good, front, failed} = data(), labels = unique(rows.map(r => r.label)), color = colour(labels, theme);
    const floors = [{error: at.space_error, what: 'error of the mesh'}, {error: at.reference_uncertainty === null ? null : 3 * at.reference_uncertainty, what: '3 U_ref'}].filter(f => f.error > 0);
    const x = {field: 'time', type: 'quantitative', title: 'ms of computing per simulated second', scale: {type: 'log', padding: 10}, axis: {format: ',~r', values: decades(good.map(r => r.time).concat(1000))}};
    const y = {field: 'error', type: 'quantitative', title: at.ranking, scale: {type: 'log', padding: 10}, axis: {format: '.0e', values: decades(good.map(r => r.error).concat(floors.map(f => f.error)))}};
    const tip = [{field: 'label', title: 'solver'}, {field: 'setting'}, {field: 'time', format: '.4~r', title: 'ms/s'}, {field: 'error', format: '.3~e'}, {field: 'status'}];
    return {width: width - 190, height: 400, data: {values: good}, layer: [
      {name: 'floors', data: {values: floors}, mark: {type: 'rule', strokeDash: [5, 4]}, encoding: {y}},
      {name: 'floor_text', data: {values: floors}, mark: {type: 'text', align: 'right', baseline: 'bottom', dx: -4, dy: -2}, encoding: {x: {value: 'width'}, y, text: {field: 'what'}}},
      {name: 'real_time', data: {values: [{time: 1000}]}, mark: {type: 'rule', strokeDash: [2, 3]}, encoding: {x}},
      {name: 'fronts', data: {values: front}, mark: {type: 'line', strokeWidth: 2.6}, encoding: {x, y, color, opacity: fade}},
      {name: 'points', ...picked, mark: {type: 'point', size: 42}, encoding: {x, y, color, opacity: fade, tooltip: tip}},
      {name: 'front_points', data: {values: front}, mark: {type: 'point', filled: true, size: 46, aria: false}, encoding: {x, y, color, opacity: fade, tooltip: tip}},
      {name: 'failed', data: {values: failed}, mark: {type: 'point', shape: 'cross', angle: 45, filled: true, size: 50}, encoding: {x, y: {value: 0}, color, tooltip: tip}},
    ]};
  };
  const remark = () => [at.refused ? `Ranks nobody: ${at.refused}.` : '', ...Object.entries(at.not_ranked).map(([solver, why]) => `${solver} is shown but not ranked: ${why}.`)].filter(Boolean).join(' ');
  const words = d => d.refused ? `${d.scene} (refused)` : d.scene;
  figure = plot_figure({id: 'work', title: 'Error against run time', spec, remark,
    controls: [select('Scene', diagrams.map(d => ({value: d.scene, text: words(d)})), at.scene, v => { at = diagrams.find(d => d.scene === v); figure.redraw(); }),
      select('Clock', [{value: 'wall', text: 'wall, submit to fence'}, {value: 'device', text: 'GPU (CPU solvers: wall)'}], clock, v => { clock = v; figure.redraw(); })],
    caption: 'Every point a setting, thick each solver’s front; crosses on the upper edge: cells that failed, by their time where they have one. Dotted: real time (1000 ms/s). Hover for the setting.',
    rows: () => [['scene', 'solver', 'setting', 'status', 'ms_per_s', 'error', 'on_front'], ...data().rows.map(r => [at.scene, r.label, r.setting, r.status, r.time, r.error, r.stored_front])]});
  return figure;
}

const kMetricWords = {tunnelled_fraction: 'tunnelled share of the cloth', contact_length_m: 'contour [m]', tunnelled_depth_m: 'tunnelled depth [m]',
  depth_m: 'depth [m]', depth_vertex_m: 'depth at vertices [m]', stretch_max: 'greatest strain'};

function penetration_figure(ups) {
  const scenes = ups.flatMap(u => u.scenes.map(s => ({...s, kind: u.title})));
  let at = scenes[0], metric = '', figure = null;
  const metrics = () => Object.keys(kMetricWords).filter(m => at.rows.some(r => m in r.metrics));
  const choose = select('Metric', [], '', v => { metric = v; figure.redraw(); });
  const refill = () => {
    const list = metrics();
    // The first that shows something: most scenes are meant to be all zero.
    const shows = m => at.rows.some(r => r.solver !== 'ballistic' && r.metrics[m]?.values.some(v => v > 0));
    if (!list.includes(metric)) metric = list.find(shows) ?? list[0] ?? '';
    choose.querySelector('select').replaceChildren(...list.map(m => new Option(kMetricWords[m], m, m === metric, m === metric)));
  };
  const data = () => at.rows.filter(r => r.solver !== 'ballistic').flatMap(r => (r.metrics[metric]?.values ?? []).map((value, k) =>
    ({label: r.label, time: r.time_s[k], value, failed: kFailed.includes(r.status) && k === Math.min(r.failed_frame, r.time_s.length - 1)})).filter(d => d.value !== null));
  const spec = (theme, width) => {
    const rows = data(), labels = unique(at.rows.map(r => r.label).filter(l => !l.startsWith('ballistic'))), color = colour(labels, theme);
    const x = {field: 'time', type: 'quantitative', title: 'time [s]', axis: {tickCount: 10, grid: false}}, y = {field: 'value', type: 'quantitative', title: kMetricWords[metric], axis: {format: '~g', tickCount: 6}, ...(rows.some(r => r.value > 0) ? {} : {scale: {domain: [0, 1]}})};
    return {width: width - 220, height: 320, data: {values: rows}, layer: [
      {name: 'lines', mark: {type: 'line', strokeWidth: 1.8}, encoding: {x, y, color, opacity: fade}},
      {name: 'points', ...picked, mark: {type: 'point', filled: true, size: 50, aria: false}, encoding: {x, y, color, opacity: {value: 0},
        tooltip: [{field: 'label', title: 'solver'}, {field: 'time', format: '.3f', title: 's'}, {field: 'value', format: '.4~g', title: kMetricWords[metric]}]}},
      {name: 'failed', transform: [{filter: 'datum.failed'}], mark: {type: 'point', shape: 'cross', angle: 45, filled: true, size: 80}, encoding: {x, y, color}},
    ]};
  };
  refill();
  figure = plot_figure({id: 'penetration-series', title: 'Penetration over time', spec, empty: 'This scene has no such series.',
    controls: [select('Scene', scenes.map(s => ({value: s.name, text: s.name})), at.name, v => { at = scenes.find(s => s.name === v); refill(); figure.redraw(); }), choose],
    caption: 'One line a solver, one value a frame. A cross: where a run failed. Ballistic, which nothing stops, is left out.',
    rows: () => [['scene', 'metric', 'solver', 'time_s', 'value'], ...data().map(d => [at.name, metric, d.label, d.time, d.value])]});
  return figure;
}

/// {section id: figures}, for the sections that have data.
export function make_figures(doc) {
  return {
    rates: doc.rates.flatMap((family, k) => [rates_figure(family, k), bandwidth_figure(family, k)]),
    'work-precision': doc.work.length ? [work_figure(doc.work)] : [],
    penetration: doc.penetration.length ? [penetration_figure(doc.penetration)] : [],
  };
}
