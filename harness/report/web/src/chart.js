// The one drawing of all figures: a chart becomes the text of an SVG, on the page and on paper.
//   {panels, columns? of panels, height? or row? (of a band), right? (room for labels), tones? [[tone, meaning]]}
// Several panels share a band axis y. A panel: {title?, solver?, x, y, marks, lines?, rules?}. An axis: {title, type: 'log', 'linear' (states its domain and ticks)
// or 'band', values? of a band, domain?, ticks?, format?, text? of a band's value}. A mark: {x, y, row (with its solver), kind: 'point', 'cell', 'failed'
// (at the upper edge) or 'none', open?, low?, high? (interval along `along`, 'x' or 'y'), thick? [low, high], shift? (in bands),
// tone? and shape? (instead of the solver's), glyph?, note?}. A line: {solver, points: [[x, y]], dash?, label? (at one of its ends)}. Rules: [{x or y, text, zone?}].

export const unique = list => [...new Set(list)];
/// Domain of a logarithmic axis that several panels share.
export const span = values => [Math.min(...values) / 1.2, Math.max(...values) * 1.2];
export const escape = text => String(text).replace(/[&<>"]/g, c => `&#${c.charCodeAt(0)};`);

export const paper_widths = {'': 238, '-wide': 493};  // points: 84 mm for one column of text, 174 mm for two
const kPaperHeight = 311;                             // points: 110 mm
const kDashes = ['', '6 3', '2 3', '8 3 2 3', '1 2', '12 4', '12 3 2 3 2 3', '5 6'];
const kSample = 36;     // length of a line in the legend
const kMostLabels = 4;  // lines of one panel that have their names at their ends; more have them in the legend
const kMost = 1e4;  // the minimum is 1e-3: other numbers are printed with a power of ten

/// "0.0012", "12.5", "4.5·10⁻⁷"; "–" for what is not a number.
export function number(v, digits = 3) {
  if (v === null || v === undefined || !Number.isFinite(Number(v))) return '–';
  if (v === 0) return '0';
  const size = Math.abs(v);
  if (size < kMost && size >= 1e-3) return String(Number(v.toPrecision(digits)));
  const [mantissa, exponent] = v.toExponential(digits - 1).split('e');
  const power = '10' + [...String(Number(exponent))].map(c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]).join('');
  return Number(mantissa) === 1 ? power : `${Number(mantissa)}·${power}`;
}

/// Ticks of a logarithmic axis: powers of ten, and on short axes also multiples of them.
function decades(low, high) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high)), step = Math.ceil((last - first) / 8);
  const powers = Array.from({length: Math.floor((last - first) / step) + 1}, (_, k) => first + k * step);
  const ticks = multiples => powers.flatMap(e => multiples.map(m => Number(`${m}e${e}`)).filter(t => t >= low && t <= high));
  return [[1], [1, 2, 5], [1, 1.5, 2, 3, 4, 5, 6, 8]].map(ticks).find((t, k) => t.length > 3 || k === 2);
}

/// {at(value), ticks, text(tick)} of an axis with these data over a range in pixels.
function scale_of(axis, data, from, to) {
  if (axis.type === 'band') {
    const step = (to - from) / Math.max(axis.values.length, 1), place = new Map(axis.values.map((v, k) => [v, from + (k + 0.5) * step]));
    return {at: v => place.get(v), ticks: axis.values, text: axis.text ?? String, step: Math.abs(step)};
  }
  const log = axis.type === 'log', values = data.filter(v => v > 0 && v < Infinity);
  const [least, most] = values.length ? [Math.min(...values), Math.max(...values)] : [1, 10], room = least === most ? 2 : (most / least) ** 0.04;
  const [low, high] = axis.domain ?? [least / room, most * room], f = log ? Math.log : v => v;
  return {
    at: v => from + (f(v) - f(low)) / (f(high) - f(low)) * (to - from),
    ticks: (axis.ticks ?? decades(low, high)).filter(t => t >= low && t <= high),
    text: axis.format ?? number
  };
}

