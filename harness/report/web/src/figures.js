// The figures of a report: entries over the rows of all runs (`doc.runs`), drawn by chart.js. An entry:
//   {id, section, title(state), caption, choices?, rows(state), chart(rows, state, width), tip(row), columns, stills}
// `choices`: [{label, options(state), first?(state)}]; `rows(state)`: the runs or values behind the figure, each with its
// solver; `chart` makes panels of those that the filter of solvers leaves. `columns`: fields of a row, for the table behind it.
// `stills`: pictures beside the report, [{file, state}]; by default one, named by the id. `hero`: may be the figure of the first
// screen, for which the first one is taken.
import {number, span, unique} from './chart.js';

const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'crashed', 'error'];
const kRefresh_Hz = [72, 90];
const percent = v => v === null || v === undefined ? '–' : `${number(100 * v, 3)} %`;
const ms = s => s === null || s === undefined ? '–' : `${number(1e3 * s)} ms`;
const by_solver = rows => unique(rows.map(r => r.solver)).map(solver => [solver, rows.filter(r => r.solver === solver)]);
const choice = (label, values, first, text = String) =>
    ({label, options: s => (typeof values === 'function' ? values(s) : values).map(value => ({value, text: text(value)})), first: () => first});

/// The harness without a cloth model is far faster than every solver. It is drawn only if no other solver is.
const without_floor = (doc, rows) =>
    rows.every(r => doc.solvers.floor.includes(r.solver)) ? rows : rows.filter(r => !doc.solvers.floor.includes(r.solver));

/// Pareto front: rows that no other row of their solver dominates in both fields, by ascending a.
const on_front = (rows, a, b) =>
    rows.filter(p => !rows.some(q => q.solver === p.solver && q[a] <= p[a] && q[b] <= p[b] && (q[a] < p[a] || q[b] < p[b])))
        .sort((p, q) => p[a] - q[a]);

// Error against run time -----------------------------------------------------

const good = r => r.status === 'ok' && r.error > 0 && r.wall_ms_per_s > 0;

function error_rules(runs) {
  const {space_error, reference_uncertainty} = runs[0], least = Math.min(...runs.filter(good).map(r => r.error));
  const floors = [[space_error, 'error of the mesh'], [3 * (reference_uncertainty ?? 0), '3 × uncertainty of the reference']];
  const [floor, words] = floors.filter(([v]) => v > 0).sort((a, b) => b[0] - a[0])[0] ?? [0, ''];
  return [{x: 1000, text: 'real time'}, ...(floor > 1e-3 * least ? [{y: floor, text: `${words} ${number(floor, 2)}`, zone: true}] : [])];
}

