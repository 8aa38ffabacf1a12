// Stability maps: every probe by its outcome class in colour and symbol, the boundary of stability, and the theory.
import {across_of, beside, log_axis, still_name, unique} from './figure_parts.js';

/// A polygon through `radii` in turn, evenly round, within -1..1.
function polygon(corners, ...radii) {
  const points = Array.from({length: corners * radii.length}, (_, k) => {
    const turn = 2 * Math.PI * k / (corners * radii.length), r = radii[k % radii.length];
    return `${(r * Math.sin(turn)).toFixed(3)},${(-r * Math.cos(turn)).toFixed(3)}`;
  });
  return `M${points.join('L')}Z`;
}
const slanted = polygon(4, 0.4, 1.2);  // half of an upright cross that stands on two arms

/// Okabe & Ito's palette; `dark` where a colour would not be seen on black.
const kClasses = [
  {id: 'ok', words: 'stable', light: '#009E73', shape: 'circle'},
  {id: 'F0', words: 'F0 not finite or unbounded', light: '#000000', dark: '#FFFFFF', shape: slanted},
  {id: 'F1', words: 'F1 energy gained', light: '#CC79A7', shape: 'triangle-down'},
  {id: 'F2', words: 'F2 strain beyond the load', light: '#E69F00', shape: 'square'},
  {id: 'F3', words: 'F3 budget, crash or device', light: '#444444', dark: '#C0C0C0', shape: polygon(5, 1.2, 0.5)},
];
const kDashes = [[6, 4], [2, 3], [8, 3, 2, 3]];

const name_of = s => s.setting === 'default' ? s.solver : `${s.solver} ${s.setting}`;
const label_of = axis => axis.label + (axis.unit ? ` [${axis.unit}]` : '');
const class_of = p =>
    p.grade === 0 ? kClasses[0] : kClasses.find(c => c.id === p.class && c.id !== 'ok') ?? kClasses.at(-1);
const drawn = map => map.solvers.filter(s => s.probes.length > 0);
function largest(s, unit) {
  if (s.unsupported || !s.largest) return s.unsupported ? 'unsupported' : 'none';
  return `${s.open ? '≥ ' : ''}${Number(s.largest.toPrecision(3))} ${unit}`.trim();
}
const heading = (s, map) => `${name_of(s)}: ${largest(s, map.x.unit)}`;

function probes_of(solver) {
  return solver.probes.filter(p => p.seed === 0).map(p => ({
                                                       kind: 'probe',
                                                       solver: name_of(solver),
                                                       x: p.x,
                                                       y: p.y,
                                                       outcome: class_of(p).words,
                                                       status: p.status,
                                                       frame: p.frame >= 0 ? p.frame : null,
                                                       message: p.message ?? ''
                                                     }));
}

/// For every row with a boundary: the boundary (geometric mean of last stable and first unstable) and its range over
/// the seeds.
function boundary_of(solver) {
  return solver.rows.flatMap(row => {
    const turns =
        row.seeds.filter(s => s.first_bad !== null && s.last_good > 0).map(s => Math.sqrt(s.last_good * s.first_bad));
    if (!turns.length) return [];
    const x = Math.min(...turns), x2 = Math.max(...turns);
    return [{kind: 'boundary', x: Math.sqrt(x * x2), least: x, most: x2, y: row.y}];
  });
}

const theory_of = map =>
    map.theory.flatMap(line => line.points.map(([x, y]) => ({kind: 'theory', line: line.label, x, y})));

function rows_of(map) {
  return drawn(map).flatMap(
      s => [...theory_of(map), ...boundary_of(s), ...probes_of(s)].map(r => ({...r, panel: heading(s, map)})));
}

/// Ends of an axis: those of the probes and a margin. Theory far outside is clipped.
function ends(probes, key) {
  const values = probes.map(p => p[key]), room = 1.7;
  return [Math.min(...values) / room, Math.max(...values) * room];
}

