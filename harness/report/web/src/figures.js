// The figures of a report: entries over the rows of all runs (`doc.runs`), drawn by draw.js. An entry:
//   {id, section, title(state), caption, choices?, rows(state), drawn?(row), spec(rows, state, look), tip(row), columns, stills}
// `choices`: [{label, options(state), first?(state)}]; `rows(state)`: the runs or values behind the figure, each with its
// solver; `spec`: the Vega-Lite spec for the rows that are `drawn` and pass the filter of solvers, with pixels of `room` for names
// to the right of lines; `look` as in spec.js.
// `columns`: fields of a row, for the table behind the figure. `stills`: image files of the report, [{file, state}]; by
// default one, named by the id. `hero`: suits the first screen, which shows the first entry with `hero`. `legend`: false if
// colours are not by solver. A row that stands for several runs has them in `behind`.
import {kSymbols, number, unique} from './look.js';
import {band, by_solver, interval, legend, lines, log, panels, rules, symbols} from './spec.js';

const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'crashed', 'error'];
const percent = v => v === null || v === undefined ? '–' : `${number(100 * v, 3)} %`;
const ms = s => s === null || s === undefined ? '–' : `${number(1e3 * s)} ms`;
const choice = (label, values, first, text = String) =>
    ({label, options: s => (typeof values === 'function' ? values(s) : values).map(value => ({value, text: text(value)})), first: () => first});

/// A solver without a cloth model is far faster than all others, and is drawn only if there are no others.
const without_floor = (doc, rows) =>
    rows.every(r => doc.solvers.floor.includes(r.solver)) ? rows : rows.filter(r => !doc.solvers.floor.includes(r.solver));

/// True if the row is on its solver's Pareto front of fields a and b, where smaller is better.
const on_front = (p, rows, a, b) => !rows.some(q => q.solver === p.solver && q[a] <= p[a] && q[b] <= p[b] && (q[a] < p[a] || q[b] < p[b]));

const good = r => r.status === 'ok' && r.error > 0 && r.wall_ms_per_s > 0;

function error_rules(runs) {
  const {space_error, reference_uncertainty} = runs[0], least = Math.min(...runs.filter(good).map(r => r.error));
  const floors = [[space_error, 'error of the mesh'], [3 * (reference_uncertainty ?? 0), '3 × uncertainty of the reference']];
  const [floor, words] = floors.filter(([v]) => v > 0).sort((a, b) => b[0] - a[0])[0] ?? [0, ''];
  return floor > 1e-3 * least ? [{at: floor, text: `${words} ${number(floor, 2)}`, zone: true}] : [];
}

function error_time(doc) {
  const all = doc.runs.filter(r => r.part === 'accuracy');
  if (!all.some(good)) return null;
  const of = scene => all.filter(r => r.scene === scene), scenes = unique(all.map(r => r.scene)).filter(v => of(v).some(good));
  const first = [...scenes].sort((a, b) => of(b).filter(good).length - of(a).filter(good).length)[0];
  return {
    id: 'error-time', section: 'accuracy', hero: true,
    title: s => `Error against run time: ${s.Scene}`,
    caption:
        'Lower left is better. One mark per setting; the filled marks on a line are the best settings of a solver.\nErrors in the shaded area ' +
        'are not distinguished. Crosses on the upper edge: runs that failed.',
    choices: [choice('Scene', scenes, first, v => of(v)[0].refused ? `${v} (refused)` : v)],
    rows: s => {
      const fine = of(s.Scene).filter(good);
      return of(s.Scene).map(r => ({...r, line: r.solver, best: good(r) && on_front(r, fine, 'wall_ms_per_s', 'error')}));
    },
    drawn: r => good(r) || kFailed.includes(r.status),
    remark: s => [of(s.Scene)[0].refused && `No solver is ranked: ${of(s.Scene)[0].refused}.`,
                  ...unique(of(s.Scene).filter(r => r.not_ranked).map(r => `${r.solver} is shown but not ranked: ${r.not_ranked}.`))]
                     .filter(Boolean)
                     .join(' '),
    spec: (rows, s, look) => {
      const fine = rows.filter(good), best = fine.filter(r => r.best), floors = error_rules(of(s.Scene)), solver = by_solver(rows, look, '!datum.best');
      const x = log('wall_ms_per_s', 'wall time [ms per simulated second]', [1000, ...rows.map(r => r.wall_ms_per_s)]);
      const y = log('error', `error: ${rows[0].ranking}`, [...floors.map(f => f.at), ...fine.map(r => r.error)], {titleLimit: look.width - 10});
      const [[, last], [, top]] = [x, y].map(axis => axis.scale.domain), crosses = rows.filter(r => !good(r)).map(r => ({wall_ms_per_s: r.wall_ms_per_s || last, error: top}));
      return {
        height: look.shrink * Math.max(260, Math.min(400, 0.62 * look.width)),
        layer: [
          ...lines(best, x, y, solver, look, {x: [{at: 1000, text: 'real time'}], y: floors}, [...fine, ...crosses]),
          {...symbols({x, y, ...solver}), transform: [{filter: "datum.status === 'ok'"}]},
          {...symbols({x: {value: {expr: "datum.wall_ms_per_s > 0 ? scale('x', datum.wall_ms_per_s) : width"}}, y: {value: 0}, stroke: solver.stroke, shape: {value: kSymbols.x}}), transform: [{filter: "datum.status !== 'ok'"}]}
        ]
      };
    },
    tip: r => [`${r.label}, ${r.scene}`, good(r) ? `error ${number(r.error)}, ${number(r.wall_ms_per_s)} ms per simulated second` : r.status],
    columns: ['solver', 'setting', 'status', 'wall_ms_per_s', 'device_ms_per_s', 'error'],
    stills: scenes.map(v => ({file: `work-precision-${v}`, state: {Scene: v}}))
  };
}

