// Parts that the Vega-Lite specs of several figures share. `look`: {solvers, width, shrink, paper?} of draw.js.
import {kSymbols, unique} from './look.js';

const kDashes = [[1, 0], [6, 3], [2, 3], [8, 3, 2, 3], [1, 2], [12, 4], [12, 3, 2, 3, 2, 3], [5, 6]];

/// Ticks of a logarithmic axis: powers of ten, and on short axes also multiples of them.
function decades([low, high]) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high)), step = Math.ceil((last - first) / 8);
  const powers = Array.from({length: Math.floor((last - first) / step) + 1}, (_, k) => first + k * step);
  const ticks = multiples => powers.flatMap(e => multiples.map(m => Number(`${m}e${e}`)).filter(t => t >= low && t <= high));
  return [[1], [1, 2, 5], [1, 1.5, 2, 3, 4, 5, 6, 8]].map(ticks).find((t, k) => t.length > 3 || k === 2);
}

/// Logarithmic channel of a field, with room for all of `values`.
export function log(field, title, values, axis) {
  const positive = values.filter(v => v > 0 && v < Infinity), [low, high] = positive.length ? [Math.min(...positive), Math.max(...positive)] : [1, 10];
  const room = low === high ? 2 : (high / low) ** 0.04, domain = [low / room, high * room];
  return {field, type: 'quantitative', title, scale: {type: 'log', nice: false, domain}, axis: {grid: true, values: decades(domain), labelExpr: 'number(datum.value)', ...axis}};
}

export const band = (field, values, {width}) => ({field, type: 'nominal', title: null, sort: null, scale: {domain: values}, axis: {grid: false, labelOverlap: 'greedy', labelLimit: Math.min(220, 0.5 * width)}});

/// A legend with as many columns as there is room for.
export function legend(names, look, more) {
  const sum = list => list.reduce((a, b) => a + b, 0), room = (_, k) => 36 + 7.2 * Math.max(...names.filter((_, n) => n % columns === k).map(n => n.length));
  let columns = names.length;
  while (columns > 1 && sum(names.slice(0, columns).map(room)) > look.width) --columns;
  return {columns, labelLimit: 0, ...more};
}

/// Stroke, fill and shape by solver. `hollow`: condition for an outline. Has a legend on paper; on the page plot.js adds one.
export function by_solver(rows, look, hollow = 'false') {
  const solvers = unique(rows.map(r => r.solver)), key = look.paper ? legend(solvers, look) : null;
  const channel = of => ({field: 'solver', type: 'nominal', scale: {domain: solvers, range: solvers.map(s => of(look.solvers[s]))}, legend: key});
  const colour = channel(l => l.colour);
  return {stroke: colour, fill: {...colour, condition: {test: hollow, value: 'var(--back)'}}, shape: channel(l => kSymbols[l.symbol])};
}

export const symbols = encoding => ({mark: 'point', encoding});
export const interval = (low, high, {mark, ...encoding}) => ({transform: [{filter: `datum.${high} > datum.${low}`}], mark: {type: 'rule', ...mark}, encoding});

/// Dashed lines at values of an axis; a zone also shades the figure below its line. `name(k)`: the place of a line's name.
export const rules = (list, channel, axis, name) => list.flatMap(({at, text, zone}, k) => {
  const data = {values: [{}]}, encoding = {[channel]: {...axis, field: undefined, datum: at}};
  return [
    ...(zone ? [{data, mark: {type: 'rect', fill: 'var(--soft)', fillOpacity: 0.1}, encoding: {...encoding, y2: {value: 'height'}}}] : []),
    {data, mark: {type: 'rule', stroke: 'var(--soft)', strokeWidth: 1, strokeDash: [4, 3]}, encoding},
    ...(name ? [{data, mark: {type: 'text', text, ...name(k)}, encoding}] : [])
  ];
});

/// Lines through the rows with the same `line`, rules of both axes, and the names of all, which draw.js places so that they cover
/// none of the marks of `all` rows.
export function lines(rows, x, y, {stroke, fill: {condition, ...fill}}, look, {x: across = [], y: along = []}, all = rows) {
  const names = unique(rows.map(r => r.line)), of = name => rows.filter(r => r.line === name).sort((a, b) => a[x.field] - b[x.field]);
  const solver = name => rows.find(r => r.line === name).solver, dash = name => names.filter(n => solver(n) === solver(name)).indexOf(name);
  const range = names.map(n => kDashes[dash(n) % kDashes.length]);
  const between = (a, b, n) => (a ** (1 - n)) * (b ** n), steps = Array.from({length: 6}, (_, n) => n / 6);
  const taken = names.flatMap(n => of(n).slice(1).flatMap((b, k) => steps.map(s => [between(of(n)[k][x.field], b[x.field], s), between(of(n)[k][y.field], b[y.field], s)])));
  const place = (a, b, more) => ({name: '', solver: '', [x.field]: a, [y.field]: b, ...more}), ruled = (a, b, {text, zone}, dy) => place(a, b, {name: text, dy: zone ? -dy : dy});
  const values = [
    ...names.map(n => place(of(n).at(-1)[x.field], of(n).at(-1)[y.field], {name: n, solver: solver(n)})), ...all.map(r => place(r[x.field], r[y.field], {mark: true})), ...taken.map(p => place(...p)),
    ...along.map(r => ruled(x.scale.domain[0], r.at, r, -9)), ...across.map(r => ruled(r.at, y.scale.domain[1], r, 6))
  ];
  return [
    ...rules(along, 'y', y), ...rules(across, 'x', x),
    {data: {values: rows}, mark: 'line', encoding: {x, y, stroke, detail: {field: 'line'}, ...(names.some(dash) && {strokeDash: {field: 'line', type: 'nominal', scale: {domain: names, range}, legend: null}})}},
    {name: 'names', data: {values}, mark: {type: 'text', fontWeight: {expr: "datum.solver ? 'bold' : 'normal'"}, fontSize: 12}, encoding: {x, y, text: {field: 'name'}, fill: {...fill, condition: {test: '!datum.solver', value: 'var(--soft)'}}}}
  ];
}

/// One panel per value of a field, each at least `least` wide. The first panel of a row shows the names of the shared band.
export function panels(values, least, bands, look, panel) {
  const gutter = Math.min(0.42 * look.width, 14 + 7 * Math.max(...bands.map(b => b.length))), free = look.width - gutter;
  const rows = Math.ceil(values.length / Math.max(1, Math.floor(free / least))), columns = Math.ceil(values.length / rows), width = free / columns - 28;
  const axis = {...band('', bands, look).axis, minExtent: gutter, maxExtent: gutter, labelLimit: gutter - 6}, all = values.map((v, k) => panel(v, {...band('', bands, look), axis: k % columns ? null : axis}));
  const row = all[0].layer[0].encoding.x.title ? 62 : 46;
  return {columns, bounds: 'flush', spacing: {row, column: 28}, concat: all.map(p => ({...p, width, title: {...p.title, limit: width + 24}})), resolve: {scale: {stroke: 'shared', fill: 'shared', shape: 'shared'}}};
}