const of = kind => [{filter: `datum.kind === '${kind}'`}];

function theory_layer(rows, x, y, theme) {
  const lines = [...new Set(rows.filter(r => r.kind === 'theory').map(r => r.line))];
  return {
    name: 'theory',
    transform: of('theory'),
    mark: {type: 'line', clip: true, strokeWidth: 1.8, color: theme === 'dark' ? '#56B4E9' : '#0072B2'},
    encoding: {
      x,
      y,
      strokeDash: {
        field: 'line',
        type: 'nominal',
        title: lines.length ? 'theory' : null,
        scale: {domain: lines, range: lines.map((_, k) => kDashes[k % kDashes.length])},
        legend: lines.length ? {symbolType: 'stroke', symbolSize: 500, orient: 'bottom', labelLimit: 800, columns: 1} :
                               null
      },
      order: {field: 'y', type: 'quantitative'}
    }
  };
}

function points_layer(map, probes, x, y, ink, theme) {
  const present = kClasses.filter(c => probes.some(p => p.outcome === c.words));
  const scale = range => ({domain: present.map(c => c.words), range});
  return {
    name: 'points',
    transform: of('probe'),
    mark: {type: 'point', filled: true, opacity: 1, size: 70, stroke: ink, strokeWidth: 0.6},
    encoding: {
      x,
      y,
      color: {
        field: 'outcome',
        type: 'nominal',
        title: 'outcome',
        scale: scale(present.map(c => theme === 'dark' ? c.dark ?? c.light : c.light))
      },
      shape: {field: 'outcome', type: 'nominal', title: 'outcome', scale: scale(present.map(c => c.shape))},
      tooltip: [
        {field: 'solver'}, {field: 'outcome'}, {field: 'x', title: label_of(map.x), format: '.4~g'},
        {field: 'y', title: label_of(map.y), format: '.4~g'}, {field: 'frame', title: 'first frame of that class'},
        {field: 'status'}, {field: 'message'}
      ]
    }
  };
}

function panels(map, rows, theme, width) {
  const probes = rows.filter(r => r.kind === 'probe');
  const axis = key => log_axis(
      key, label_of(map[key]), ends(probes, key),
      {scale: {domain: ends(probes, key), nice: false}, axis: {labelOverlap: true}});
  const x = axis('x'), y = axis('y'), ink = theme === 'dark' ? '#e3e8ee' : theme === 'light' ? '#1b1f24' : '#000000';
  const room = beside(theme, width, 240),
        across = across_of(drawn(map).length, Math.max(1, Math.min(3, Math.floor(room / 150))));
  return {
    data: {values: rows},
    columns: across,
    facet: {field: 'panel', type: 'nominal', title: null, sort: drawn(map).map(s => heading(s, map))},
    spec: {
      width: Math.max(theme === 'paper' ? 110 : 150, Math.floor(room / across) - 24),
      height: theme === 'paper' ? 160 : 210,
      layer: [
        theory_layer(rows, x, y, theme), {
          name: 'seeds',
          transform: of('boundary'),
          mark: {type: 'rule', strokeWidth: 5, opacity: 0.35, color: ink, clip: true},
          encoding: {x: {...x, field: 'least'}, x2: {field: 'most'}, y}
        },
        {
          name: 'boundary',
          transform: of('boundary'),
          mark: {type: 'line', strokeWidth: 1.6, color: ink, clip: true},
          encoding: {x, y, order: {field: 'y', type: 'quantitative'}}
        },
        {
          name: 'turns',  // visible where only one row has a boundary, too
          transform: of('boundary'),
          mark: {type: 'tick', orient: 'vertical', size: 14, thickness: 1.6, color: ink, clip: true},
          encoding: {x, y}
        },
        points_layer(map, probes, x, y, ink, theme)
      ]
    }
  };
}

const empty = 'None of these solvers supports this map.';