function error_time(doc) {
  const all = doc.runs.filter(r => r.part === 'accuracy');
  if (!all.some(good)) return null;
  const scenes = unique(all.map(r => r.scene)), of = scene => all.filter(r => r.scene === scene);
  const first = [...scenes].sort((a, b) => of(b).filter(good).length - of(a).filter(good).length)[0];
  return {
    id: 'error-time',
    section: 'accuracy',
    hero: true,
    title: s => `Error against run time: ${s.Scene}`,
    caption:
        'Lower left is better. One mark per setting; the filled marks on a line are the best settings of a solver. Errors in the shaded ' +
        'area are not distinguished. Crosses on the upper edge: runs that failed.',
    choices: [choice('Scene', scenes, first, v => of(v)[0].refused ? `${v} (refused)` : v)],
    rows: s => of(s.Scene),
    remark: s => [of(s.Scene)[0].refused && `No solver is ranked: ${of(s.Scene)[0].refused}.`,
                  ...unique(of(s.Scene).filter(r => r.not_ranked).map(r => `${r.solver} is shown but not ranked: ${r.not_ranked}.`))]
                     .filter(Boolean)
                     .join(' '),
    chart: (rows, s, width) => {
      const fine = rows.filter(good), fronts = by_solver(fine).map(([solver, mine]) => [solver, on_front(mine, 'wall_ms_per_s', 'error')]),
            best = fronts.flatMap(f => f[1]);
      return {
        height: Math.max(260, Math.min(400, 0.62 * width)),
        panels: [{
          x: {type: 'log', title: 'wall time [ms per simulated second]'},
          y: {type: 'log', title: `error: ${rows[0]?.ranking ?? ''}`.slice(0, Math.max(20, width / 7.2 | 0))},
          rules: rows.length ? error_rules(of(s.Scene)) : [],
          lines: fronts.map(([solver, front]) => ({solver, label: solver, points: front.map(r => [r.wall_ms_per_s, r.error])})),
          marks: [
            ...fine.map(r => ({kind: 'point', x: r.wall_ms_per_s, y: r.error, open: !best.includes(r), row: r})),
            ...rows.filter(r => kFailed.includes(r.status)).map(r => ({kind: 'failed', x: r.wall_ms_per_s ?? 0, row: r}))
          ]
        }]
      };
    },
    tip: r =>
        [`${r.label}, ${r.scene}`, good(r) ? `error ${number(r.error)}, ${number(r.wall_ms_per_s)} ms per simulated second` : r.status],
    columns: ['solver', 'setting', 'status', 'wall_ms_per_s', 'device_ms_per_s', 'error'],
    stills: scenes.map(v => ({file: `work-precision-${v}`, state: {Scene: v}}))
  };
}

// Frame rates ----------------------------------------------------------------

const kRates = {
  fps: {text: 'Frame rate', paper: 'Fig. 4: ', unit: 'frames per second', of: r => r.fps_median, still: 'fig4', is_rate: true},
  read: {text: 'Peak read bandwidth', paper: 'Fig. 5: ', unit: 'GB/s', of: r => 1e-9 * r.bandwidth_read_peak_B_per_s, still: 'fig5'},
  tail: {text: 'Slow frames (95th percentile)', unit: 'wall time [ms]', of: r => 1e3 * (r.contact_wall ?? r.wall)?.[3]},
  memory: {text: 'Device memory per vertex', unit: 'kB per vertex', of: r => 1e-3 * r.device_memory_B / (r.width * r.width)}
};

/// Runs on one line: same solver, setting and sides. Lines of one solver differ in dash pattern.
function lines_of(rows) {
  const name = r => `${r.label}${r.sides && r.sides !== 'single' ? `, ${r.sides}` : ''}${r.cpu ? ' (CPU)' : ''}`;
  return by_solver(rows).flatMap(([solver, mine]) => unique(mine.map(name)).map((label, dash) => ({
    solver,
    dash,
    label,
    points: mine.filter(r => name(r) === label).sort((a, b) => a.size - b.size).map(r => [r.size, r.value])
  })));
}

