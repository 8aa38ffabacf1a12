// The figures of a report: entries over the rows of all runs (`doc.runs`) and their series, drawn by chart.js.
// An entry is made into {id, section, title, caption, hint?, empty, choices, chart(state), rows(state), remark?(state), stills}.
// `choices`: [{label, options(state), first?(state)}]; `state` has the value of each by its label. `stills`: pictures
// [{file, title, state, notes}] in theme 'paper'.
import {chart, unique} from './chart.js';
import {ask_colours} from './theme.js';

const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'crashed', 'error'];
const kNoResult = ['unsupported', 'missing', 'over_budget'];
const kGrades = {
  stable: '#009E73',
  degraded: '#E69F00',
  failed: '#D55E00'
};
const kVerdicts = {
  pass: '#009E73',
  'not measured': '#9AA0A6',
  ignored: '#C9CDD2',
  unsupported: '#E8EAED',
  fail: '#D55E00'
};
/// Title of the axis and factor from SI to its unit.
const kMetrics = {
  contact_length_m: ['contour [mm]', 1e3],
  depth_m: ['depth [mm]', 1e3],
  stretch_max: ['maximum strain [%]', 100]
};
const kDeep_mm = 50;  // from here on an axis of depth is logarithmic above 1 mm, since a cloth that fell through keeps falling

/// The harness without a cloth model is decades faster than every solver. It is drawn only if no other solver is.
let floor = [];
const without_floor = rows => rows.every(r => floor.includes(r.solver)) ? rows : rows.filter(r => !floor.includes(r.solver));
const device_note = rows => unique(rows.map(r => r.gpu).filter(Boolean)).sort().join(', ');
const file_of = name => name.replace(/[^A-Za-z0-9._=-]+/g, '-');
const digits = v => Number(v.toPrecision(2));

/// Pareto front of each label: rows that no row of the same label dominates in both fields, by ascending a.
export const on_front = (rows, a, b) =>
    rows.filter(p => !rows.some(q => q.label === p.label && q[a] <= p[a] && q[b] <= p[b] && (q[a] < p[a] || q[b] < p[b])))
        .sort((p, q) => p[a] - q[a]);

const width_axis = rows => ({
  field: 'width',
  title: 'vertices along one side',
  log: true,
  base: 2,
  format: '.4~g',
  ticks: unique(rows.map(r => r.width)).sort((a, b) => a - b)
});

function rates(runs, family, main) {
  const all = without_floor(runs).map(r => ({
                                        ...r,
                                        shape: r.sides || 'sides not stated',
                                        dash: r.sides || 'sides not stated',
                                        kind: r.fps_median > 0         ? 'both' :
                                            kFailed.includes(r.status) ? 'failed' :
                                                                         '',
                                        fps: r.fps_median,
                                        low: r.fps_median * (1 - (r.fps_spread ?? 0)),
                                        high: r.fps_median * (1 + (r.fps_spread ?? 0))
                                      }));
  const hidden = runs.filter(r => !all.some(a => a.label === r.label) && r.fps_median > 0),
        fps = hidden.map(r => Math.round(r.fps_median).toLocaleString('en-US'));
  return {
    section: 'rates',
    title: `${main ? 'Fig. 4: ' : ''}Frames per second by resolution (${family})`,
    caption: 'Uncapped frame rates. Points: median of the trials. Bars: half their range. A cross on the lower edge: a run that failed. ' +
        (all.some(r => r.published) ? 'Published: values of the paper (Quest 3, capped at 72 Hz, with rendering). ' : ''),
    panels: () => [{
      x: width_axis(all),
      y: {field: 'fps', title: 'frames per second, uncapped', log: true, format: '~s'},
      rows: all,
      rules: [{y: 72, text: '72 Hz, refresh rate of the display'}],
      tip: ['sides', 'resolution']
    }],
    columns: ['label', 'sides', 'width', 'fps', 'low', 'high', 'status'],
    stills: main ? [{
      file: 'fig4',
      notes: [
        hidden.length ? `Not drawn: ${unique(hidden.map(r => r.solver))}, the harness without a cloth model (${fps.at(0)} to ${
                            fps.at(-1)} frames per second).` :
                        '',
        device_note(all)
      ]
    }] :
                   []
  };
}