const kRates = {
  fps: {text: 'Frame rate', paper: 'Fig. 4: ', unit: 'frames per second', of: r => r.fps_median, still: 'fig4', is_rate: true},
  read: {text: 'Peak read bandwidth', paper: 'Fig. 5: ', unit: 'GB/s', of: r => 1e-9 * r.bandwidth_read_peak_B_per_s, still: 'fig5'},
  tail: {text: 'Slow frames (95th percentile)', unit: 'wall time [ms]', of: r => 1e3 * (r.contact_wall ?? r.wall)?.[3]},
  memory: {text: 'Device memory per vertex', unit: 'kB per vertex', of: r => 1e-3 * r.device_memory_B / (r.width * r.width)}
};

function rates(doc) {
  const all = doc.runs.filter(r => r.family && !r.published && r.fps_median > 0);
  if (!all.length) return null;
  const families = unique(all.map(r => r.family)), main = all.find(r => r.paper_table === 3)?.family ?? families[0];
  const is_grid = s => of(s).every(r => r.is_grid), in_paper = s => of(s).some(r => r.paper_table === 3);
  const of = s => all.filter(r => r.family === s.Scene), has = ({of}) => r => of(r) > 0;
  const line = r => `${r.label}${r.sides && r.sides !== 'single' ? `, ${r.sides}` : ''}${r.cpu ? ' (CPU)' : ''}`;
  return {
    id: 'rates', section: 'rates', hero: true,
    title: s => `${in_paper(s) && kRates[s.Value].paper || ''}${kRates[s.Value].text} by resolution, ${s.Scene}`,
    caption:
        'Frame rates are uncapped, without rendering: median of the trials with its 95 % interval. Hollow: the free-fall error is ' +
        'above 1 %, or the run fails its criteria.\nSlow frames: of the frames with contact, if any. Bandwidth: bytes that shaders load and store, counted in an untimed run of the same frames, ' +
        'per second of wall time; unknown for CPU solvers. Figure numbers are the article\'s.',
    remark: s => unique(of(s).filter(r => r.frames && (s.Show === 'all' || r.setting === 'default')).map(r => `${r.label} at ${r.resolution}: ${r.frames} only, as a trial reached its time limit.`)).join(' '),
    choices: [
      choice('Scene', families, main), choice('Value', s => Object.keys(kRates).filter(v => of(s).some(has(kRates[v]))), undefined, v => kRates[v].text),
      choice('Show', ['plain', 'all'], 'plain', v => ({plain: 'one layer, default settings', all: 'all layers and settings'})[v])
    ],
    rows: s => {
      const mine = without_floor(doc, of(s).filter(has(kRates[s.Value]))), plain = mine.filter(r => r.setting === 'default' && (!r.sides || r.sides === 'single'));
      return (s.Show === 'all' || !plain.length ? mine : plain).map(r => ({...r, line: line(r), value: kRates[s.Value].of(r), size: is_grid(s) ? r.width : Math.round(r.width * r.width)}));
    },
    spec: (rows, s, look) => {
      const sizes = unique(rows.map(r => r.size)).sort((a, b) => a - b), values = rows.map(r => r.value), {is_rate, unit} = kRates[s.Value];
      const x = log('size', is_grid(s) ? 'vertices along one side' : 'vertices', sizes, {values: sizes, labelExpr: "format(datum.value, '.4~r')"});
      const y = log('value', unit, is_rate ? rows.flatMap(r => [r.value, r.fps_low, r.fps_high]) : values), solver = by_solver(rows, look, "datum.free_fall_error > 0.01 || datum.verdict === 'fail'");
      return {
        height: look.shrink * Math.max(240, Math.min(340, 0.5 * look.width)),
        room: Math.min(0.27 * look.width, 16 + 6.8 * Math.max(...rows.map(r => r.line.length))),
        layer: [
          ...lines(rows, x, y, solver, look, {y: is_rate && Math.min(...values) < 72 && Math.max(...values) > 72 ? [{at: 72, text: '72 Hz'}] : []}),
          ...(is_rate ? [interval('fps_low', 'fps_high', {x, y: {...y, field: 'fps_low'}, y2: {field: 'fps_high'}, stroke: solver.stroke})] : []), symbols({x, y, ...solver})
        ]
      };
    },
    tip: r =>
        [`${r.label} at ${r.resolution}${r.sides ? `, ${r.sides}` : ''}`, number(r.value),
         ...(r.fps_low ? [`frames per second, 95 %: ${number(r.fps_low)} to ${number(r.fps_high)}`] : []),
         ...(r.free_fall_error ? [`free-fall error ${percent(r.free_fall_error)}`] : [])],
    columns: ['label', 'sides', 'resolution', 'fps_median', 'fps_low', 'fps_high', 'free_fall_error', 'value'],
    stills: [
      ...Object.entries(kRates).filter(([, v]) => v.still).map(([Value, v]) => ({file: v.still, state: {Scene: main, Value}})),
      ...unique(all.filter(r => r.part === 'contact').map(r => r.family)).map(f => ({file: `scale-${f.replace(/ \((.*)\)/, '-$1')}`, state: {Scene: f, Value: 'tail'}}))
    ]
  };
}