function rates(doc) {
  const all = doc.runs.filter(r => r.family && !r.published && r.fps_median > 0);
  if (!all.length) return null;
  const families = unique(all.map(r => r.family)), main = all.find(r => r.paper_table === 3)?.family ?? families[0];
  const is_grid = s => !of(s).some(r => r.resolution.endsWith('vertices')), in_paper = s => of(s).some(r => r.paper_table === 3);
  const of = s => all.filter(r => r.family === s.Scene), has = ({of}) => r => of(r) > 0;
  return {
    id: 'rates',
    section: 'rates',
    hero: true,
    title: s => `${in_paper(s) && kRates[s.Value].paper || ''}${kRates[s.Value].text} by resolution, ${s.Scene}`,
    caption:
        'Frame rates are uncapped, without rendering: median of the trials with its 95 % interval. Hollow: the free-fall error is ' +
        'above 1 %, so the rate has no meaning. Slow frames: of the frames with contact, if any. Bandwidth: bytes that shaders load and store, counted in an untimed run of the same frames, ' +
        'per second of wall time; unknown for CPU solvers. Figure numbers are the article\'s.',
    remark: s => unique(of(s).filter(r => r.frames && (s.Show === 'all' || r.setting === 'default')).map(r => `${r.label} at ${r.resolution}: ${r.frames} only, as a trial reached its time limit.`)).join(' '),
    choices: [
      choice('Scene', families, main), choice('Value', s => Object.keys(kRates).filter(v => of(s).some(has(kRates[v]))), undefined, v => kRates[v].text),
      choice('Show', ['plain', 'all'], 'plain', v => ({plain: 'one layer, default settings', all: 'all layers and settings'})[v])
    ],
    rows: s => {
      const mine = without_floor(doc, of(s).filter(has(kRates[s.Value]))),
            plain = mine.filter(r => r.setting === 'default' && (!r.sides || r.sides === 'single'));
      return (s.Show === 'all' || !plain.length ? mine : plain).map(r => ({...r, value: kRates[s.Value].of(r), size: is_grid(s) ? r.width : Math.round(r.width * r.width)}));
    },
    chart: (rows, s, width) => ({
      right: 90,
      height: Math.max(240, Math.min(340, 0.5 * width)),
      panels: [{
        x: {type: 'log', title: is_grid(s) ? 'vertices along one side' : 'vertices', ticks: unique(rows.map(r => r.size)).sort((a, b) => a - b), format: t => String(Number(t.toPrecision(4)))},
        y: {type: 'log', title: kRates[s.Value].unit},
        rules: kRates[s.Value].is_rate ? [{y: 72, text: '72 Hz', optional: true}] : [],
        lines: lines_of(rows),
        marks: rows.map(r => {
          const interval = kRates[s.Value].is_rate ? {low: r.fps_low, high: r.fps_high} : {};
          return {kind: 'point', x: r.size, y: r.value, ...interval, along: 'y', open: r.free_fall_error > 0.01, row: r};
        })
      }]
    }),
    tip: r =>
        [`${r.label} at ${r.resolution}${r.sides ? `, ${r.sides}` : ''}`, number(r.value),
         ...(r.fps_low ? [`frames per second, 95 %: ${number(r.fps_low)} to ${number(r.fps_high)}`] : []),
         ...(r.free_fall_error ? [`free-fall error ${percent(r.free_fall_error)}`] : [])],
    columns: ['label', 'sides', 'resolution', 'fps_median', 'fps_low', 'fps_high', 'free_fall_error', 'value'],
    stills: [
      ...Object.entries(kRates).filter(([, v]) => v.still).map(([Value, v]) => ({file: v.still, state: {Scene: main, Value}})),
      ...unique(all.filter(r => r.part === 'contact').map(r => r.family)).map(f => ({file: `scale-${f}`, state: {Scene: f, Value: 'tail'}}))
    ]
  };
}

// Frame times ----------------------------------------------------------------

const kClocks = {
  contact_gpu_time: 'GPU time, frames with contact',
  contact_wall: 'wall time, frames with contact',
  gpu_time: 'GPU time, all frames',
  wall: 'wall time, all frames'
};

/// Vertical offset that puts the solvers of one scene below each other.
const shift_of = (solver, all) => all.length > 1 ? (all.indexOf(solver) - (all.length - 1) / 2) / (all.length + 0.6) : 0;