function bandwidth(runs, family, main) {
  const ways = {read: 'bandwidth_read_peak_B_per_s', written: 'bandwidth_write_peak_B_per_s'}, some = runs.filter(r => r[ways.read] > 0);
  if (!some.length) return null;
  const rows = way =>
      runs.filter(r => r[ways[way]] > 0 || (r.gpu && kFailed.includes(r.status))).map(r => ({
                                                                                        ...r,
                                                                                        way,
                                                                                        GB_per_s: r[ways[way]] / 1e9,
                                                                                        shape: r.sides || 'sides not stated',
                                                                                        dash: r.sides || 'sides not stated',
                                                                                        kind: r[ways[way]] > 0 ? 'both' : 'failed'
                                                                                      }));
  const windows = some.map(r => r.bandwidth_window_s).filter(w => w > 0);
  const absent = unique(runs.filter(r => r.status === 'ok' && !r.published && !some.some(s => s.label === r.label)).map(r => r.solver));
  return {
    section: 'rates',
    title: `${main ? 'Fig. 5: ' : ''}Peak bandwidth by resolution (${family})`,
    caption: 'Bytes that shaders load and store, computed from the scene and the kernels, per second of wall time, peak' +
        (windows.length ? ` over windows of ${digits(Math.min(...windows))} to ${digits(Math.max(...windows))} s` : '') +
        '. The bytes of CPU solvers are not known. The paper publishes its values as a graph only.',
    panels: () => Object.keys(ways).map(way => ({
                                          title: way,
                                          x: width_axis(runs),
                                          y: {field: 'GB_per_s', title: 'peak bandwidth [GB/s]', log: true},
                                          rows: rows(way),
                                          tip: ['sides', 'resolution']
                                        })),
    columns: ['label', 'sides', 'width', 'way', 'GB_per_s'],
    stills: main ? [{file: 'fig5', notes: [absent.length ? `Not known: ${absent.join(', ')}.` : '', device_note(runs)]}] : []
  };
}

/// Stretch against GPU time of each setting, one panel per resolution; null if no solver has two settings.
function stretch(runs, family) {
  let rows = without_floor(runs)
                 .map(r => ({
                        ...r,
                        label: r.solver,
                        ms: 1e3 * r.frame_device_median_s,
                        max: 100 * r.stretch_max_last_second,
                        mean: 100 * r.stretch_mean_last_second
                      }))
                 .filter(r => r.ms > 0 && r.max > 0);
  if (rows.some(r => r.sides === 'single')) rows = rows.filter(r => r.sides === 'single');
  if (!rows.some(r => rows.some(q => q.label === r.label && q.setting !== r.setting))) return null;
  const panel = resolution => {
    const here = rows.filter(r => r.resolution === resolution);
    return {
      title: resolution,
      x: {field: 'ms', title: 'GPU time per frame [ms]', log: true},
      y: {field: 'stretch', title: 'stretch, last second [%]', log: true},
      tip: ['setting', 'sides'],
      rows: ['max', 'mean'].flatMap(of => {
        const some = here.filter(r => r[of] > 0).map(r => ({...r, dash: of, shape: of, stretch: r[of]}));
        return [
          ...some.map(r => ({...r, kind: 'point', text: of === 'max' ? r.setting : ''})),
          ...on_front(some, 'ms', of).map(r => ({...r, kind: 'line'}))
        ];
      })
    };
  };
  return {
    section: 'rates',
    title: `Stretch against GPU time (${family})`,
    caption:
        'Stretch of structural edges in the last second of the scene, maximum and mean, against GPU time per frame. Each point is a setting. ' +
        'Lines join the settings for which no other setting of the solver is faster and stretches less.',
    panels: () => unique([...rows].sort((a, b) => a.width - b.width).map(r => r.resolution)).map(panel),
    columns: ['label', 'setting', 'sides', 'resolution', 'ms', 'max', 'mean'],
    stills: [{file: `${family}-stretch`, notes: [device_note(rows)]}]
  };
}