const kPaths = {
  square: 'M-4 -4H4V4H-4Z',
  up: 'M0 -5.2L4.8 3.6H-4.8Z',
  down: 'M0 5.2L4.8 -3.6H-4.8Z',
  diamond: 'M0 -5.4L5.4 0L0 5.4L-5.4 0Z',
  right: 'M5.2 0L-3.6 4.8V-4.8Z',
  left: 'M-5.2 0L3.6 4.8V-4.8Z',
  x: 'M-4 -4L4 4M-4 4L4 -4',
  plus: 'M0 -5V5M-5 0H5',
  star: 'M0 -5.5L1.6 -1.8L5.4 -1.6L2.4 0.9L3.4 4.7L0 2.6L-3.4 4.7L-2.4 0.9L-5.4 -1.6L-1.6 -1.8Z',
  hexagon: 'M-2.6 -4.5H2.6L5.2 0L2.6 4.5H-2.6L-5.2 0Z',
  circle: 'M-4.4 0a4.4 4.4 0 1 0 8.8 0a4.4 4.4 0 1 0 -8.8 0Z',
  ring: 'M-4.4 0a4.4 4.4 0 1 0 8.8 0a4.4 4.4 0 1 0 -8.8 0ZM-1.2 0a1.2 1.2 0 1 0 2.4 0a1.2 1.2 0 1 0 -2.4 0Z'
};
const px = v => Number(v.toFixed(1));

/// The symbol of a solver: filled, or as an outline filled with the page's colour.
export function symbol(look, solver, x, y, open = false, more = '') {
  const colour = look.colour(solver), size = look.symbol_scale;
  return `<path class="mark" d="${kPaths[look.symbol(solver)]}" transform="translate(${px(x)} ${px(y)})${
      size === 1 ? '' : ` scale(${size})`}" style="stroke:${colour};fill:${open ? 'var(--back)' : colour};stroke-width:1.6"${more}/>`;
}

const text = (look, x, y, words, {anchor = 'start', colour = 'var(--soft)', bold = false, rotate = 0, size = look.size} = {}) =>
    `<text x="${px(x)}" y="${px(y)}" text-anchor="${anchor}" font-size="${size}" style="fill:${colour}"${bold ? ' font-weight="600"' : ''}${
        rotate ? ` transform="rotate(${rotate} ${px(x)} ${px(y)})"` : ''}>${escape(words)}</text>`;
const line = (d, colour, more = '') => `<path d="${d}" style="stroke:${colour};fill:none"${more}/>`;
const dashed = (look, l) => ` stroke-width="${look.stroke}" stroke-linejoin="round"${l.dash ? ` stroke-dasharray="${kDashes[l.dash % kDashes.length]}"` : ''}`;

/// A filled box; "ignored" also has a diagonal, because its grey resembles another one.
const toned_box = (tone, x, y, w, h, more = '') =>
    `<rect x="${px(x)}" y="${px(y)}" width="${px(w)}" height="${px(h)}" rx="2" style="fill:var(--${tone})"${more}/>${
        tone === 'ignored' ? line(`M${px(x)} ${px(y + h)}L${px(x + w)} ${px(y)}`, 'var(--soft)', ' pointer-events="none"') : ''}`;

function draw_axes(look, panel, x, y, box, first) {
  const {left, right, top, bottom} = box;
  let out = '';
  const wide = panel.x.type === 'band' ? x.step : 0;
  let last = -Infinity;
  for (const [k, t] of x.ticks.entries()) {
    if (wide && k % Math.ceil(0.95 * look.size / wide) !== 0) continue;
    const at = x.at(t), words = x.text(t), half = words.length * look.size * 0.28;
    if (!wide) {
      out += line(`M${px(at)} ${top}V${bottom}`, 'var(--line)');
      if (at - half < last + 4) continue;
      last = at + half;
    }
    const upright = wide && panel.x.values.some(v => wide < x.text(v).length * look.size * 0.56);
    out += upright ? text(look, at + look.size / 3, bottom + 7, words, {anchor: 'end', rotate: -90, size: look.small}) :
                     text(look, at, bottom + look.size + 4, words, {anchor: 'middle'});
  }
  if (panel.x.title) out += text(look, right, bottom + 2 * look.size + 9, panel.x.title, {anchor: 'end', colour: 'var(--ink)'});
  if (panel.y.type !== 'band')
    for (const t of y.ticks) {
      out += line(`M${left} ${px(y.at(t))}H${right}`, 'var(--line)');
      out += text(look, left - 6, y.at(t) + look.size / 3, y.text(t), {anchor: 'end'});
    }
  else if (first)
    for (const [k, v] of y.ticks.entries())
      if (k % Math.ceil(0.95 * look.size / y.step) === 0)
        out += text(look, left - 8, y.at(v) + look.size / 3, y.text(v), {anchor: 'end'});
  if (panel.y.title) out += text(look, left - look.gutter + 2, top - 8 * look.unit, panel.y.title, {colour: 'var(--ink)'});
  return out;
}