const kClocks = {contact_gpu_time: 'GPU time, frames with contact', contact_wall: 'wall time, frames with contact', gpu_time: 'GPU time, all frames', wall: 'wall time, all frames'};

function frame_times(doc) {
  const all = doc.runs.filter(r => r.wall && r.setting === 'default'), clocks = Object.keys(kClocks).filter(c => all.some(r => r[c]));
  if (!clocks.length) return null;
  const few = unique(all.map(r => r.scene)).length <= 8;
  const runs_of = s => all.filter(r => r.solver === s).length, solvers = unique(without_floor(doc, all).map(r => r.solver)).sort((a, b) => runs_of(b) - runs_of(a));
  return {
    id: 'frame-times', section: 'time', hero: true,
    title: s => `Distribution of frame times${s.Solver === 'all' ? '' : `: ${s.Solver}`}`,
    caption: 'Mark: median; bar: up to the 95th percentile; line: up to the 99th. Dashed: one refresh of a display.',
    choices: [
      choice('Time', clocks, clocks.includes('contact_wall') ? 'contact_wall' : 'wall', c => kClocks[c]),
      choice('Solver', s => [...(few ? ['all'] : []), ...solvers.filter(v => all.some(r => r.solver === v && r[s.Time]))])
    ],
    rows: s => all.filter(r => r[s.Time] && (s.Solver === 'all' || r.solver === s.Solver)).map(r => {
      const [p50_s, low_s, high_s, p95_s, p99_s, worst_s] = r[s.Time];
      return {...r, p50_s, low_s, high_s, p95_s, p99_s, worst_s, p50: 1e3 * p50_s, p95: 1e3 * p95_s, p99: 1e3 * p99_s};
    }),
    spec: (rows, s, look) => {
      const present = unique(rows.map(r => r.solver)), scenes = unique(rows.map(r => r.scene)), worst = Math.max(...rows.map(r => r.p99)), solver = by_solver(rows, look);
      const lines = [72, 90].filter(hz => worst > 100 / hz).map(hz => ({at: 1e3 / hz, text: `${hz} Hz`})), near = lines.filter(l => worst > l.at / 3);
      const x = log('p50', 'time per frame [ms]', [...near.map(l => l.at), ...rows.flatMap(r => [r.p50, r.p99])]);
      const shared = {x, y: band('scene', scenes, look), yOffset: {field: 'solver', scale: {domain: present}}};
      const to = (high, mark) => interval('p50', high, {mark, ...shared, x2: {field: high}, stroke: solver.stroke});
      return {
        height: look.shrink * scenes.length * Math.max(22, 13 * present.length + 6),
        layer: [
          ...rules(lines.filter(l => l.at > x.scale.domain[0] && l.at < x.scale.domain[1]), 'x', x, k => ({y: -6, align: k ? 'right' : 'left', dx: k ? -4 : 4})),
          to('p95', {strokeWidth: 7, opacity: 0.35}), to('p99'), symbols({...shared, ...solver})
        ]
      };
    },
    tip: r =>
        [`${r.label}, ${r.scene}`, `p50 ${ms(r.p50_s)} (95 %: ${ms(r.low_s)} to ${ms(r.high_s)})`,
         `p95 ${ms(r.p95_s)}, p99 ${ms(r.p99_s)}, worst ${ms(r.worst_s)}`, `${r.trials} trials, ${r.trust}`],
    columns: ['scene', 'label', 'p50_s', 'low_s', 'high_s', 'p95_s', 'p99_s', 'worst_s', 'trials']
  };
}

