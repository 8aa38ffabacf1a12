// Figures of contact and stability: entries as in figures.js.
import {number, unique} from './chart.js';
import {by_solver, file_of, percent, without_floor} from './figure_parts.js';

/// 95 % interval of a share: Wilson's score.
export function wilson(passed, all) {
  const z = 1.959964, p = passed / all, d = 1 + z * z / all, middle = (p + z * z / (2 * all)) / d,
        half = z / d * Math.sqrt(p * (1 - p) / all + z * z / (4 * all * all));
  return [Math.max(0, middle - half), Math.min(1, middle + half)];
}

// Contact --------------------------------------------------------------------

const kVerdicts = {
  pass: ['pass', '✓'],
  fail: ['fail', '×'],
  ignored: ['ignored', '○'],
  unsupported: ['none', '–'],
  'not measured': ['none', '·'],
  missing: ['none', '·']
};
const tone_of = v => kVerdicts[v] ?? (v.startsWith('–') ? kVerdicts.missing : ['fail', '×']);
const why = r => r.violated?.map(([name, found]) => `${name} = ${found === null ? 'not met' : number(found)}`) ?? [];

export function verdicts(doc) {
  const all = doc.runs.filter(r => r.part === 'contact' && !doc.solvers.baseline.includes(r.solver) && !r.verdict.startsWith('–'));
  if (!all.length) return null;
  return {
    id: 'verdicts',
    section: 'contact',
    hero: true,
    title: () => 'Verdicts by scene and solver',
    caption: 'Passed: the run meets every acceptance criterion of its scene. Select a cell for the criteria that a run violates.',
    choices: [],
    rows: () => all,
    chart: (rows, s, width) => {
      const scenes = unique(rows.map(r => r.scene)), labels = unique(rows.map(r => r.label)), tall = width < 740 || scenes.length < 12;
      const solver_axis = {type: 'band', values: labels},
            scene_axis = {type: 'band', values: scenes, text: v => v.length > 30 ? `${v.slice(0, 29)}…` : v};
      return {
        row: tall ? 18 : 24,
        tones: [['pass', 'pass'], ['fail', 'fail'], ['ignored', 'ignored: no contact simulated'], ['none', 'unsupported, or not measured']],
        panels: [{
          x: tall ? solver_axis : scene_axis,
          y: tall ? scene_axis : solver_axis,
          marks: rows.map(r => {
            const [tone, glyph] = tone_of(r.verdict);
            return {kind: 'cell', x: tall ? r.label : r.scene, y: tall ? r.scene : r.label, tone, glyph, solver: r.solver, row: r};
          })
        }]
      };
    },
    tip: r => [`${r.label}, ${r.scene}: ${r.verdict}`, ...why(r), ...(r.message ? [r.message] : [])],
    columns: {scene: r => r.scene, solver: r => r.label, verdict: r => r.verdict, violated: r => why(r).join('; ')},
    stills: [{file: 'verdicts', state: {}}]
  };
}

/// The scene without its speed: "capsule-sweep-0p8mps" and "stretch[v=2]" are of one kind.
const kind_of = scene => scene.replace(/-?\d+(p\d+)?mps.*$|\[.*\]$/, '').replace(/-at$/, '');

export function failure_speed(doc) {
  const all = doc.runs.filter(
      r => r.part === 'contact' && r.speed > 0 && ['pass', 'fail'].includes(tone_of(r.verdict)[0]) && r.setting === 'default');
  const kinds =
      unique(all.map(r => kind_of(r.scene))).filter(k => unique(all.filter(r => kind_of(r.scene) === k).map(r => r.speed)).length > 1);
  if (!kinds.length) return null;
  return {
    id: 'failure-speed',
    section: 'contact',
    title: () => 'Speeds that are passed and failed',
    caption: 'Filled: the run passed at this speed of the hand; hollow: it failed. Runs whose criteria were not measured are not drawn.',
    choices: [],
    rows: () => all.filter(r => kinds.includes(kind_of(r.scene))),
    chart: rows => {
      const names =
          by_solver(rows)
              .flatMap(
                  ([solver]) =>
                      kinds.filter(k => rows.some(r => r.solver === solver && kind_of(r.scene) === k)).map(k => `${k} · ${solver}`))
              .sort();
      return {
        row: 18,
        panels: [{
          x: {type: 'log', title: 'speed [m/s]'},
          y: {type: 'band', values: names},
          marks: rows.map(r => ({
                            kind: 'point',
                            x: r.speed,
                            y: `${kind_of(r.scene)} · ${r.solver}`,
                            open: r.verdict !== 'pass',
                            solver: r.solver,
                            row: r
                          }))
        }]
      };
    },
    tip: r => [`${r.label}, ${r.scene}`, `${number(r.speed)} m/s: ${r.verdict}`, ...why(r)],
    columns: {scene: r => r.scene, solver: r => r.label, speed_m_per_s: r => r.speed, verdict: r => r.verdict},
    stills: [{file: 'failure-speed', state: {}}]
  };
}

