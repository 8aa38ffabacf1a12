// Error against run time.
import {select} from './dom.js';
import {colour, decades, fade, picked, unique} from './figure_parts.js';
import {plot_figure} from './plot.js';

/// Points with nothing of the same solver both faster and more accurate, by the given clock.
function on_front(points, time) {
  return points.filter(
      p => !points.some(
          q => q.label === p.label && q[time] <= p[time] && q.error <= p.error &&
              (q[time] < p[time] || q.error < p.error)));
}

export function work_figure(diagrams) {
  let at = diagrams[0], clock = 'wall';
  let figure = null;
  const data = () => {
    const rows = at.points.map(p => ({
                                 label: p.solver,
                                 setting: p.setting,
                                 status: p.status,
                                 wall: p.wall_ms_per_s,
                                 error: p.error,
                                 stored_front: p.on_front,
                                 // A CPU has one clock.
                                 time: clock === 'wall' ? p.wall_ms_per_s : p.device_ms_per_s ?? p.wall_ms_per_s
                               }));
    const good = rows.filter(r => r.status === 'ok' && r.error > 0 && r.time > 0);
    return {
      rows,
      good,
      front: clock === 'wall' ? good.filter(r => r.stored_front) : on_front(good, 'time'),
      failed: rows.filter(r => !good.includes(r) && r.status !== 'unsupported')
    };
  };
  const spec = (theme, width) => {
    const {rows, good, front, failed} = data(), labels = unique(rows.map(r => r.label)), color = colour(labels, theme);
    const floors = [
      {error: at.space_error, what: 'error of the mesh'},
      {error: at.reference_uncertainty === null ? null : 3 * at.reference_uncertainty, what: '3 U_ref'}
    ].filter(f => f.error > 0);
    const x = {
      field: 'time',
      type: 'quantitative',
      title: 'ms of computing per simulated second',
      scale: {type: 'log', padding: 10},
      axis: {format: ',~r', values: decades(good.map(r => r.time).concat(1000))}
    };
    const y = {
      field: 'error',
      type: 'quantitative',
      title: at.ranking,
      scale: {type: 'log', padding: 10},
      axis: {format: '.0e', values: decades(good.map(r => r.error).concat(floors.map(f => f.error)))}
    };
    const tip = [
      {field: 'label', title: 'solver'}, {field: 'setting'}, {field: 'time', format: '.4~r', title: 'ms/s'},
      {field: 'error', format: '.3~e'}, {field: 'status'}
    ];
    return {
      width: width - 190,
      height: 400,
      data: {values: good},
      layer: [
        {name: 'floors', data: {values: floors}, mark: {type: 'rule', strokeDash: [5, 4]}, encoding: {y}},
        {
          name: 'floor_text',
          data: {values: floors},
          mark: {type: 'text', align: 'right', baseline: 'bottom', dx: -4, dy: -2},
          encoding: {x: {value: 'width'}, y, text: {field: 'what'}}
        },
        {name: 'real_time', data: {values: [{time: 1000}]}, mark: {type: 'rule', strokeDash: [2, 3]}, encoding: {x}},
        {
          name: 'fronts',
          data: {values: front},
          mark: {type: 'line', strokeWidth: 2.6},
          encoding: {x, y, color, opacity: fade}
        },
        {
          name: 'points',
          ...picked,
          mark: {type: 'point', size: 42},
          encoding: {x, y, color, opacity: fade, tooltip: tip}
        },
        {
          name: 'front_points',
          data: {values: front},
          mark: {type: 'point', filled: true, size: 46, aria: false},
          encoding: {x, y, color, opacity: fade, tooltip: tip}
        },
        {
          name: 'failed',
          data: {values: failed},
          mark: {type: 'point', shape: 'cross', angle: 45, filled: true, size: 50},
          encoding: {x, y: {value: 0}, color, tooltip: tip}
        },
      ]
    };
  };
  const remark =
      () => [at.refused ? `Ranks nobody: ${at.refused}.` : '',
             ...Object.entries(at.not_ranked).map(([solver, why]) => `${solver} is shown but not ranked: ${why}.`)]
                .filter(Boolean)
                .join(' ');
  const words = d => d.refused ? `${d.scene} (refused)` : d.scene;
  figure = plot_figure({
    id: 'work',
    title: 'Error against run time: every setting',
    spec,
    remark,
    controls: [
      select(
          'Scene', diagrams.map(d => ({value: d.scene, text: words(d)})), at.scene,
          v => {
            at = diagrams.find(d => d.scene === v);
            figure.redraw();
          }),
      select(
          'Clock', [{value: 'wall', text: 'wall, submit to fence'}, {value: 'device', text: 'GPU (CPU solvers: wall)'}],
          clock,
          v => {
            clock = v;
            figure.redraw();
          })
    ],
    caption:
        'Every point a setting, thick each solver’s front; crosses on the upper edge: cells that failed, by their ' +
        'time where they have one. Dotted: real time (1000 ms/s). Hover for the setting.',
    rows: () => [
        ['scene', 'solver', 'setting', 'status', 'ms_per_s', 'error', 'on_front'],
        ...data().rows.map(r => [at.scene, r.label, r.setting, r.status, r.time, r.error, r.stored_front])]
  });
  return figure;
}