function draw_rules(look, panel, x, y, {left, right, top, bottom}) {
  let out = '', last = -Infinity, row = 0;
  for (const r of panel.rules ?? []) {
    const on_x = 'x' in r, at = on_x ? x.at(r.x) : y.at(r.y);
    if (!(at >= (on_x ? left : top) - 1 && at <= (on_x ? right : bottom) + 1)) continue;
    if (r.zone) out += `<path d="M${left} ${px(at)}H${right}V${bottom}H${left}Z" style="fill:var(--soft);fill-opacity:0.1"/>`;
    out += line(on_x ? `M${px(at)} ${top}V${bottom}` : `M${left} ${px(at)}H${right}`, 'var(--soft)', ' stroke-dasharray="4 3"');
    const before = on_x && at + r.text.length * look.size * 0.55 > right;
    if (on_x) [row, last] = [Math.abs(at - last) < 5 * look.size ? row + 1 : 0, at];  // names of near rules stand below each other
    out += on_x ? text(look, at + (before ? -4 : 4), top + (row + 1) * look.size, r.text, {anchor: before ? 'end' : 'start'}) :
                  text(look, left + 6, r.zone ? at + look.size + 2 : at - 4, r.text);
  }
  return out;
}

/// Positions of a name relative to the end of its line: side, and rows above or below.
const kPlaces = [[1, 0], [1, -1.4], [1, 1.4], [-1, 0], [0, -1.7], [0, 1.8], [1, -2.9], [1, 2.9], [-1, -1.7], [-1, 1.7]];

/// Names at the ends of lines, each at the free position nearest to an end.
function draw_labels(look, lines, taken, {left, right, top, bottom}) {
  let out = '';
  const overlap = (a, list) =>
      list.filter(b => a[0] < b[0] + b[2] && b[0] < a[0] + a[2] && a[1] < b[1] + b[3] && b[1] < a[1] + a[3]).length;
  for (const l of lines) {
    if (!l.label || !l.at.length) continue;
    const width = l.label.length * look.size * 0.6 + 4, height = look.size + 2, gap = 9 * look.unit;
    let best = null;
    for (const [n, [x, y]] of [l.at.at(-1), l.at[0], l.at[l.at.length >> 1]].entries())
      for (const [k, [side, rows]] of kPlaces.entries()) {
        const beside = side > 0 ? gap : side < 0 ? -width - gap : -width / 2;
        const box = [x + beside, y + rows * gap - height / 2, width, height];
        const out_of = box[0] < left || box[0] + width > right || box[1] < top || box[1] + height > bottom;
        const cost = 10 * overlap(box, taken) + 2 * n + k / 4 + (out_of ? 100 : 0);
        if (best === null || cost < best.cost) best = {cost, box};
      }
    taken.push(best.box, best.box, best.box);
    out += `<text class="halo" x="${px(best.box[0])}" y="${px(best.box[1] + height - 4)}" font-size="${
        look.size}" font-weight="650" style="fill:${look.colour(l.solver)};stroke:var(--back);stroke-width:3.5;paint-order:stroke">${
        escape(l.label)}</text>`;
  }
  return out;
}

