// Stretch against time, a panel a resolution.
import {across_of, beside, colour, device_note, fade, log_axis, on_front, picked, still_name, symbols, unique, without_floor} from './figure_parts.js';

const dash_of = {
  field: 'of',
  type: 'nominal',
  title: 'stretch',
  scale: {domain: ['greatest', 'mean'], range: [[1, 0], [2, 3]]},
  legend: {symbolType: 'stroke', symbolSize: 300}
};

/// Runs with a stretch and a time of the GPU; single-sided ones where there are any.
function points_of(family) {
  const all = without_floor(family.series)
                  .flatMap(s => s.points.map(p => ({
                                               label: s.solver,
                                               setting: s.setting || 'default',
                                               sides: s.sides || 'not stated',
                                               width: p.width,
                                               resolution: p.resolution,
                                               ms: 1e3 * p.device_s,
                                               greatest: 100 * p.stretch_max,
                                               mean: 100 * p.stretch_mean,
                                               gpu: p.gpu
                                             })))
                  .filter(r => r.ms > 0 && r.greatest > 0);
  const single = all.filter(r => r.sides === 'single');
  return single.length ? single : all;
}

function stretch_spec(points, labels, theme, width) {
  const panels = unique([...points].sort((a, b) => a.width - b.width).map(r => r.resolution));
  const rows = ['greatest', 'mean'].flatMap(of => panels.flatMap(resolution => {
    const here = points.filter(r => r.resolution === resolution && r[of] > 0), front = on_front(here, 'ms', of);
    return here.map(r => ({...r, of, stretch: r[of], front: front.includes(r)}));
  }));
  const color = colour(labels, theme), opacity = fade(theme), across = across_of(panels.length, 3);
  const scale = {padding: 12}, axis = {labelOverlap: true, labelSeparation: 4};
  const x = log_axis('ms', 'GPU time a frame [ms]', rows.map(r => r.ms), {scale, axis});
  const y = log_axis('stretch', 'stretch, last second [%]', rows.map(r => r.stretch), {scale});
  const tip = [
    {field: 'label', title: 'solver'}, {field: 'setting'}, {field: 'sides'}, {field: 'ms', format: '.4~g', title: 'ms'},
    {field: 'of', title: 'stretch'}, {field: 'stretch', format: '.4~g', title: '%'}
  ];
  return {
    data: {values: rows},
    columns: across,
    facet: {field: 'resolution', type: 'nominal', title: null, sort: panels},
    spec: {
      width: Math.max(110, beside(theme, width, 200) / across - 24),
      height: 200,
      layer: [
        {
          name: 'lines',
          transform: [{filter: 'datum.front'}],
          mark: {type: 'line', strokeWidth: 1},
          encoding: {x, y, color, opacity, strokeDash: dash_of}
        },
        {
          name: 'points',
          ...picked(theme),
          mark: {type: 'point', filled: true, size: 40},
          encoding: {x, y, color, shape: symbols(labels), opacity, tooltip: tip}
        },
        {
          name: 'settings',
          transform: [{filter: 'datum.of === \'greatest\''}],
          mark: {type: 'text', align: 'left', baseline: 'bottom', dx: 3, dy: -3, fontSize: 8, aria: false},
          encoding: {x, y, color, text: {field: 'setting'}}
        }
      ]
    }
  };
}

/// Stretch against GPU time of each setting, one panel per resolution. Null if no solver has two settings.
export function stretch_figure(family, index) {
  const points = points_of(family);
  const settings = solver => unique(points.filter(r => r.label === solver).map(r => r.setting)).length;
  if (!points.some(r => settings(r.label) > 1)) return null;
  const labels = unique(points.map(r => r.label)), spec = (theme, width) => stretch_spec(points, labels, theme, width);
  const title = `Stretch against GPU time (${family.name})`;
  return {
    id: `stretch-${index}`,
    title,
    spec,
    caption:
        'Stretch of structural edges in the last second of the scene, greatest and mean, against GPU time per frame. ' +
        'Each point is a setting. Lines join the settings for which no other setting of the solver is faster and stretches less.',
    rows: () => [
        ['solver', 'setting', 'sides', 'resolution', 'ms', 'greatest_percent', 'mean_percent'],
        ...points.map(r => [r.label, r.setting, r.sides, r.resolution, r.ms, r.greatest, r.mean])],
    stills: [{
      file: still_name(`${family.name}-stretch`),
      title,
      labels,
      notes: [device_note(points)],
      make: w => spec('paper', w)
    }]
  };
}
