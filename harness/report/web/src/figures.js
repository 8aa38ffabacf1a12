// The figures of a report: entries over the rows of all runs (`doc.runs`) and their series, drawn by chart.js. An entry:
//   {id, section, title(state), caption, choices, chart(rows, state, width), rows(state), columns, stills}
// `choices`: [{label, options(state), first?(state)}]; `rows(state)`: the runs or values behind the figure, each with its
// solver; `chart` makes panels of those that the filter of solvers leaves; `columns` are those of its table and CSV.
// `stills`: pictures beside the report, [{file, state}].
import {number, unique} from './chart.js';
import {by_solver, file_of, kFailed, percent, without_floor} from './figure_parts.js';
import {failure_speed, forest, penetration, stability, verdicts} from './figures_contact.js';

const kRefresh_Hz = [72, 90];
const ms = s => s === null || s === undefined ? '–' : `${number(1e3 * s)} ms`;
/// Pareto front: rows that no row of the same solver dominates in both fields, by ascending a.
export const on_front = (rows, a, b) =>
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
    choices:
        [{label: 'Scene', options: () => scenes.map(v => ({value: v, text: of(v)[0].refused ? `${v} (refused)` : v})), first: () => first}],
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
            ...fine.map(r => ({kind: 'point', x: r.wall_ms_per_s, y: r.error, solver: r.solver, open: !best.includes(r), row: r})),
            ...rows.filter(r => kFailed.includes(r.status))
                .map(r => ({kind: 'failed', x: r.wall_ms_per_s ?? 0, edge: 'top', solver: r.solver, row: r}))
          ]
        }]
      };
    },
    tip: r =>
        [`${r.label}, ${r.scene}`, good(r) ? `error ${number(r.error)}, ${number(r.wall_ms_per_s)} ms per simulated second` : r.status],
    columns: {
      solver: r => r.solver,
      setting: r => r.setting,
      status: r => r.status,
      'wall_ms_per_s': r => r.wall_ms_per_s,
      'device_ms_per_s': r => r.device_ms_per_s,
      error: r => r.error
    },
    stills: scenes.map(v => ({file: `work-precision-${v}`, state: {Scene: v}}))
  };
}

// Frame rates ----------------------------------------------------------------

const width_axis = rows => ({
  type: 'log',
  title: 'vertices along one side',
  ticks: unique(rows.map(r => r.width)).sort((a, b) => a - b),
  format: t => String(Number(t.toPrecision(4)))
});
/// Runs of one line: solver, setting and sides. Lines of one solver differ by their dash.
const series_of = rows => unique(rows.map(r => `${r.label}${r.sides && r.sides !== 'single' ? `, ${r.sides}` : ''}`))
                              .map(
                                  name =>
                                      [name,
                                       rows.filter(r => `${r.label}${r.sides && r.sides !== 'single' ? `, ${r.sides}` : ''}` === name)
                                           .sort((a, b) => a.width - b.width)]);

function by_resolution(doc, {id, title, caption, value, unit, low, high, open, rules = [], columns, still, panels = [['', value]]}) {
  const all = doc.runs.filter(r => r.part === 'rates' && !r.published && panels.some(([, of]) => of(r) > 0));
  if (!all.length) return null;
  const families = unique(all.map(r => r.family)), of = family => all.filter(r => r.family === family);
  const main = all.find(r => r.paper_table === 3)?.family ?? families[0], both = 'all layers and settings';
  return {
    id,
    section: 'rates',
    hero: id === 'rates',
    title: s => `${title}: ${s.Scene}`,
    caption,
    choices: [
      {label: 'Scene', options: () => families.map(v => ({value: v, text: v})), first: () => main},
      {label: 'Show', options: () => [{value: 'default', text: 'one layer, default settings'}, {value: 'all', text: both}]}
    ],
    rows: s => {
      const mine = without_floor(of(s.Scene), doc.solvers.floor),
            plain = mine.filter(r => r.setting === 'default' && (!r.sides || r.sides === 'single'));
      return s.Show === 'all' || !plain.length ? mine : plain;
    },
    chart: (rows, s, width) => ({
      right: 90,
      columns: width < 560 ? 1 : panels.length,
      height: Math.max(240, Math.min(340, 0.5 * width)),
      panels: panels.map(
          ([name, value_of]) => ({
            title: name,
            x: width_axis(rows),
            y: {type: 'log', title: unit},
            rules: rules.map(r => ({...r, optional: true})),
            lines: by_solver(rows).flatMap(
                ([solver, mine]) => series_of(mine).map(([label, line], k) => ({
                                                          solver,
                                                          label: mine.length > line.length ? label : solver,
                                                          dash: k,
                                                          points: line.filter(r => value_of(r) > 0).map(r => [r.width, value_of(r)])
                                                        }))),
            marks: rows.filter(r => value_of(r) > 0).map(r => ({
                                                           kind: 'point',
                                                           x: r.width,
                                                           y: value_of(r),
                                                           low: low?.(r),
                                                           high: high?.(r),
                                                           along: 'y',
                                                           solver: r.solver,
                                                           open: open?.(r),
                                                           row: r
                                                         }))
          }))
    }),
    tip: r =>
        [`${r.label} at ${r.resolution}${r.sides ? `, ${r.sides}` : ''}`,
         ...panels.map(([name, f]) => `${name} ${number(f(r))} ${unit}`.trim()),
         ...(r.fps_low ? [`95 %: ${number(r.fps_low)} to ${number(r.fps_high)}`] : []),
         ...(r.free_fall_error ? [`free-fall error ${percent(r.free_fall_error)}`] : [])],
    columns,
    stills: [{file: still, state: {Scene: main}}]
  };
}