function draw_mark(look, m, x, y, index, box) {
  const hit = ` data-i="${index}"`, {solver} = m.row, colour = look.colour(solver), drawn = m.tone ? {...look, colour: () => `var(--${m.tone})`, symbol: () => m.shape} : look;
  if (m.kind === 'cell') {
    const w = Math.max(x.step - 1, 1), h = Math.max(y.step - 1, 1), left = x.at(m.x) - w / 2, top = y.at(m.y) - h / 2;
    const cell = toned_box(m.tone, left, top, w, h, ` class="mark"${hit}`);
    if (h <= look.size || w <= m.glyph.length * 5) return cell;
    return cell +
        text(look, x.at(m.x), y.at(m.y) + 3.5, m.glyph, {anchor: 'middle', colour: `var(--on-${m.tone})`, size: Math.min(10, look.size)});
  }
  if (m.kind === 'failed') return symbol({...look, symbol: () => 'x'}, solver, m.x > 0 ? x.at(m.x) : box.right, box.top, false, hit);
  const [a, b] = [x.at(m.x), y.at(m.y) + (m.shift ?? 0) * (y.step ?? 0)];
  if (!Number.isFinite(a + b)) return '';
  let out = '';
  const along = m.along === 'x' ? (p, q) => `M${px(x.at(p))} ${px(b)}H${px(x.at(q))}` : (p, q) => `M${px(a)} ${px(y.at(p))}V${px(y.at(q))}`;
  if (m.high > m.low) out += line(along(m.low, m.high), colour, ` stroke-width="${1.6 * look.unit}"`);
  if (m.thick) out += line(along(...m.thick), colour, ` stroke-width="${7 * look.unit}" stroke-opacity="0.35"`);
  if (m.note) out += text(look, Math.max(a, x.at(m.high) || a) + 8, b + 4, m.note, {size: look.small});
  return out + (m.kind === 'none' ? '' : symbol(drawn, solver, a, b, m.open, hit));
}

function draw_panel(look, panel, box, first, marks) {
  const lines = panel.lines ?? [],
        values = axis => [...panel.marks.flatMap(m => [m[axis], ...((m.along ?? 'y') === axis ? [m.low, m.high, ...(m.thick ?? [])] : [])]),
                          ...lines.flatMap(l => l.points.map(p => p[axis === 'x' ? 0 : 1])),
                          ...(panel.rules ?? []).filter(r => !r.optional).map(r => r[axis])]
                             .filter(v => v !== undefined && v !== null);
  const x = scale_of(panel.x, values('x'), box.left, box.right);
  const y = panel.y.type === 'band' ? scale_of(panel.y, [], box.top, box.bottom) : scale_of(panel.y, values('y'), box.bottom, box.top);
  const placed = lines.map(l => ({...l, at: l.points.map(([a, b]) => [x.at(a), y.at(b)]).filter(p => p.every(Number.isFinite))}));
  let out = draw_axes(look, panel, x, y, box, first) + draw_rules(look, panel, x, y, box);
  if (panel.title)
    out += text(
        look, box.left, box.top - 8, panel.title,
        {colour: panel.solver ? look.colour(panel.solver) : 'var(--ink)', bold: true});
  const taken = [];
  for (const l of placed) {
    if (l.at.length > 1)
      out += line(`M${l.at.map(p => p.map(px).join(' ')).join('L')}`, look.colour(l.solver), dashed(look, l));
    l.at.forEach(([a, b], k) => {
      const next = l.at[k + 1] ?? [a, b];
      for (let n = 0; n < 5; ++n)
        taken.push([a + (next[0] - a) * n / 5 - 3 * look.unit, b + (next[1] - b) * n / 5 - 3 * look.unit, 6 * look.unit, 6 * look.unit]);
    });
  }
  for (const m of panel.marks) {
    const index = marks.push(m) - 1;
    out += draw_mark(look, m, x, y, index, box);
    if (m.kind !== 'cell') taken.push([x.at(m.x) - 5 * look.unit, y.at(m.y) - 5 * look.unit, 10 * look.unit, 10 * look.unit]);
  }
  return out + draw_labels(look, placed.length > kMostLabels ? [] : placed, taken, {...box, right: box.right + look.right});
}