const kMetrics = {
  contact_length_m: ['intersection contour [mm]', 1e3],
  depth_m: ['depth [mm]', 1e3],
  stretch_max: ['maximum strain [%]', 100]
};

/// One line per solver over time; `doc.series` is unpacked when it is first needed.
export function penetration(doc) {
  if (doc.series === undefined) return null;
  const loaded = () => Array.isArray(doc.series), runs = () => loaded() ? doc.series.map(s => ({...doc.runs[s.run], ...s})) : [];
  const scenes = unique(doc.runs.filter(r => r.part === 'contact').map(r => r.scene));
  return {
    id: 'penetration',
    section: 'contact',
    needs_series: true,
    title: s => `Penetration over time: ${s.Scene}`,
    caption: 'One line per solver, one value per frame.',
    empty: 'No run of this scene has this metric.',
    choices: [
      {
        label: 'Scene',
        options: () => scenes.map(v => ({value: v, text: v})),
        first: () =>
            scenes.find(v => /push/.test(v)) ?? runs().find(r => r.metrics.contact_length_m?.values.some(v => v > 0))?.scene ?? scenes[0]
      },
      {label: 'Metric', options: () => Object.entries(kMetrics).map(([value, [words]]) => ({value, text: words}))}
    ],
    rows: s =>
        without_floor(runs().filter(r => r.scene === s.Scene && r.metrics[s.Metric]), doc.solvers.floor)
            .flatMap(
                r => r.metrics[s.Metric].values.map(
                    (v, k) => ({...r, metrics: null, time: r.time_s[k], value: v, shown: v === null ? null : kMetrics[s.Metric][1] * v})))
            .filter(r => r.value !== null),
    chart: (rows, s, width) => ({
      right: 90,
      height: Math.max(220, Math.min(300, 0.45 * width)),
      panels: [{
        x: {type: 'linear', title: 'time [s]'},
        y: {type: 'linear', title: kMetrics[s.Metric]?.[0] ?? '', domain: [0, 1.04 * Math.max(...rows.map(r => r.shown)) || 1]},
        lines: unique(rows.map(r => r.label))
                   .map(label => rows.filter(r => r.label === label))
                   .map(mine => ({solver: mine[0].solver, label: mine[0].label, points: mine.map(r => [r.time, r.shown])})),
        marks: []
      }]
    }),
    columns: {scene: r => r.scene, solver: r => r.label, time_s: r => r.time, value: r => r.value},
    stills: scenes.slice(0, 6).map(v => ({file: `penetration-${file_of(v)}`, state: {Scene: v}}))
  };
}

// Generated contact, stability -----------------------------------------------

