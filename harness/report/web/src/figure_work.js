// Error against run time.
import {beside, colour, device_note, fade, kCross, log_axis, on_front, picked, still_name, symbols, unique} from './figure_parts.js';

const kUncertainty = 'the reference’s uncertainty';
const kNoResult = ['unsupported', 'missing', 'over_budget'];

function data_of(diagram, clock) {
  const rows = diagram.points.map(p => ({
                                    label: p.solver,
                                    setting: p.setting,
                                    status: p.status,
                                    wall: p.wall_ms_per_s,
                                    device: p.device_ms_per_s,
                                    error: p.error,
                                    ranked: !p.not_ranked,
                                    stored_front: p.on_front,
                                    // A CPU solver has one clock.
                                    time: clock === 'wall' ? p.wall_ms_per_s : p.device_ms_per_s ?? p.wall_ms_per_s
                                  }));
  const good = rows.filter(r => r.status === 'ok' && r.error > 0 && r.time > 0);
  const bad = rows.filter(r => !good.includes(r) && !kNoResult.includes(r.status));
  return {
    rows,
    good,
    front: clock === 'wall' ? good.filter(r => r.stored_front) : on_front(good, 'time', 'error'),
    device: clock === 'wall' ?
        on_front(good.filter(r => r.device > 0), 'device', 'error').map(r => ({...r, time: r.device})) :
        [],
    failed: bad.filter(r => r.time > 0),
    untimed: bad.filter(r => !(r.time > 0))
  };
}

/// Labelled floors of the error. A floor far below every point is stated in a note; drawn, it would compress the axis.
function floors_of(diagram, good) {
  const least = Math.min(...good.map(r => r.error));
  return [
    {error: diagram.space_error, what: 'error of the mesh'},
    {error: 3 * (diagram.reference_uncertainty ?? 0), what: `3 × ${kUncertainty}`}
  ].filter(f => f.error > 0)
      .map(f => ({...f, what: `${f.what} ${f.error.toExponential(1)}`, far: f.error < 1e-3 * least}));
}

/// Breaks the long name of an axis into lines.
const lines_of = (text, most) => text.split(' ').reduce(
    (lines, word) => (lines.at(-1) + word).length < most ? [...lines.slice(0, -1), `${lines.at(-1)} ${word}`.trim()] :
                                                           [...lines, word],
    ['']);

/// Layers behind the points: the floors of the error, and real time.
const background = (floors, x, y, height) =>
    [{
      name: 'not_distinguished',
      data: {values: floors.length ? [{error: Math.max(...floors.map(f => f.error))}] : []},
      mark: {type: 'rect', opacity: 0.12, color: '#808080'},
      encoding: {y, y2: {value: height}, x: {value: 0}, x2: {value: 'width'}}
    },
     {name: 'floors', data: {values: floors}, mark: {type: 'rule', strokeDash: [5, 4]}, encoding: {y}}, {
       name: 'floor_text',
       data: {values: floors},
       mark: {type: 'text', align: 'right', baseline: 'bottom', dx: -4, dy: -2},
       encoding: {x: {value: 'width'}, y, text: {field: 'what'}}
     },
     {name: 'real_time', data: {values: [{time: 1000}]}, mark: {type: 'rule', strokeDash: [2, 3]}, encoding: {x}}, {
       name: 'real_time_text',
       data: {values: [{time: 1000}]},
       mark: {type: 'text', align: 'left', baseline: 'top', dx: 4, dy: 4, text: 'real time'},
       encoding: {x, y: {value: 0}}
     }];

function axes_of(diagram, clock, theme, good, floors) {
  const time = clock === 'wall' ? 'wall time, pipelined where the solver can [ms per simulated second]' :
                                  'GPU time; wall time for CPU solvers [ms per simulated second]';
  const error = lines_of(`error: ${diagram.ranking}`, theme === 'paper' ? 48 : 70), scale = {padding: 10};
  return {
    x: log_axis('time', time, good.map(r => r.time).concat(1000), {scale}),
    y: log_axis('error', error, good.map(r => r.error).concat(floors.map(f => f.error)), {scale, axis: {format: '.0e'}})
  };
}

