// Penetration over time.
import {select} from './dom.js';
import {colour, fade, kFailed, picked, unique} from './figure_parts.js';
import {plot_figure} from './plot.js';

export function penetration_figure(ups) {
  const scenes = ups.flatMap(u => u.scenes.map(s => ({...s, kind: u.title})));
  let at = scenes[0], metric = '', figure = null;
  // What the registry of metrics says of those that the scene has, by name.
  const known = () => Object.assign({}, ...at.rows.map(r => r.metrics));
  const words = () => known()[metric]?.words ?? '';
  const choose = select('Metric', [], '', v => {
    metric = v;
    figure.redraw();
  });
  const refill = () => {
    const told = known(), list = Object.keys(told).sort((a, b) => told[a].place - told[b].place);
    // The first that shows something: most scenes are meant to be all zero.
    const shows = m => at.rows.some(r => r.solver !== 'ballistic' && r.metrics[m]?.values.some(v => v > 0));
    if (!list.includes(metric)) metric = list.find(shows) ?? list[0] ?? '';
    choose.querySelector('select').replaceChildren(
        ...list.map(
            m => Object.assign(new Option(told[m].words, m, m === metric, m === metric), {title: told[m].long_name})));
  };
  const data = () =>
      at.rows.filter(r => r.solver !== 'ballistic')
          .flatMap(
              r => (r.metrics[metric]?.values ?? [])
                       .map((value, k) => ({
                              label: r.label,
                              time: r.time_s[k],
                              value,
                              failed: kFailed.includes(r.status) && k === Math.min(r.failed_frame, r.time_s.length - 1)
                            }))
                       .filter(d => d.value !== null));
  const spec = (theme, width) => {
    const rows = data(), labels = unique(at.rows.map(r => r.label).filter(l => !l.startsWith('ballistic'))),
          color = colour(labels, theme);
    const x = {field: 'time', type: 'quantitative', title: 'time [s]', axis: {tickCount: 10, grid: false}}, y = {
      field: 'value',
      type: 'quantitative',
      title: words(),
      axis: {format: '~g', tickCount: 6},
      ...(rows.some(r => r.value > 0) ? {} : {scale: {domain: [0, 1]}})
    };
    return {
      width: width - 220,
      height: 320,
      data: {values: rows},
      layer: [
        {name: 'lines', mark: {type: 'line', strokeWidth: 1.8}, encoding: {x, y, color, opacity: fade}},
        {
          name: 'points',
          ...picked,
          mark: {type: 'point', filled: true, size: 50, aria: false},
          encoding: {
            x,
            y,
            color,
            opacity: {value: 0},
            tooltip: [
              {field: 'label', title: 'solver'}, {field: 'time', format: '.3f', title: 's'},
              {field: 'value', format: '.4~g', title: words()}
            ]
          }
        },
        {
          name: 'failed',
          transform: [{filter: 'datum.failed'}],
          mark: {type: 'point', shape: 'cross', angle: 45, filled: true, size: 80},
          encoding: {x, y, color}
        },
      ]
    };
  };
  refill();
  figure = plot_figure({
    id: 'penetration-series',
    title: 'Penetration over time',
    spec,
    empty: 'This scene has no such series.',
    controls: [
      select(
          'Scene', scenes.map(s => ({value: s.name, text: s.name})), at.name,
          v => {
            at = scenes.find(s => s.name === v);
            refill();
            figure.redraw();
          }),
      choose
    ],
    caption:
        'One line a solver, one value a frame. A cross: where a run failed. Ballistic, which nothing stops, is left out.',
    rows: () => [
        ['scene', 'metric', 'solver', 'time_s', 'value'],
        ...data().map(d => [at.name, metric, d.label, d.time, d.value])]
  });
  return figure;
}