function frame_times(doc) {
  const all = doc.runs.filter(r => r.wall && r.setting === 'default'), clocks = Object.keys(kClocks).filter(c => all.some(r => r[c]));
  if (!clocks.length) return null;
  const few = unique(all.map(r => r.scene)).length <= 8;
  return {
    id: 'frame-times',
    section: 'time',
    hero: true,
    title: s => `Distribution of frame times${s.Solver === 'all' ? '' : `: ${s.Solver}`}`,
    caption: 'Mark: median; bar: up to the 95th percentile; line: up to the 99th. Dashed: one refresh of a display.',
    choices: [
      choice('Time', clocks, clocks.includes('contact_wall') ? 'contact_wall' : 'wall', c => kClocks[c]),
      choice('Solver', s => [...(few ? ['all'] : []), ...unique(without_floor(doc, all.filter(r => r[s.Time])).map(r => r.solver))])
    ],
    rows: s => all.filter(r => r[s.Time] && (s.Solver === 'all' || r.solver === s.Solver)).map(r => {
      const [p50_s, low_s, high_s, p95_s, p99_s, worst_s] = r[s.Time];
      return {...r, p50_s, low_s, high_s, p95_s, p99_s, worst_s};
    }),
    chart: rows => {
      const present = unique(rows.map(r => r.solver)), worst = Math.max(0, ...rows.map(r => 1e3 * r.p99_s));
      return {
        row: Math.max(22, 13 * present.length + 6),
        right: 20,
        panels: [{
          x: {type: 'log', title: 'time per frame [ms]'},
          y: {type: 'band', values: unique(rows.map(r => r.scene))},
          rules: kRefresh_Hz.filter(hz => worst > 100 / hz).map(hz => ({x: 1e3 / hz, text: `${hz} Hz`, optional: worst < 1e3 / hz / 3})),
          marks: rows.map(r => {
            const [p50, p95, p99] = [r.p50_s, r.p95_s, r.p99_s].map(s => 1e3 * s), shift = shift_of(r.solver, present);
            return {kind: 'point', x: p50, y: r.scene, shift, thick: [p50, p95], low: p50, high: p99, along: 'x', row: r};
          })
        }]
      };
    },
    tip: r =>
        [`${r.label}, ${r.scene}`, `p50 ${ms(r.p50_s)} (95 %: ${ms(r.low_s)} to ${ms(r.high_s)})`,
         `p95 ${ms(r.p95_s)}, p99 ${ms(r.p99_s)}, worst ${ms(r.worst_s)}`, `${r.trials} trials, ${r.trust}`],
    columns: ['scene', 'label', 'p50_s', 'low_s', 'high_s', 'p95_s', 'p99_s', 'worst_s', 'trials']
  };
}

// Contact and stability ------------------------------------------------------

const kVerdicts = {
  pass: ['pass', '✓'],
  fail: ['fail', '×'],
  ignored: ['ignored', '○'],
  unsupported: ['none', '–'],
  'not measured': ['none', '·'],
  missing: ['none', '·']
};
const tone_of = r => kVerdicts[r.verdict] ?? kVerdicts.fail;
const why = r => r.violated?.map(([name, found, expected]) => `${name}: found ${found}${expected && `, expected ${expected}`}`) ?? [];
/// Runs with a verdict; a scene of several studies counts once, by its first run.
const judged = (doc, part) => doc.runs.filter(r => r.part === part && r.verdict !== '–' && !r.repeated);

function verdicts(doc) {
  const all = judged(doc, 'contact').filter(r => !doc.solvers.baseline.includes(r.solver));
  return all.length && {
    id: 'verdicts',
    section: 'contact',
    hero: true,
    title: () => 'Verdicts by scene and solver',
    caption: 'Passed: the run meets every acceptance criterion of its scene. Empty: not run. Select a cell for the criteria that a run violates.',
    rows: () => all.map(r => ({...r, criteria: why(r).join('; ')})),
    chart: (rows, s, width) => {
      const [across, down] = ['label', 'scene'].map(field => unique(rows.map(r => r[field])));
      const turned = width >= 740 && down.length >= 12;  // in wide windows many scenes become columns
      const axes = [{type: 'band', values: across}, {type: 'band', values: down, text: v => v.length > 30 ? `${v.slice(0, 29)}…` : v}];
      const [x, y] = turned ? axes.reverse() : axes;
      const cell = r => ({kind: 'cell', x: turned ? r.scene : r.label, y: turned ? r.label : r.scene, tone: tone_of(r)[0], glyph: tone_of(r)[1], row: r});
      return {
        row: turned ? 24 : 18,
        tones: [['pass', 'pass'], ['fail', 'fail'], ['ignored', 'ignored: no contact simulated'], ['none', 'unsupported, or not measured']],
        panels: [{x, y, marks: rows.map(cell)}]
      };
    },
    tip: r => [`${r.label}, ${r.scene}: ${r.verdict}`, ...why(r), ...(r.message ? [r.message] : [])],
    columns: ['scene', 'label', 'verdict', 'criteria']
  };
}

