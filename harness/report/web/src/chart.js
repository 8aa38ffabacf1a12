// The one drawing of all figures. A chart has panels; a panel is
//   {title?, x, y, rows, rules?, shade?, edge?, bars?}
// `x`, `y`: {field, title, log?, base?, ticks?, format?, domain?, symlog?}. `rows`: {label, kind, dash?, shape?, low?, high?, faint?,
// tip?}, with `kind` one of 'point' (drawn as a point), 'line' (joined by label and dash), 'both', 'text' (its `text`
// at the point), 'failed' (a cross at the edge 'top' or 'bottom'; at the right end without an x). `rules`: reference
// lines [{x or y, text}]. `shade`: y below which the panel is grey. `bars`: {share, of, scale}: stacked bars instead.
import {palette} from './theme.js';

export const unique = list => [...new Set(list)];
const kShapes = ['circle', 'square', 'triangle-up', 'diamond', 'triangle-down', 'cross', 'triangle-right', 'triangle-left'];
const kDashes = [[1, 0], [7, 3], [2, 2], [7, 2, 2, 2], [4, 1]];

/// Ticks of a logarithmic axis: powers of ten; also 2 and 5 times them on short axes; every other one on long axes.
function decades(values) {
  const first = Math.floor(Math.log10(Math.min(...values))), last = Math.ceil(Math.log10(Math.max(...values))), out = [];
  for (let e = first; e <= last; e += last - first > 8 ? 2 : 1)
    for (const m of last - first > 2 ? [1] : [1, 2, 5]) out.push(Number(`${m}e${e}`));
  return out;
}

function axis({field, title, log, base, ticks, format = '~g', domain, symlog}, values) {
  const scale = symlog ? {type: 'symlog', constant: 1, domain} :
      log              ? {type: 'log', ...(base ? {base} : {}), nice: false, padding: 12} :
                         {nice: false, ...(domain ? {domain} : {})};
  const at = ticks ?? (log && values.length ? decades(values) : null);
  return {
    field,
    type: 'quantitative',
    title,
    scale,
    axis: {format, grid: !base, labelOverlap: true, ...(at ? {values: at} : {tickCount: 5})}
  };
}

/// A nominal channel whose legend is shared with the colours.
const by = (field, domain, range, legend) => ({
  field,
  type: 'nominal',
  title: null,
  scale: {domain, range: domain.map((_, k) => range[k % range.length])},
  ...(legend === undefined ? {} : {legend})
});

function bars_spec({title, rows, bars}, width) {
  return {
    title: {text: title, anchor: 'start', fontWeight: 'bold'},
    width: Math.min(170, width),
    height: {step: 15},
    layer: [{
      name: 'points',
      data: {values: rows},
      mark: {type: 'bar', stroke: '#ffffff', strokeWidth: 1},
      encoding: {
        x: {
          field: bars.share,
          type: 'quantitative',
          stack: 'normalize',
          title: bars.title,
          axis: {values: [0, 1], labelExpr: 'datum.value ? "all" : "0"'}
        },
        y: {field: bars.row, type: 'nominal', title: null, scale: {domain: unique(rows.map(r => r[bars.row])).sort()}, axis: {grid: false}},
        color: {field: bars.of, type: 'nominal', title: null, scale: {domain: Object.keys(bars.scale), range: Object.values(bars.scale)}},
        order: {field: 'order', type: 'quantitative'},
        tooltip: [{field: 'label'}, {field: bars.row}, {field: bars.of}, {field: bars.share}]
      }
    }]
  };
}

/// Rules and the shade behind the marks.
function background({rules = [], shade}, x, y, height) {
  const out = [];
  if (shade > 0)
    out.push({
      name: 'shade',
      data: {values: [{[y.field]: shade}]},
      mark: {type: 'rect', opacity: 0.12, color: '#808080'},
      encoding: {y, y2: {value: height}, x: {value: 0}, x2: {value: 'width'}}
    });
  for (const along of ['x', 'y']) {
    const here = rules.filter(r => along in r).map(r => ({[along === 'x' ? x.field : y.field]: r[along], text: r.text}));
    if (!here.length) continue;
    const place = along === 'x' ? {x, y: {value: 0}} : {y, x: {value: 'width'}};
    out.push(
        {name: `rules_${along}`, data: {values: here}, mark: {type: 'rule', strokeDash: [4, 4]}, encoding: along === 'x' ? {x} : {y}}, {
          name: `rule_text_${along}`,
          data: {values: here},
          mark: along === 'x' ? {type: 'text', align: 'left', baseline: 'top', dx: 4, dy: 4} :
                                {type: 'text', align: 'right', baseline: 'bottom', dx: -4, dy: -2},
          encoding: {...place, text: {field: 'text'}}
        });
  }
  return out;
}