/// Legend below a picture: solvers with their symbols (only on paper), and the meanings of cell tones.
function draw_legend(look, chart, width, top) {
  const points = chart.panels.flatMap(p => p.marks).filter(m => !m.tone), lines = chart.panels.flatMap(p => (p.lines ?? []).length > kMostLabels ? p.lines : []);
  const items = [
    ...(look.paper ? unique(points.map(m => m.row.solver)) : []).map(s => [s, (x, y) => symbol(look, s, x + 6, y)]),
    ...lines.map(l => [l.label, (x, y) => line(`M${px(x)} ${px(y)}h${kSample}`, look.colour(l.solver), dashed(look, l)), kSample]),
    ...(chart.tones ?? []).map(([tone, words]) => [words, (x, y) => toned_box(tone, x, y - 5, 10, 10)])
  ];
  let x = 8, y = top, out = '';
  for (const [words, picture, sample = 10] of items) {
    const wide = 20 + sample + words.length * look.size * 0.57;
    if (x + wide > width && x > 8) [x, y] = [8, y + look.size + 6];
    out += picture(x, y) + text(look, x + sample + 8, y + look.size / 3, words);
    x += wide;
  }
  return {out, bottom: items.length ? y + look.size : top - 8};
}

/// {svg, marks, width, height}: the picture as SVG text, and its marks by `data-i`. `shrink`: factor on heights.
export function draw(chart, look_at, width, title, shrink = 1) {
  const {panels} = chart, columns = Math.max(1, Math.min(chart.columns ?? 1, panels.length)), marks = [], {unit} = look_at;
  const banded = panels[0]?.y.type === 'band';
  const longest = banded ? Math.max(0, ...panels[0].y.values.map(v => (panels[0].y.text ?? String)(v).length)) : 5;
  const look = {...look_at, gutter: Math.min(width * 0.42, 14 * unit + longest * look_at.size * 0.58), right: unit * (chart.right ?? 8)};
  const most = banded && panels[0].x.type === 'band' ? 110 * unit * panels[0].x.values.length : Infinity;  // cells stay cells
  const each = Math.min((width - look.gutter - 10 * unit) / columns, most);
  const names = panels[0]?.x.type === 'band' ? panels[0].x.values.map(v => (panels[0].x.text ?? String)(v).length * look.size * 0.56) : [];
  const upright = names.length && Math.max(...names) > (each - look.right) / names.length;
  const base = upright ? Math.max(...names) + 14 * unit : (names.length ? 1 : 2) * look.size + 20 * unit;
  let y = 0, svg = '';
  for (let k = 0; k < panels.length; k += columns) {
    const row = panels.slice(k, k + columns),
          top = y + (row.some(p => p.title) ? look.size + 10 * unit : 0) + (row[0].y.title ? look.size + 8 * unit : 8 * unit);
    const bottom = top + shrink * unit * (row[0].y.type === 'band' ? row[0].y.values.length * (chart.row ?? 22) : chart.height ?? 320);
    row.forEach((p, n) => {
      const left = look.gutter + n * each, right = look.gutter + (n + 1) * each - (columns > 1 ? 14 * unit : 0) - look.right;
      svg += draw_panel(look, p, {left: px(left), right: px(right), top, bottom}, n === 0, marks);
    });
    y = bottom + base;
  }
  const legend = draw_legend(look, chart, width, y + 6 * unit), height = Math.ceil(legend.bottom + 4 * unit), size = look.paper ? 'pt' : '';
  if (look.paper && height > kPaperHeight && shrink > 0.1) return draw(chart, look_at, width, title, 0.93 * shrink);
  const whole = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}${size}" height="${height}${
      size}" role="img" aria-label="${escape(title)}" font-family="${look.font}" stroke-width="${unit}">${
      look.paper ? `<rect width="${width}" height="${height}" fill="#fff"/>` : ''}${svg}${legend.out}</svg>`;
  return {marks, width, height, svg: look.paper ? whole.replace(/var\(--([\w-]+)\)/g, (_, name) => look.paper[name]) : whole};
}

/// A figure on paper: entries choose their layout by a width in page pixels.
export const draw_on_paper = (entry, rows, state, look, width) =>
    draw(entry.chart(rows, state, width / look.unit), look, width, entry.title(state));