/// `together`: the diagrams whose solvers and ticks it shares.
function work_spec(diagram, clock, theme, width, together = [diagram]) {
  const {good, front, device, failed, untimed} = data_of(diagram, clock);
  const labels = unique(together.flatMap(d => d.points.map(p => p.solver)));
  const color = colour(labels, theme), shape = symbols(labels);
  const opacity = fade(theme), floors = floors_of(diagram, good).filter(f => !f.far);
  const height = theme === 'paper' ? 300 : 400;
  const shared = together.map(d => data_of(d, clock).good);
  const near = together.flatMap((d, k) => floors_of(d, shared[k]).filter(f => !f.far));
  const {x, y} = axes_of(diagram, clock, theme, shared.flat(), near);
  const tip = [
    {field: 'label', title: 'solver'}, {field: 'setting'}, {field: 'time', format: '.4~r', title: 'ms/s'},
    {field: 'error', format: '.3~e'}, {field: 'status'}
  ];
  const faint = {condition: {test: 'datum.ranked', value: 1}, value: 0.4};
  return {
    width: beside(theme, width, 190),
    height,
    data: {values: good},
    layer: [
      ...background(floors, x, y, height),
      {
        name: 'fronts',
        data: {values: front},
        mark: {type: 'line', strokeWidth: 2.2},
        encoding: {x, y, color, opacity: theme === 'paper' ? faint : opacity}
      },
      {
        name: 'device_fronts',
        data: {values: device},
        mark: {type: 'line', strokeWidth: 1, strokeDash: [5, 3]},
        encoding: {x, y, color, opacity}
      },
      {
        name: 'points',
        ...picked(theme),
        mark: {type: 'point', size: theme === 'paper' ? 24 : 42, strokeWidth: 1},
        encoding: {x, y, color, shape, opacity, tooltip: tip}
      },
      {
        name: 'front_points',
        data: {values: front},
        mark: {type: 'point', filled: true, size: 46, aria: false},
        encoding: {x, y, color, shape, opacity: theme === 'paper' ? faint : opacity, tooltip: tip}
      },
      {
        name: 'failed',
        data: {values: failed},
        mark: {...kCross, size: 50},
        encoding: {x, y: {value: 0}, color, tooltip: tip}
      },
      {
        name: 'untimed',
        data: {values: untimed},
        mark: {...kCross, size: 50},
        encoding: {x: {value: 'width'}, y: {value: 0}, color, tooltip: tip}
      },
    ]
  };
}

/// A grid's diagram and that of the same scene as a mesh, on common axes.
function pair_spec(pair, width) {
  const panel = (diagram, k) => {
    const {layer, ...spec} = work_spec(diagram, 'wall', 'paper', width / 2 - 30, pair);
    for (const one of layer) {
      if (one.name === 'floor_text')
        one.data = {values: one.data.values.map(f => ({...f, what: f.what.replace(kUncertainty, 'U_ref')}))};
      one.name += `_${k}`;  // names must be unique
      const {x, y} = one.encoding;
      if (x?.title) one.encoding.x = {...x, title: lines_of(x.title, 36)};
      if (k && y?.title) one.encoding.y = {...y, title: null};
    }
    const title = {text: `${k ? 'mesh' : 'grid'}: ${diagram.scene}`, anchor: 'start', fontWeight: 'bold'};
    return {...spec, layer, title};
  };
  return {hconcat: pair.map(panel), resolve: {scale: {x: 'shared', y: 'shared'}}};
}