/// By verdict: tone, path of the sign, and text of the legend.
const kVerdicts = {
  pass: ['pass', 'M-3.5 0L-1 3L4 -3.5', '✓ pass'],
  fail: ['fail', 'M-3 -3L3 3M-3 3L3 -3', '× fail'],
  ignored: ['ignored', 'M-3.4 0a3.4 3.4 0 1 0 6.8 0a3.4 3.4 0 1 0 -6.8 0', '○ ignored: no contact'],
  unsupported: ['none', 'M-3 0H3', '– unsupported, or not measured'],
  'not measured': ['none', 'M-.5 0H.5', '– unsupported, or not measured'],
  missing: ['none', 'M-.5 0H.5', '– unsupported, or not measured']
};
const tone_of = r => kVerdicts[r.verdict] ?? kVerdicts.fail;
const why = r => r.violated?.map(([name, found, expected]) => `${name}: found ${found}${expected && `, expected ${expected}`}`) ?? [];
/// Runs with a verdict; repeated runs (a scene in several studies) do not count.
const judged = (doc, part) => doc.runs.filter(r => r.part === part && r.verdict !== '–' && !r.repeated);

function verdicts(doc) {
  const all = judged(doc, 'contact').filter(r => !doc.solvers.baseline.includes(r.solver));
  return all.length && {
    id: 'verdicts', section: 'contact', hero: true, legend: false,
    title: () => 'Verdicts by scene and solver',
    caption: 'Passed: the run meets every acceptance criterion of its scene. Empty: not run.\nSelect a cell for the criteria that a run violates.',
    rows: () => all.map(r => ({...r, criteria: why(r).join('; '), tone: tone_of(r)[0], sign: tone_of(r)[1], words: tone_of(r)[2]})),
    spec: (rows, s, look) => {
      const [solvers, scenes] = ['label', 'scene'].map(field => band(field, unique(rows.map(r => r[field])), look)), {width} = look;
      const turned = width >= 740 && scenes.scale.domain.length >= 12;  // in wide windows many scenes become columns; elsewhere names of columns stand above the many rows
      const [x, y] = turned ? [scenes, solvers] : [{...solvers, axis: {...solvers.axis, orient: 'top'}}, scenes], [tones, words] = [0, 2].map(k => unique(Object.values(kVerdicts).map(v => v[k])));
      return {
        width: Math.min(width, 180 + 110 * x.scale.domain.length),
        height: look.shrink * y.scale.domain.length * (turned ? 24 : 18),
        layer: [
          {
            mark: {type: 'rect', cornerRadius: 2},
            encoding: {x, y, fill: {field: 'words', scale: {domain: words, range: tones.map(tone => `var(--${tone})`)}, legend: legend(words, look, {symbolType: 'square', symbolSize: 120})}}
          },
          {name: 'signs', mark: {type: 'point'}, encoding: {x, y, shape: {field: 'sign', scale: null}, stroke: {value: {expr: "'var(--on-' + datum.tone + ')'"}}, size: {value: {expr: "4 * pow(min(1, bandwidth('x') / 12, bandwidth('y') / 12), 2)"}}}}
        ]
      };
    },
    tip: r => [`${r.label}, ${r.scene}: ${r.verdict}`, ...why(r), ...(r.message ? [r.message] : [])],
    columns: ['scene', 'label', 'verdict', 'criteria']
  };
}