const rates = doc => by_resolution(doc, {
  id: 'rates',
  title: 'Fig. 4: frame rate by resolution',
  caption:
      'Uncapped, without rendering. Marks: median of the trials; bars: its 95 % interval. Hollow: the error of free fall is above 1 %, so the rate has no meaning.',
  value: r => r.fps_median,
  unit: 'frames per second',
  low: r => r.fps_low,
  high: r => r.fps_high,
  open: r => r.free_fall_error > 0.01,
  rules: [{y: 72, text: '72 Hz'}],
  columns: {
    solver: r => r.label,
    sides: r => r.sides,
    resolution: r => r.resolution,
    fps_median: r => r.fps_median,
    fps_low: r => r.fps_low,
    fps_high: r => r.fps_high,
    free_fall_error: r => r.free_fall_error
  },
  still: 'fig4'
});

const bandwidth = doc => by_resolution(doc, {
  id: 'bandwidth',
  title: 'Fig. 5: peak bandwidth by resolution',
  caption:
      'Bytes that shaders load and store, computed from the scene and the kernels, per second of wall time. The bytes of CPU solvers are not known.',
  unit: 'GB/s',
  panels: [['read', r => r.bandwidth_read_peak_B_per_s / 1e9], ['written', r => r.bandwidth_write_peak_B_per_s / 1e9]],
  columns: {
    solver: r => r.label,
    sides: r => r.sides,
    resolution: r => r.resolution,
    bandwidth_read_peak_B_per_s: r => r.bandwidth_read_peak_B_per_s,
    bandwidth_write_peak_B_per_s: r => r.bandwidth_write_peak_B_per_s
  },
  still: 'fig5'
});

/// Stretch against GPU time of each setting; null if no solver has two settings.
function stretch(doc) {
  const all = doc.runs.filter(
      r => r.part === 'rates' && !r.published && r.frame_device_median_s > 0 && r.stretch_max_last_second > 0 &&
          (!r.sides || r.sides === 'single'));
  const several = all.filter(r => all.some(q => q.solver === r.solver && q.family === r.family && q.setting !== r.setting));
  if (!several.length) return null;
  const names = unique(several.map(r => `${r.family} ${r.resolution}`)),
        of = name => all.filter(r => `${r.family} ${r.resolution}` === name);
  return {
    id: 'stretch',
    section: 'rates',
    title: s => `Stretch against GPU time: ${s.Scene}`,
    caption:
        'Maximum stretch of structural edges in the last second of the scene. One mark per setting; filled: no other setting of the solver is faster and stretches less.',
    choices: [{label: 'Scene', options: () => names.map(v => ({value: v, text: v})), first: () => names.at(-1)}],
    rows: s => of(s.Scene).map(r => ({...r, time: 1e3 * r.frame_device_median_s, value: 100 * r.stretch_max_last_second})),
    chart: (rows, s, width) => {
      const fronts = by_solver(rows).map(([solver, mine]) => [solver, on_front(mine, 'time', 'value')]), best = fronts.flatMap(f => f[1]);
      return {
        height: Math.max(240, Math.min(340, 0.5 * width)),
        panels: [{
          x: {type: 'log', title: 'GPU time per frame [ms]'},
          y: {type: 'log', title: 'maximum stretch [%]'},
          lines: fronts.map(([solver, f]) => ({solver, label: solver, points: f.map(r => [r.time, r.value])})),
          marks: rows.map(r => ({kind: 'point', x: r.time, y: r.value, solver: r.solver, open: !best.includes(r), row: r}))
        }]
      };
    },
    tip: r => [r.label, `${number(r.time)} ms, maximum stretch ${number(r.value)} %`],
    columns: {
      solver: r => r.solver,
      setting: r => r.setting,
      frame_device_median_s: r => r.frame_device_median_s,
      stretch_max_last_second: r => r.stretch_max_last_second,
      stretch_mean_last_second: r => r.stretch_mean_last_second
    },
    stills: names.map(v => ({file: `${file_of(v)}-stretch`, state: {Scene: v}}))
  };
}