/// Sentences on what the picture does not show.
function notes_of(diagram) {
  const {rows, good, failed, untimed} = data_of(diagram, 'wall'), bad = [...failed, ...untimed];
  const out = unique(rows.map(r => r.label)).flatMap(label => {
    const mine = rows.filter(r => r.label === label), count = list => list.filter(r => r.label === label).length;
    if (mine.every(r => ['unsupported', 'missing'].includes(r.status))) return [`${label}: unsupported.`];
    const skipped = count(rows.filter(r => r.status === 'over_budget'));
    const parts = [
      count(bad) ? `${count(bad)} of ${mine.length} failed` : '', skipped ? `${skipped} of ${mine.length} not run` : ''
    ].filter(Boolean);
    return parts.length ? [`${label}: ${parts.join(', ')}.`] : [];
  });
  return [
    diagram.refused ? `No solver is ranked: ${diagram.refused}.` : '', out.join(' '),
    ...Object.entries(diagram.not_ranked).map(([solver, why]) => `${solver} is shown but not ranked: ${why}.`),
    ...floors_of(diagram, good).filter(f => f.far).map(f => `Below the axis: ${f.what}.`)
  ].filter(Boolean);
}

export function work_figure(diagrams) {
  const named = Object.fromEntries(diagrams.map(d => [d.scene, d])), at = state => named[state.Scene];
  const words = d => d.refused ? `${d.scene} (refused)` : d.scene;
  const still = d => ({
    file: still_name(`work-precision-${d.scene}`),
    title: `${d.scene}: error against run time`,
    labels: unique(d.points.map(p => p.solver)),
    empty: data_of(d, 'wall').good.length ? '' : 'No run of this scene has an error and a time.',
    notes: [
      `${d.scene}. Thick: fronts. Dashed: fronts by GPU time. Shaded: solvers are not distinguished. ×: failed.`,
      ...notes_of(d), device_note(d.points)
    ],
    make: w => work_spec(d, 'wall', 'paper', w)
  });
  const pairs = diagrams.filter(d => d.grid_scene in named).map(d => [named[d.grid_scene], d]);
  const pair_still = pair => {
    const points = pair.flatMap(d => d.points), labels = unique(points.map(p => p.solver));
    return {
      file: still_name(`work-precision-${pair[0].scene}-beside-mesh`),
      title: `${pair[0].scene} as a grid and as a triangle mesh: error against run time`,
      labels,
      empty: pair.every(d => data_of(d, 'wall').good.length) ? '' :
                                                               'One of the two has no run with an error and a time.',
      notes: [
        'Thick: fronts. Dashed: fronts by GPU time. Shaded: solvers are not distinguished. ×: failed. Errors of a ' +
            'grid are against the exact solution of the same grid, those of a mesh against the continuum’s. U_ref: ' +
            `${kUncertainty}.`,
        ...pair.flatMap(d => notes_of(d).map(n => `${d.scene}: ${n}`)), device_note(points)
      ],
      make: w => pair_spec(pair, w)
    };
  };
  return {
    id: 'work',
    title: 'Error against run time: every setting',
    spec: (theme, width, state) => work_spec(at(state), state.Clock, theme, width),
    remark: state => notes_of(at(state)).join(' '),
    choices: [
      {label: 'Scene', options: () => diagrams.map(d => ({value: d.scene, text: words(d)}))}, {
        label: 'Clock',
        options: () =>
            [{value: 'wall', text: 'wall time, pipelined where the solver can'},
             {value: 'device', text: 'GPU time (CPU solvers: wall time)'}]
      }
    ],
    caption: 'Each point is a setting. Thick lines: the front of each solver. Dashed lines: the front by GPU ' +
        'time. Crosses on the upper edge: runs that failed, at their run time, or at the right end if they ' +
        'have none. Dotted: real time (1000 ms/s). Shaded: below the floors, where errors are not ' +
        'distinguished.',
    hint: 'Hover over a point for its setting.',
    rows: state => [
        ['scene', 'solver', 'setting', 'status', 'ms_per_s', 'error', 'on_front'],
        ...data_of(at(state), state.Clock)
            .rows.map(r => [state.Scene, r.label, r.setting, r.status, r.time, r.error, r.stored_front])],
    stills: [...diagrams.map(still), ...pairs.map(pair_still)]
  };
}