/// Runs of generated scenes with contact. Scenes of the study `physics` have no speed.
const contact_scenes = doc => judged(doc, 'generated').filter(r => r.status !== 'missing' && r.speed > 0);

function failure_speed(doc) {
  const rows = contact_scenes(doc).filter(r => ['pass', 'fail'].includes(tone_of(r)[0]) && r.setting === 'default').map(r => ({...r, name: `${r.kind} · ${r.solver}`}));
  return rows.length && {
    id: 'failure-speed', section: 'contact',
    title: () => 'Speeds at which generated scenes are passed and failed',
    caption: 'Filled: the run passed at this speed of the hand or the impact; hollow: it failed. Runs that are unsupported or were not measured are not drawn.',
    rows: () => rows,
    spec: (given, s, look) => ({
      height: 18 * look.shrink * unique(given.map(r => r.name)).length,
      layer: [symbols({x: log('speed', 'speed [m/s]', given.map(r => r.speed)), y: band('name', unique(given.map(r => r.name)).sort(), look), ...by_solver(given, look, "datum.verdict !== 'pass'")})]
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

/// The fraction of good runs by solver and value of `field`, with its interval; `more`: the figure's other keys.
function shares(runs, field, is_good, more) {
  const row = (label, value, mine) => {
    const count = mine.length, good = mine.filter(is_good).length, [low, high] = wilson(good, count);
    return {solver: mine[0].solver, behind: mine, label, [field]: value, good, runs: count, unsupported: mine.filter(r => r.status === 'unsupported').length, low, high, rate: good / count};
  };
  const rows = unique(runs.map(r => r.label)).flatMap(label => {
    const mine = runs.filter(r => r.label === label), values = unique(mine.map(r => r[field])).sort();
    return [row(label, 'all', mine), ...values.map(value => row(label, value, mine.filter(r => r[field] === value)))];
  });
  return rows.length && {
    hero: true,
    rows: () => rows,
    spec: (given, s, look) => {
      const solver = by_solver(given, look), bands = unique(rows.map(r => r[field])), labels = unique(given.map(r => r.label));
      const share = {field: 'rate', type: 'quantitative', title: null, scale: {domain: [0, 1]}, axis: {grid: true, values: [0, 0.5, 1], labelExpr: "100 * datum.value + ' %'"}};
      return panels(labels, 85, bands, look, (label, y) => ({
        title: {text: label, color: look.solvers[given.find(r => r.label === label).solver].colour},
        height: 18 * look.shrink * bands.length,
        transform: [{filter: {field: 'label', equal: label}}],
        layer: [
          {...interval('low', 'high', {x: {...share, field: 'low'}, x2: {field: 'high'}, y: {...y, field}, stroke: solver.stroke}), transform: [{filter: 'datum.unsupported < datum.runs'}]},
          {...symbols({x: share, y: {...y, field}, ...solver}), transform: [{filter: 'datum.unsupported < datum.runs'}]},
          {mark: {type: 'text', text: 'unsupported', align: 'left'}, encoding: {x: {...share, field: undefined, datum: 0.02}, y: {...y, field}}, transform: [{filter: 'datum.unsupported === datum.runs'}]}
        ]
      }));
    },
    tip: r => [`${r.label}, ${r[field]}`, `${r.good} of ${r.runs} (95 %: ${percent(r.low)} to ${percent(r.high)})`],
    columns: ['label', field, 'good', 'runs', 'unsupported', 'low', 'high'],
    ...more
  };
}

const forest = doc => shares(contact_scenes(doc), 'kind', r => r.verdict === 'pass', {
  id: 'forest', section: 'contact',
  title: () => 'Pass rate by kind of generated scene with contact',
  caption: 'Fraction of scenes that meet every acceptance criterion, with the 95 % interval (Wilson). Unsupported scenes count as not passed.'
});

const stability = doc => shares(doc.runs.filter(r => !r.repeated && (r.grade >= 0 || (r.part === 'stability' && r.status === 'unsupported'))), 'case', r => r.grade === 0, {
  id: 'stability', section: 'stability',
  title: () => 'Stable runs by case',
  caption: 'Fraction of the runs of a case without any failure class, with the 95 % interval (Wilson). Unsupported scenes count as not stable.'
});

const kClaims = [['holds', 'good', 'circle'], ['near', 'soft', 'circle'], ['fails', 'bad', 'x']];

function claims(doc) {
  const all = doc.runs.filter(r => r.part === 'claims' && r.status !== 'missing');
  return all.length && {
    id: 'claims-map', section: 'contact', hero: true, legend: false,
    title: () => 'Where each claim of the article holds',
    caption: 'One mark per point of the box, by iterations (across) and substeps (up) of a frame. The other settings that the article leaves ' +
        'open vary too, so marks of both kinds lie near each other.\nNear: all criteria of the claim except one are met.',
    rows: () => all,
    spec: (rows, s, look) => {
      const channel = of => ({field: 'claim', type: 'nominal', scale: {domain: kClaims.map(c => c[0]), range: kClaims.map(of)}, legend: legend(['holds', 'near', 'fails'], look)});
      return panels(unique(rows.map(r => r.kind)).sort(), Math.max(150, look.width / 4), ['0000'], look, kind => ({
        title: {text: kind},
        height: 130 * look.shrink,
        transform: [{filter: {field: 'kind', equal: kind}}],
        layer: [symbols({
          x: log('iterations', 'iterations', all.map(r => r.iterations)),
          y: log('substeps', null, all.map(r => r.substeps)),
          stroke: channel(([, tone]) => `var(--${tone})`),
          fill: channel(([claim, tone]) => claim === 'near' ? 'var(--back)' : `var(--${tone})`),
          shape: channel(([, , symbol]) => kSymbols[symbol])
        })]
      }));
    },
    tip: r => [`${r.label}, ${r.kind}: ${r.claim}`, `${number(r.iterations)} iterations × ${number(r.substeps)} substeps, ${number(r.dispatches)} dispatches`, ...why(r)],
    columns: ['kind', 'label', 'iterations', 'substeps', 'dispatches', 'claim']
  };
}

/// A log of `clothbench check --log`: one line per landing.
function changes(doc) {
  const landings = (doc.history ?? []).map((l, n) => ({...l, at: n + 1, commit: l.commit.slice(0, 8) + (l.dirty ? '*' : '')})), commits = landings.map(l => l.commit), shown = unique(doc.runs.map(r => r.solver));
  const all = landings.flatMap(({runs, command, commit, created, at}) => runs.filter(r => shown.includes(r.solver)).map(r => ({
    ...r, at, commit, created, behind: [], line: r.setting === 'default' ? r.scene : `${r.scene} ${r.setting}`, file: `${r.scene}__${r.solver}__${r.setting}.h5`,
    again: command && `git checkout ${commit.slice(0, 8)}; ${command}`
  })));
  const devices = unique(all.map(r => r.gpu)).filter(Boolean), of = s => all.filter(r => r.gpu === s.Device);
  if (unique(all.map(r => r.commit)).length < 2) return null;
  const first = (r, name) => all.find(q => q.gpu === r.gpu && q.solver === r.solver && q.line === r.line && name in q.values).values[name];
  return {
    id: 'changes', section: 'environment',
    title: s => `From commit to commit: ${s.Value}`,
    caption: 'Values of the runs that every landing checks against its baseline, divided by the value at the first commit. Lines that fall improve.\nValues that were 0 there are left out. *: with local changes. Times only of GPUs.',
    choices: [choice('Device', devices), choice('Value', s => unique(of(s).flatMap(r => Object.keys(r.values).filter(name => first(r, name) > 0))).sort(), 'dispatches')],
    rows: s => of(s).filter(r => s.Value in r.values && first(r, s.Value) > 0).map(r => ({...r, value: r.values[s.Value], change: r.values[s.Value] / first(r, s.Value)})),
    drawn: r => r.change > 0,
    spec: (rows, s, look) => {
      const x = {field: 'at', type: 'quantitative', title: null, scale: {domain: [0.8, commits.length + 0.2]}, axis: {grid: false, values: commits.map((_, n) => n + 1), labelExpr: `${JSON.stringify(commits)}[datum.value - 1]`}};
      const y = log('change', 'relative to the first commit', rows.map(r => r.change)), solver = by_solver(rows, look);
      return {height: look.shrink * 260, room: Math.min(0.27 * look.width, 16 + 6.8 * Math.max(...rows.map(r => r.line.length))), layer: [...lines(rows, x, y, solver, look, {}), symbols({x, y, ...solver})]};
    },
    tip: r => [`${r.solver}, ${r.line}`, `${number(r.value)} at ${r.commit} (${r.created})`],
    columns: ['commit', 'created', 'solver', 'line', 'value', 'change']
  };
}

/// All figures that the document has runs for.
export const make_figures = doc =>
    [error_time, verdicts, forest, failure_speed, claims, rates, stability, frame_times, changes].map(make => make(doc)).filter(Boolean);

/// A figure's choices: from `given` if valid, otherwise the default.
export function settled(figure, given) {
  const state = {};
  for (const {label, options, first} of figure.choices ?? []) {
    const list = options(state).map(o => o.value);
    state[label] = [given[label], first?.(state)].find(v => list.includes(v)) ?? list[0] ?? '';
  }
  return state;
}

/// Commands that repeat runs, with only their solvers and, unless `whole`, only their scenes and settings: per study one for the
/// solvers of clothbench and one per plugin, so that a build without a plugin can run all others. A comment before each names the
/// commit and device of its runs.
export function command_of(doc, runs, whole = false) {
  if (runs[0]?.again) return runs[0].again;
  const groups = new Map();
  for (const r of runs) if (doc.studies[r.study]?.command) (k => groups.set(k, [...groups.get(k) ?? [], r]))(`${r.study} ${r.plugin ?? ''}`);
  return [...groups.values()].map(mine => {
    const made = unique(mine.map(r => r.made).filter(Boolean)).join('; ');
    return (made && `# ${made}\n`) + study_command(doc, mine, whole);
  }).join('\n');
}

function study_command(doc, mine, whole) {
  const {study: n, plugin} = mine[0], study = doc.studies[n], solvers = unique(mine.map(r => r.solver)), given = [];
  const words = study.command.replace(/ --(solver|jobs)((?:[ =](?!-)\S+)+)/g, (_, name, values) => (given.push(...values.split(/[ =]/)), '')).split(' ');
  const chosen = given.filter(w => plugin && w.endsWith(plugin)), with_solvers = ['--solver', ...(chosen.length ? chosen : solvers)];
  if (whole || !['study', 'run'].includes(words[1]) || doc.runs.filter(r => r.study === n && solvers.includes(r.solver)).length === mine.length) return [...words, ...with_solvers].join(' ');
  if (words[1] === 'study') return [...words, ...with_solvers, `--out again-${[study.study, ...solvers].join('-')} --job`, mine.map(r => r.name ?? r.file.replace(/\.\w+$/, '')).join(',')].join(' ');
  const end = words.findIndex((w, k) => k > 2 && w[0] === '-'), scenes = words.slice(2, end < 0 ? undefined : end), each = study.runs / scenes.length;
  return ['clothbench run', ...scenes.filter((_, k) => mine.some(r => Math.floor(r.job / each) === k)), ...(end < 0 ? [] : words.slice(end)), ...with_solvers].join(' ');
}

/// The result files of runs: the first ones, and the number of all others.
export function files_of(runs) {
  const files = runs.map(r => r.file).filter(Boolean);
  return files.slice(0, 3).join(', ') + (files.length > 3 ? ` and ${files.length - 3} more` : '');
}