/// Runs of one scene by one clock; a CPU solver has only wall time.
const work_rows = (runs, clock) => runs.map(r => {
  const ms_per_s = clock === 'wall' ? r.wall_ms_per_s : r.device_ms_per_s ?? r.wall_ms_per_s,
        good = r.status === 'ok' && r.error > 0 && ms_per_s > 0;
  return {...r, label: r.solver, ms_per_s, kind: good ? 'point' : kNoResult.includes(r.status) ? '' : 'failed'};
});

/// Labelled floors of the error. A floor far below every point is stated in a note; drawn, it would compress the axis.
function floors_of(runs) {
  const least = Math.min(...runs.map(r => r.error).filter(e => e > 0)), {space_error, reference_uncertainty} = runs[0];
  return [{y: space_error, what: 'error of the mesh'}, {y: 3 * (reference_uncertainty ?? 0), what: '3 × the reference’s uncertainty'}]
      .filter(f => f.y > 0)
      .map(f => ({...f, text: `${f.what} ${f.y.toExponential(1)}`, far: f.y < 1e-3 * least}));
}

/// Sentences on what the picture does not show.
function work_notes(runs) {
  const rows = work_rows(runs, 'wall'), by_solver = unique(rows.map(r => r.label)).flatMap(label => {
    const mine = rows.filter(r => r.label === label), count = is => mine.filter(is).length;
    if (mine.every(r => ['unsupported', 'missing'].includes(r.status))) return [`${label}: unsupported.`];
    const bad = count(r => r.kind === 'failed'), skipped = count(r => r.status === 'over_budget');
    const parts = [bad ? `${bad} of ${mine.length} failed` : '', skipped ? `${skipped} of ${mine.length} not run` : ''].filter(Boolean);
    return parts.length ? [`${label}: ${parts.join(', ')}.`] : [];
  });
  return [
    rows[0].refused ? `No solver is ranked: ${rows[0].refused}.` : '', by_solver.join(' '),
    ...unique(rows.filter(r => r.not_ranked).map(r => `${r.label} is shown but not ranked: ${r.not_ranked}.`)),
    ...floors_of(runs).filter(f => f.far).map(f => `Below the axis: ${f.text}.`)
  ].filter(Boolean);
}

function work_panel(runs, clock) {
  const rows = work_rows(runs, clock), good = rows.filter(r => r.kind === 'point'), near = floors_of(runs).filter(f => !f.far),
        wall = clock === 'wall';
  const fronts = on_front(good, 'ms_per_s', 'error').map(r => ({...r, kind: 'line', dash: wall ? 'wall time' : 'GPU time'}));
  const on_gpu = wall ? on_front(good.filter(r => r.device_ms_per_s > 0), 'device_ms_per_s', 'error') : [];
  const time = wall ? 'wall time, pipelined where the solver can' : 'GPU time; wall time for CPU solvers';
  return {
    x: {field: 'ms_per_s', title: `${time} [ms per simulated second]`, log: true},
    y: {field: 'error', title: `error: ${runs[0].ranking}`, log: true, format: '.0e'},
    rows: [...fronts, ...on_gpu.map(r => ({...r, kind: 'line', dash: 'GPU time', ms_per_s: r.device_ms_per_s})), ...rows],
    rules: [...near, {x: 1000, text: 'real time'}],
    shade: Math.max(0, ...near.map(f => f.y)),
    edge: 'top',
    tip: ['setting', 'status']
  };
}