// Frame times ----------------------------------------------------------------

const kClocks = {
  contact_gpu_time: 'GPU time, frames with contact',
  contact_wall: 'wall time, frames with contact',
  gpu_time: 'GPU time, all frames',
  wall: 'wall time, all frames'
};

const kTimesCaption = 'Mark: median; bar: up to the 95th percentile; line: up to the 99th. Dashed: one refresh of a display.';

function frame_times(doc) {
  const all = doc.runs.filter(r => r.wall && r.setting === 'default'), clocks = Object.keys(kClocks).filter(c => all.some(r => r[c]));
  const solvers = unique(all.map(r => r.solver)), first = clocks.includes('contact_wall') ? 'contact_wall' : 'wall';
  return clocks.length && {
    id: 'frame-times',
    section: 'time',
    hero: true,
    title: s => `Distribution of frame times${s.Solver === 'all' ? '' : `: ${s.Solver}`}`,
    caption: kTimesCaption,
    choices: [
      {label: 'Time', options: () => clocks.map(c => ({value: c, text: kClocks[c]})), first: () => first}, {
        label: 'Solver',
        options: s =>
            [...(unique(all.map(r => r.scene)).length <= 8 ? [{value: 'all', text: 'all'}] : []),
             ...solvers.filter(n => all.some(r => r.solver === n && r[s.Time])).map(n => ({value: n, text: n}))]
      }
    ],
    rows: s => all.filter(r => r[s.Time] && (s.Solver === 'all' || r.solver === s.Solver)).map(r => ({...r, shown: r[s.Time]})),
    chart: rows => {
      const scenes = unique(rows.map(r => r.scene)), present = unique(rows.map(r => r.solver)),
            worst = Math.max(0, ...rows.map(r => 1e3 * r.shown[4]));
      return {
        row: Math.max(22, 13 * present.length + 6),
        right: 20,
        panels: [{
          x: {type: 'log', title: 'time per frame [ms]'},
          y: {type: 'band', values: scenes},
          rules: kRefresh_Hz.filter(hz => worst > 100 / hz).map(hz => ({x: 1e3 / hz, text: `${hz} Hz`, optional: worst < 1e3 / hz / 3})),
          marks: rows.map(r => ({
                            kind: 'point',
                            x: 1e3 * r.shown[0],
                            y: r.scene,
                            shift: present.length > 1 ? (present.indexOf(r.solver) - (present.length - 1) / 2) / (present.length + 0.6) : 0,
                            thick: [1e3 * r.shown[0], 1e3 * r.shown[3]],
                            low: 1e3 * r.shown[0],
                            high: 1e3 * r.shown[4],
                            along: 'x',
                            solver: r.solver,
                            row: r
                          }))
        }]
      };
    },
    tip: r =>
        [`${r.label}, ${r.scene}`, `p50 ${ms(r.shown[0])} (95 %: ${ms(r.shown[1])} to ${ms(r.shown[2])})`,
         `p95 ${ms(r.shown[3])}, p99 ${ms(r.shown[4])}, worst ${ms(r.shown[5])}`, `${r.trials} trials, ${r.trust}`],
    columns: {
      scene: r => r.scene,
      solver: r => r.label,
      p50_s: r => r.shown[0],
      low_s: r => r.shown[1],
      high_s: r => r.shown[2],
      p95_s: r => r.shown[3],
      p99_s: r => r.shown[4],
      worst_s: r => r.shown[5],
      trials: r => r.trials
    },
    stills: [{file: 'frame-times', state: {}}]
  };
}

/// All figures that the document has runs for.
export const make_figures =
    doc => [error_time, rates, bandwidth, stretch, frame_times, verdicts, failure_speed, penetration, forest, stability]
               .map(make => make(doc))
               .filter(Boolean);

/// The choices of a figure with their defaults, where `given` has none that fits.
export function settled(figure, given) {
  const state = {};
  for (const {label, options, first} of figure.choices) {
    const list = options(state).map(o => o.value);
    state[label] = list.includes(given[label]) ? given[label] : first?.(state) ?? list[0] ?? '';
  }
  return state;
}

/// The command that makes one run again, and the file that holds it.
export function command_of(doc, r) {
  const study = doc.studies[r.study];
  if (!study?.command) return null;
  const plain = study.command.replace(/^\S*clothbench/, 'clothbench').replace(/ (--out|-o)[ =]\S+/, '').replace(/ --resume/, '');
  return r.job === undefined || !/ study /.test(plain) ? plain : `${plain} --out again --job ${r.job}`;
}