function panel_spec(panel, look, width, height) {
  if (panel.bars) return bars_spec(panel, width);
  const {rows, edge = 'bottom'} = panel, kinds = (...k) => rows.filter(r => k.includes(r.kind));
  const points = kinds('point', 'both', 'line', 'text'), values = a => points.map(r => r[a.field]).filter(v => v > 0);
  const x = axis(panel.x, [...values(panel.x), ...(panel.rules ?? []).flatMap(r => r.x ?? [])]);
  const y = axis(panel.y, [...values(panel.y), ...(panel.rules ?? []).flatMap(r => r.y ?? [])]);
  const {color, strokeDash, shape, opacity, paper} = look;
  const tip = [
    {field: 'label', title: 'solver'}, ...(panel.tip ?? []).map(field => ({field})),
    {field: panel.x.field, title: panel.x.title, format: '.4~g'}, {field: panel.y.field, title: panel.y.title, format: '.4~g'}
  ];
  const layer = (name, data, mark, encoding) => ({name, data: {values: data}, mark, encoding});
  const at_edge = {value: edge === 'top' ? 0 : height}, cross = {type: 'point', shape: 'cross', angle: 45, filled: true, size: 60};
  const failed = kinds('failed'), visible = kinds('point', 'both').length > 0;
  return {
    width,
    height,
    ...(panel.title ? {title: {text: panel.title, anchor: 'start', fontWeight: 'bold'}} : {}),
    layer: [
      ...background(panel, x, y, height),
      layer(
          'spread', points.filter(r => r.high > r.low), {type: 'rule', aria: false},
          {x, y: {...y, field: 'low'}, y2: {field: 'high'}, color, opacity}),
      layer('lines', kinds('line', 'both'), {type: 'line', strokeWidth: paper ? 1.5 : 1.9}, {x, y, color, strokeDash, opacity}), {
        ...layer(
            'points',
            visible   ? kinds('point', 'both') :
                paper ? [] :
                        points,
            paper ? {type: 'point', fill: '#ffffff', size: 30, strokeWidth: 1.3} :
                    {type: 'point', filled: visible, size: 44, aria: visible},
            {x, y, color, shape, opacity: visible ? opacity : {value: 0}, tooltip: tip}),
        ...(paper ? {} : {params: [{name: 'pick', select: {type: 'point', fields: ['label']}, bind: 'legend'}]})
      },
      layer(
          'texts', points.filter(r => r.text), {type: 'text', align: 'left', baseline: 'bottom', dx: 3, dy: -3, fontSize: 8, aria: false},
          {x, y, color, text: {field: 'text'}}),
      layer(
          'failed', failed.filter(r => r[panel.x.field] > 0 || panel.x.field === 'time'), cross,
          {x, y: at_edge, color, tooltip: [{field: 'label'}, {field: 'status'}]}),
      layer(
          'failed_untimed', failed.filter(r => !(r[panel.x.field] > 0 || panel.x.field === 'time')), cross,
          {x: {value: 'width'}, y: at_edge, color, tooltip: [{field: 'label'}, {field: 'status'}]})
    ].filter((l, k, all) => l.data.values.length || (l.name === 'points' && all.every(o => !o.data.values.length)))
  };
}

/// Number of panels side by side, at most `most`; without gaps in the last row if possible.
function across_of(panels, most) {
  for (let n = Math.min(most, panels); n > 1; --n)
    if (panels % n === 0) return n;
  return Math.max(1, Math.min(most, panels));
}

/// A Vega-Lite specification. Names of layers are unique: those of panel k end in `_k` where there are several.
export function chart({panels, across = 3, height}, theme, width) {
  const rows = panels.flatMap(p => p.rows), labels = unique(rows.map(r => r.label)), paper = theme === 'paper';
  const colours = palette(labels, theme),
        of = (field, ...kinds) => unique(rows.filter(r => kinds.includes(r.kind)).map(r => r[field] ?? '')),
        dashes = of('dash', 'line', 'both'), shapes = of('shape', 'point', 'both');
  const named = list => list.length > 1 || list[0];
  const look = {
    paper,
    color: {field: 'label', type: 'nominal', title: null, scale: {domain: labels, range: labels.map(l => colours[l])}},
    // Without a meaning of their own, dashes and symbols repeat the colours, for readers who cannot tell these apart.
    strokeDash: named(dashes) ? by('dash', dashes, kDashes) : by('label', labels, rows.some(r => r.kind === 'point') ? [[1, 0]] : kDashes),
    shape: named(shapes) ? by('shape', shapes, kShapes) : by('label', labels, kShapes),
    opacity: paper ? {value: 1} : {condition: {param: 'pick', value: 1, empty: true}, value: 0.1}
  };
  const n = across_of(panels.length, across), room = paper ? width : width - 210;
  const specs = panels.map(
      p => panel_spec(
          p, look, Math.max(110, n > 1 ? room / n - 50 : room),
          height ??
              (n > 1     ? (paper ? 150 : 210) :
                   paper ? 280 :
                           360)));
  if (specs.length === 1) return specs[0];
  // A selection belongs to one panel; the others follow it.
  let chosen = false;
  specs.forEach((s, k) => s.layer.forEach(l => {
    l.name += `_${k}`;
    if (chosen) delete l.params;
    chosen ||= 'params' in l;
  }));
  return {columns: n, concat: specs, ...(panels.some(p => p.bars || p.own_y) ? {} : {resolve: {scale: {x: 'shared', y: 'shared'}}})};
}