function failure_speed(doc) {
  const all = doc.runs.filter(r => r.part === 'contact' && r.speed > 0 && ['pass', 'fail'].includes(tone_of(r)[0]) && r.setting === 'default');
  const rows = all.filter(r => all.some(q => q.kind === r.kind && q.speed !== r.speed)), name = r => `${r.kind} · ${r.solver}`;
  return rows.length && {
    id: 'failure-speed',
    section: 'contact',
    title: () => 'Speeds that are passed and failed',
    caption: 'Filled: the run passed at this speed of the hand; hollow: it failed. Runs whose criteria were not measured are not drawn.',
    rows: () => rows,
    chart: given => ({
      row: 18,
      panels: [{
        x: {type: 'log', title: 'speed [m/s]'},
        y: {type: 'band', values: unique(given.map(name)).sort()},
        marks: given.map(r => ({kind: 'point', x: r.speed, y: name(r), open: r.verdict !== 'pass', row: r}))
      }]
    }),
    tip: r => [`${r.label}, ${r.scene}`, `${number(r.speed)} m/s: ${r.verdict}`, ...why(r)],
    columns: ['scene', 'label', 'speed', 'verdict']
  };
}

/// 95 % interval of a fraction: Wilson's score.
export function wilson(passed, all) {
  const z = 1.959964, p = passed / all, d = 1 + z * z / all, middle = (p + z * z / (2 * all)) / d,
        half = z / d * Math.sqrt(p * (1 - p) / all + z * z / (4 * all * all));
  return [Math.max(0, middle - half), Math.min(1, middle + half)];
}

/// The fraction of good runs by solver and value of `field`, with its interval; `more`: additions by the figure.
function shares(runs, field, is_good, more) {
  const row = (label, value, mine) => {
    const count = mine.length, good = mine.filter(is_good).length, [low, high] = wilson(good, count);
    return {solver: mine[0].solver, study: mine[0].study, label, [field]: value, good, runs: count, unsupported: mine.filter(r => r.status === 'unsupported').length, low, high};
  };
  const rows = unique(runs.map(r => r.label)).flatMap(label => {
    const mine = runs.filter(r => r.label === label), values = unique(mine.map(r => r[field])).sort();
    return [row(label, 'all', mine), ...values.map(value => row(label, value, mine.filter(r => r[field] === value)))];
  });
  return rows.length && {
    hero: true,
    rows: () => rows,
    chart: (given, s, width) => ({
      row: 18,
      right: 26,
      columns: Math.max(2, Math.min(6, Math.floor(width / 125))),
      panels: unique(given.map(r => r.label)).map(label => {
        const mine = given.filter(r => r.label === label);
        return {
          title: label,
          solver: mine[0].solver,
          x: {type: 'linear', domain: [0, 1], ticks: [0, 0.5, 1], format: t => `${100 * t} %`, title: ''},
          y: {type: 'band', values: unique(rows.map(r => r[field]))},
          marks: mine.map(
              r => r.unsupported === r.runs ? {kind: 'none', x: 0.02, y: r[field], note: 'unsupported', row: r} :
                                              {kind: 'point', x: r.good / r.runs, y: r[field], low: r.low, high: r.high, along: 'x', row: r})
        };
      })
    }),
    tip: r => [`${r.label}, ${r[field]}`, `${r.good} of ${r.runs} (95 %: ${percent(r.low)} to ${percent(r.high)})`],
    columns: ['label', field, 'good', 'runs', 'unsupported', 'low', 'high'],
    ...more
  };
}