export function forest(doc) {
  const all = doc.runs.filter(r => r.part === 'generated' && r.status !== 'missing' && !r.verdict.startsWith('–'));
  if (!all.length) return null;
  const kinds = ['all', ...unique(all.map(r => r.kind)).sort()], labels = unique(all.map(r => r.label));
  const rows = labels
                   .flatMap(label => kinds.map(kind => {
                     const mine = all.filter(r => r.label === label && (kind === 'all' || r.kind === kind)),
                           passed = mine.filter(r => r.verdict === 'pass').length;
                     const [low, high] = mine.length ? wilson(passed, mine.length) : [0, 1];
                     return {
                       solver: mine[0]?.solver ?? label,
                       label,
                       kind,
                       passed,
                       scenes: mine.length,
                       unsupported: mine.filter(r => r.status === 'unsupported').length,
                       low,
                       high
                     };
                   }))
                   .filter(r => r.scenes);
  return {
    id: 'forest',
    section: 'generated',
    hero: true,
    title: () => 'Pass rate by kind of generated scene',
    caption:
        'Share of scenes that meet every acceptance criterion, with the 95 % interval (Wilson). Unsupported scenes count as not passed.',
    choices: [],
    rows: () => rows,
    chart: (given, s, width) => ({
      right: 16,
      columns: width < 560 ? 2 : Math.min(6, labels.length),
      panels: unique(given.map(r => r.label)).map(label => {
        const mine = given.filter(r => r.label === label);
        return {
          title: label,
          solver: mine[0].solver,
          x: {type: 'linear', domain: [0, 1], ticks: [0, 0.5, 1], format: t => `${100 * t} %`, title: ''},
          y: {type: 'band', values: kinds},
          marks: mine.map(
              r => r.unsupported === r.scenes ?
                  {kind: 'none', x: 0.02, y: r.kind, solver: r.solver, note: 'unsupported', row: r} :
                  {kind: 'point', x: r.passed / r.scenes, y: r.kind, low: r.low, high: r.high, along: 'x', solver: r.solver, row: r})
        };
      })
    }),
    tip: r => [`${r.label}, ${r.kind}`, `${r.passed} of ${r.scenes} passed (95 %: ${percent(r.low)} to ${percent(r.high)})`],
    columns: {
      solver: r => r.label,
      kind: r => r.kind,
      passed: r => r.passed,
      scenes: r => r.scenes,
      unsupported: r => r.unsupported,
      low: r => r.low,
      high: r => r.high
    },
    stills: [{file: 'forest', state: {}}]
  };
}

const kGrades = ['stable', 'degraded', 'failed'];

export function stability(doc) {
  const all = doc.runs.filter(r => r.part === 'stability' && (r.grade >= 0 || r.status === 'unsupported'));
  if (!all.length) return null;
  const cases = unique(all.map(r => r.case)).sort(),
        rows = unique(all.map(r => r.label))
                   .flatMap(label => cases.map(name => {
                     const mine = all.filter(r => r.label === label && r.case === name),
                           counts = kGrades.map((_, k) => mine.filter(r => r.grade === k).length);
                     return {
                       solver: mine[0]?.solver,
                       label,
                       case: name,
                       counts,
                       runs: counts.reduce((a, b) => a + b, 0),
                       row: mine.find(r => r.grade > 0) ?? mine[0]
                     };
                   }))
                   .filter(r => r.solver);
  return {
    id: 'stability',
    section: 'stability',
    hero: true,
    title: () => 'Stable runs by case',
    caption:
        'Stable runs of all runs of a case. A run is degraded if only its strain is beyond the load, and failed with any other failure class.',
    choices: [],
    rows: () => rows,
    chart: (given, s, width) => {
      const labels = unique(given.map(r => r.label));
      return {
        row: 18,
        tones: [['pass', 'all stable'], ['part', 'some stable or degraded'], ['fail', 'none stable'], ['none', 'unsupported']],
        panels: [{
          x: {type: 'band', values: labels},
          y: {type: 'band', values: cases},
          marks: given.map(r => ({
                             kind: 'cell',
                             x: r.label,
                             y: r.case,
                             solver: r.solver,
                             row: r,
                             glyph: r.runs ? `${r.counts[0]}/${r.runs}` : '–',
                             tone: !r.runs                     ? 'none' :
                                 r.counts[0] === r.runs        ? 'pass' :
                                 r.counts[0] + r.counts[1] > 0 ? 'part' :
                                                                 'fail'
                           }))
        }]
      };
    },
    tip: r => [`${r.label}, ${r.case}`, kGrades.map((g, k) => `${r.counts[k]} ${g}`).join(', ')],
    columns: {solver: r => r.label, case: r => r.case, stable: r => r.counts[0], degraded: r => r.counts[1], failed: r => r.counts[2]},
    stills: [{file: 'stability-cases', state: {}}]
  };
}
