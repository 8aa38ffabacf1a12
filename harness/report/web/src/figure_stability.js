// Stability maps: every probe by its outcome class, in colour and in symbol, where it turns, and what theory says.
import {select} from './dom.js';
import {decades} from './figure_parts.js';
import {plot_figure} from './plot.js';

/// A polygon through `radii` in turn, evenly round, within -1..1.
function polygon(corners, ...radii) {
  const points = Array.from({length: corners * radii.length}, (_, k) => {
    const turn = 2 * Math.PI * k / (corners * radii.length), r = radii[k % radii.length];
    return `${(r * Math.sin(turn)).toFixed(3)},${(-r * Math.cos(turn)).toFixed(3)}`;
  });
  return `M${points.join('L')}Z`;
}
const slanted = polygon(4, 0.4, 1.2);  // a cross that stands on two feet, once turned

/// Okabe & Ito's palette, as in the static figures; `dark` where a colour would not be seen on black.
const kClasses = [
  {id: 'ok', words: 'stable', light: '#009E73', shape: 'circle'},
  {id: 'F0', words: 'F0 not finite', light: '#000000', dark: '#FFFFFF', shape: slanted},
  {id: 'F1', words: 'F1 speed', light: '#D55E00', shape: 'triangle-up'},
  {id: 'F2', words: 'F2 energy gain', light: '#CC79A7', shape: 'triangle-down'},
  {id: 'F3', words: 'F3 strain', light: '#E69F00', shape: 'square'},
  {id: 'F4', words: 'F4 geometry', light: '#56B4E9', shape: 'diamond'},
  {id: 'F5', words: 'F5 contact', light: '#0072B2', shape: 'cross'},
  {id: 'F6', words: 'F6 unrest', light: '#F0E442', shape: polygon(6, 1)},
  {id: 'F7', words: 'F7 stagnation', light: '#777777', shape: 'triangle-left'},
  {id: 'F8', words: 'F8 budget, crash or device', light: '#444444', dark: '#C0C0C0', shape: polygon(5, 1.2, 0.5)},
];
const kDashes = [[6, 4], [2, 3], [8, 3, 2, 3]];

const name_of = s => s.setting === 'default' ? s.solver : `${s.solver} ${s.setting}`;
const label_of = axis => axis.label + (axis.unit ? ` [${axis.unit}]` : '');
const class_of = p =>
    p.grade === 0 ? kClasses[0] : kClasses.find(c => c.id === p.class && c.id !== 'ok') ?? kClasses.at(-1);
const drawn = map => map.solvers.filter(s => s.probes.length > 0);

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

/// Of every row that turns: the middle of its turn, and the range of that over the seeds.
function boundary_of(solver) {
  return solver.rows.flatMap(row => {
    const turns =
        row.seeds.filter(s => s.first_bad !== null && s.last_good > 0).map(s => Math.sqrt(s.last_good * s.first_bad));
    if (!turns.length) return [];
    const x = Math.min(...turns), x2 = Math.max(...turns);
    return [{kind: 'boundary', solver: name_of(solver), x: Math.sqrt(x * x2), least: x, most: x2, y: row.y}];
  });
}

function theory_of(map, solver) {
  return map.theory.flatMap(
      line => line.points.map(([x, y]) => ({kind: 'theory', solver: name_of(solver), line: line.label, x, y})));
}

function rows_of(map) { return drawn(map).flatMap(s => [...theory_of(map, s), ...boundary_of(s), ...probes_of(s)]); }

/// Ends of an axis: those of the probes and a little more; a theory far outside is cut off.
function ends(probes, key) {
  const values = probes.map(p => p[key]), room = 1.7;
  return [Math.min(...values) / room, Math.max(...values) * room];
}

function panels(map, rows, theme, width) {
  const probes = rows.filter(r => r.kind === 'probe'),
        present = kClasses.filter(c => probes.some(p => p.outcome === c.words));
  const lines = [...new Set(rows.filter(r => r.kind === 'theory').map(r => r.line))];
  const axis = key => ({
    field: key,
    type: 'quantitative',
    title: label_of(map[key]),
    scale: {type: 'log', domain: ends(probes, key), nice: false},
    axis: {format: '~g', labelOverlap: true, values: decades(ends(probes, key))}
  });
  const x = axis('x'), y = axis('y'), ink = theme === 'dark' ? '#e3e8ee' : '#1b1f24';
  const of = kind => [{filter: `datum.kind === '${kind}'`}];
  const scale = range => ({domain: present.map(c => c.words), range});
  const across = Math.max(1, Math.min(3, drawn(map).length, Math.floor((width - 240) / 190)));
  return {
    data: {values: rows},
    columns: across,
    facet: {field: 'solver', type: 'nominal', title: null, sort: drawn(map).map(name_of)},
    spec: {
      width: Math.max(150, Math.floor((width - 240) / across) - 24),
      height: 210,
      layer: [
        {
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
              legend: lines.length ? {symbolType: 'stroke', symbolSize: 500, orient: 'bottom', labelLimit: 800} : null
            },
            order: {field: 'y', type: 'quantitative'}
          }
        },
        {
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
          name: 'turns',  // also where only one row turns
          transform: of('boundary'),
          mark: {type: 'tick', orient: 'vertical', size: 14, thickness: 1.6, color: ink, clip: true},
          encoding: {x, y}
        },
        {
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
              {field: 'y', title: label_of(map.y), format: '.4~g'}, {field: 'frame', title: 'first such frame'},
              {field: 'status'}, {field: 'message'}
            ]
          }
        }
      ]
    }
  };
}

/// `maps` as in a study folder's stability.json.
export function stability_figure(maps) {
  let at = maps.find(m => drawn(m).length) ?? maps[0];
  let figure = null;
  const largest = s => s.unsupported ? 'unsupported' :
      !s.largest                     ? 'none' :
                                       `${s.open ? '≥ ' : ''                    }${Number(s.largest.toPrecision(3))} ${at.x.unit}`.trim();
  figure = plot_figure({
    id: 'stability-map',
    title: 'Stability maps: outcome by setting',
    spec: (theme, width) => panels(at, rows_of(at), theme, width),
    remark: () => `${at.headline}: ` + at.solvers.map(s => `${name_of(s)} ${largest(s)}`).join('; ') + '.',
    controls: [select(
        'Map', maps.map(m => ({value: m.name, text: m.title})), at.name,
        v => {
          at = maps.find(m => m.name === v);
          figure.redraw();
        })],
    empty: 'No solver here can run this map.',
    caption:
        'Every probe of the first seed by its outcome class, in colour and symbol; the line is where a row turns, wide where ' +
        'its seeds differ; broken lines: theory. Hover for the numbers.',
    rows: () => {
      const probes = rows_of(at).filter(r => r.kind === 'probe');
      return [
        ['map', 'solver', 'x', 'y', 'outcome', 'status', 'frame', 'message'],
        ...probes.map(p => [at.name, p.solver, p.x, p.y, p.outcome, p.status, p.frame, p.message])
      ];
    }
  });
  return figure;
}