/// `maps` as in a study folder's stability.json.
export function stability_figure(maps) {
  const named = Object.fromEntries(maps.map(m => [m.name, m])), at = state => named[state.Map];
  const still = m => ({
    file: still_name(`stability-${m.name}`),
    title: `${m.title}: ${m.headline}`,
    labels: kClasses.map(c => c.words),
    empty: drawn(m).length ? '' : empty,
    notes: [`${m.title}. Above each panel: ${m.headline}.`],
    make: width => panels(m, rows_of(m), 'paper', width)
  });
  return {
    id: 'stability-map',
    title: 'Stability maps: outcome by setting',
    spec: (theme, width, state) => panels(at(state), rows_of(at(state)), theme, width),
    remark: state => `${at(state).headline}: ` + at(state).solvers.map(s => heading(s, at(state))).join('; ') + '.',
    choices: [{
      label: 'Map',
      options: () => maps.map(m => ({value: m.name, text: m.title})),
      first: () => maps.find(m => drawn(m).length)?.name
    }],
    empty,
    caption: 'Points: probes of the first seed; colour and symbol give the outcome class. Line: boundary between ' +
        'stable and unstable in each row; its width is the range over the seeds. Broken lines: theory. Above ' +
        'each panel: the largest stable value.',
    hint: 'Hover over a point for its values.',
    rows: state => {
      const probes = rows_of(at(state)).filter(r => r.kind === 'probe');
      return [
        ['map', 'solver', 'x', 'y', 'outcome', 'status', 'frame', 'message'],
        ...probes.map(p => [state.Map, p.solver, p.x, p.y, p.outcome, p.status, p.frame, p.message])
      ];
    },
    stills: maps.map(still)
  };
}

const kGrades = {
  stable: '#009E73',
  degraded: '#E69F00',
  failed: '#D55E00'
};

/// `cases`: [{case, solver, stable, degraded, failed}], numbers of runs.
export function cases_figure(cases) {
  const grades = Object.keys(kGrades), solvers = unique(cases.map(c => c.solver)),
        names = unique(cases.map(c => c.case)).sort();
  const rows =
      cases.flatMap(c => grades.map((grade, order) => ({...c, grade, order, runs: c[grade]})).filter(r => r.runs > 0));
  const share = {
    field: 'runs',
    type: 'quantitative',
    stack: 'normalize',
    title: 'share of runs',
    axis: {values: [0, 1], labelExpr: 'datum.value ? "all" : "0"', titleFontSize: 11}
  };
  const make = (theme, width) => ({
    data: {values: rows},
    columns: Math.min(5, solvers.length),
    facet: {field: 'solver', type: 'nominal', title: null, sort: solvers},
    spec: {
      width: Math.max(70, Math.min(160, (beside(theme, width, 120) - 60) / Math.min(5, solvers.length) - 20)),
      height: {step: 15},
      layer: [{
        name: 'points',
        mark: {type: 'bar', stroke: '#ffffff', strokeWidth: 1},
        encoding: {
          x: share,
          y: {field: 'case', type: 'nominal', title: 'case', scale: {domain: names}, axis: {grid: false}},
          color: {field: 'grade', type: 'nominal', title: null, scale: {domain: grades, range: Object.values(kGrades)}},
          order: {field: 'order', type: 'quantitative'},
          tooltip: [{field: 'solver'}, {field: 'case'}, {field: 'grade'}, {field: 'runs'}]
        }
      }]
    }
  });
  const title = 'Robustness by case';
  return {
    id: 'stability-cases',
    title,
    spec: make,
    caption: 'Share of the runs of each case that were stable, degraded or failed, from left to right.',
    rows: () => [['case', 'solver', ...grades], ...cases.map(c => [c.case, c.solver, ...grades.map(g => c[g])])],
    stills: [{file: 'stability-cases', title, make: w => make('paper', w)}]
  };
}