const forest = doc => shares(judged(doc, 'generated').filter(r => r.status !== 'missing'), 'kind', r => r.verdict === 'pass', {
  id: 'forest',
  section: 'contact',
  title: () => 'Pass rate by kind of generated scene',
  caption: 'Fraction of scenes that meet every acceptance criterion, with the 95 % interval (Wilson). Unsupported scenes count as not passed.'
});

const stability = doc => shares(doc.runs.filter(r => !r.repeated && (r.grade >= 0 || (r.part === 'stability' && r.status === 'unsupported'))), 'case', r => r.grade === 0, {
  id: 'stability',
  section: 'stability',
  title: () => 'Stable runs by case',
  caption: 'Fraction of the runs of a case without any failure class, with the 95 % interval (Wilson). Unsupported scenes count as not stable.'
});

// What the article leaves open ------------------------------------------------

const kClaims = {
  holds: ['good', 'circle', false],
  near: ['soft', 'circle', true],
  fails: ['bad', 'x', false]
};

function claims(doc) {
  const all = doc.runs.filter(r => r.part === 'claims' && r.status !== 'missing');
  return all.length && {
    id: 'claims-map',
    section: 'contact',
    hero: true,
    title: () => 'Where each claim of the article holds',
    caption: 'One mark per point of the box, by iterations (across) and substeps (up) of a frame. The other settings that the article leaves ' +
        'open vary too, so marks of both kinds lie near each other. Near: all criteria of the claim except one are met.',
    rows: () => all,
    chart: (rows, s, width) => ({
      height: 130,
      right: 30,
      columns: Math.max(2, Math.min(3, Math.floor(width / 220))),
      tones: [['good', 'holds'], ['soft', 'near (ring)'], ['bad', 'fails']],
      panels: unique(rows.map(r => r.kind)).sort().map(kind => ({
        title: kind,
        x: {type: 'log', title: 'iterations', domain: span(all.map(r => r.iterations))},
        y: {type: 'log', domain: span(all.map(r => r.substeps))},
        marks: rows.filter(r => r.kind === kind).map(r => {
          const [tone, shape, open] = kClaims[r.claim];
          return {kind: 'point', x: r.iterations, y: r.substeps, tone, shape, open, row: r};
        })
      }))
    }),
    tip: r => [`${r.label}, ${r.kind}: ${r.claim}`, `${number(r.iterations)} iterations × ${number(r.substeps)} substeps, ${number(r.dispatches)} dispatches`, ...why(r)],
    columns: ['kind', 'label', 'iterations', 'substeps', 'dispatches', 'claim']
  };
}

/// All figures that the document has runs for.
export const make_figures = doc =>
    [error_time, verdicts, forest, failure_speed, claims, rates, stability, frame_times].map(make => make(doc)).filter(Boolean);

/// The choices of a figure; default where `given` has no valid value.
export function settled(figure, given) {
  const state = {};
  for (const {label, options, first} of figure.choices ?? []) {
    const list = options(state).map(o => o.value);
    state[label] = [given[label], first?.(state)].find(v => list.includes(v)) ?? list[0] ?? '';
  }
  return state;
}

/// The commands that repeat runs: one per study.
export function command_of(doc, runs) {
  const of = study => {
    const plain = doc.studies[study]?.command ?? '', jobs = runs.filter(r => r.study === study).map(r => r.job);
    return jobs.includes(undefined) || !/ study /.test(plain) ? plain : `${plain} --out again --job ${jobs.join(',')}`;
  };
  return unique(runs.map(r => r.study)).map(of).filter(Boolean).join('\n');
}