function work(runs) {
  const scenes = unique(runs.map(r => r.scene)), in_scene = name => runs.filter(r => r.scene === name);
  const words = name => in_scene(name)[0].refused ? `${name} (refused)` : name;
  return {
    section: 'accuracy',
    id: 'work',
    title: 'Error against run time: every setting',
    caption:
        'Each point is a setting. Lines: the Pareto front of each solver, by wall time and by GPU time. Crosses on the upper edge: runs that ' +
        'failed, at their run time, or at the right end if they have none. Shaded: errors that are not distinguished.',
    hint: 'Hover over a point for its setting.',
    choices: [
      {label: 'Scene', options: () => scenes.map(s => ({value: s, text: words(s)}))}, {
        label: 'Clock',
        options: () =>
            [{value: 'wall', text: 'wall time, pipelined where the solver can'},
             {value: 'device', text: 'GPU time (CPU solvers: wall time)'}]
      }
    ],
    panels: state => [work_panel(in_scene(state.Scene), state.Clock)],
    empty: 'No run of this scene has an error and a time.',
    remark: state => work_notes(in_scene(state.Scene)).join(' '),
    columns: ['scene', 'label', 'setting', 'status', 'ms_per_s', 'error'],
    stills: scenes.map(s => ({
                         file: `work-precision-${s}`,
                         title: `${s}: error against run time`,
                         state: {Scene: s, Clock: 'wall'},
                         notes: [`${s}.`, ...work_notes(in_scene(s)), device_note(in_scene(s))]
                       }))
  };
}

function penetration(all, series) {
  const runs = series.map(s => ({...all[s.run], ...s})), scenes = unique(runs.map(r => r.scene)),
        in_scene = s => without_floor(runs.filter(r => r.scene === s));
  const points = (scene, metric) => in_scene(scene).flatMap(
      r => (r.metrics[metric]?.values ?? [])
               .map((v, k) => ({scene, metric, label: r.label, kind: 'line', time: r.time_s[k], raw: v, value: kMetrics[metric][1] * v}))
               .filter(d => d.raw !== null));
  const metrics = scene => Object.keys(kMetrics).filter(m => points(scene, m).length);
  const panel = (scene, metric, title) => {
    const rows = points(scene, metric), most = Math.max(0, ...rows.map(r => r.value)), log = /depth/.test(metric) && most > kDeep_mm,
          top = most > 1e-3 ? 1.04 * most : 1;
    const failed = in_scene(scene)
                       .filter(r => kFailed.includes(r.status))
                       .map(r => ({label: r.label, kind: 'failed', status: r.status, time: r.time_s.at(-1) ?? 0}));
    return {
      title,
      own_y: true,
      x: {field: 'time', title: 'time [s]'},
      // A line at 0 must be distinguished from the axis.
      y: {
        field: 'value',
        title: kMetrics[metric]?.[0] ?? '',
        symlog: log,
        domain: log ? [-0.15, 1.1 * most] : [-0.04 * top, top],
        format: '.6~g',
        ticks: log ? [0, 1, 10, 100, 1e3, 1e4, 1e5].filter(v => v <= 10 * most) : null
      },
      rows: [...rows, ...failed]
    };
  };
  const kinds = unique(runs.map(r => r.set_up)), of_kind = kind => unique(runs.filter(r => r.set_up === kind).map(r => r.scene));
  return {
    section: 'contact',
    id: 'penetration-series',
    title: 'Penetration over time',
    caption: 'One line per solver, one value per frame. A cross on the lower edge marks the time at which a run failed.',
    empty: 'No run of this scene has this metric.',
    choices: [
      {label: 'Scene', options: () => scenes.map(s => ({value: s, text: s}))},
      // First the metric with a value above 0, because most scenes expect zeros.
      {
        label: 'Metric',
        options: state => metrics(state.Scene).map(m => ({value: m, text: kMetrics[m][0]})),
        first: state => metrics(state.Scene).find(m => points(state.Scene, m).some(d => d.value > 0))
      }
    ],
    panels: state => state.kind ? of_kind(state.kind).flatMap(s => metrics(s).slice(0, 2).map((m, k) => panel(s, m, k ? '' : s))) :
        state.Metric            ? [panel(state.Scene, state.Metric)] :
                                  [],
    columns: ['scene', 'metric', 'label', 'time', 'raw'],
    stills: kinds.map(kind => ({file: `penetration-${kind}`, title: `Penetration over time: ${kind}`, state: {kind}, notes: []})),
    across: 2
  };
}

const bars = (section, id, title, caption, runs, row, of, scale) => ({
  section,
  id,
  title,
  caption,
  panels: () => unique(runs.map(r => r.label)).map(label => {
    const mine = runs.filter(r => r.label === label), names = Object.keys(scale);
    return {
      title: label,
      bars: {share: 'runs', row, of, scale, title: 'share of runs'},
      rows: unique(mine.map(r => r[row]))
                .flatMap(
                    name => names
                                .map((value, order) => ({
                                       label,
                                       [row]: name,
                                       [of]: value,
                                       order,
                                       runs: mine.filter(r => r[row] === name && r[of] === value).length
                                     }))
                                .filter(r => r.runs))
    };
  }),
  columns: ['label', row, of, 'runs'],
  across: 5,
  stills: [{file: id, notes: []}]
});

/// All figures of the document, by section.
export function make_figures(doc) {
  floor = doc.solvers.floor;
  ask_colours(doc.solvers.colours);
  const part = name => doc.runs.filter(r => r.part === name), rated = part('rates'), families = unique(rated.map(r => r.family)),
        main = rated.find(r => r.paper_table === 3)?.family ?? families[0];
  const judged = [
    ...part('contact'), ...part('generated')
  ].map(r => ({
          ...r,
          verdict: r.verdict in kVerdicts      ? r.verdict :
              /^(–|missing)/.test(r.verdict) ? '' :
                                                 'fail'
        })).filter(r => r.verdict);
  const graded = part('stability').filter(r => r.grade >= 0).map(r => ({...r, grade: Object.keys(kGrades)[r.grade]}));
  const entries = [
    ...families.flatMap((f, k) => [['rates', rates], ['bandwidth', bandwidth], ['stretch', stretch]].map(([id, make]) => {
      const entry = make(rated.filter(r => r.family === f), f, f === main);
      return entry && {id: `${id}-${k}`, ...entry};
    })),
    part('accuracy').length && work(part('accuracy')), doc.series.length && penetration(doc.runs, doc.series),
    judged.length &&
        bars(
            'contact', 'verdicts', 'Verdicts by set-up',
            'Share of the runs of each kind of contact that met all acceptance criteria of their scenes.', judged, 'set_up', 'verdict',
            kVerdicts),
    graded.length &&
        bars(
            'stability', 'stability-cases', 'Robustness by case', 'Share of the runs of each case that were stable, degraded or failed.',
            graded, 'case', 'grade', kGrades)
  ].filter(Boolean);
  return entries.map(({panels, columns, across, choices = [], stills, empty = 'There are no data for this choice.', ...rest}) => {
    const rows = state =>
        panels(state).flatMap(p => p.rows).filter(r => r.kind !== 'line' || !panels(state).some(p => p.rows.some(q => q.kind === 'point')));
    const draw = (theme, width, state) => chart({panels: panels(state), across}, theme, width);
    const no_rows = state => !rows(state).some(r => r.kind !== '');
    return {
      ...rest,
      choices,
      empty,
      spec: draw,
      rows: state => [columns, ...rows(state).map(r => columns.map(c => r[c]))],
      stills: stills.map(({file, title = rest.title, state = {}, notes}) => ({
                           file: file_of(file),
                           title,
                           notes,
                           empty: no_rows(state) ? empty : '',
                           labels: unique(panels(state).flatMap(p => p.rows.map(r => r.label))),
                           make: width => draw('paper', width, state)
                         }))
    };
  });
}
