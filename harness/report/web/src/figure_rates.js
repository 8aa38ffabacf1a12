// Figs. 4 and 5, as Vega-Lite specifications.
import {colour, decades, fade, kFailed, picked, unique} from './figure_parts.js';
import {plot_figure} from './plot.js';

const kSides = {
  domain: ['single', 'double-duplicated', 'double', 'not stated'],
  dash: [[1, 0], [6, 4], [2, 3], [1, 0]],
  shape: ['circle', 'square', 'triangle-up', 'circle']
};
const is_floor = s => s.solver === 'ballistic';  // what the harness itself costs: no cloth solver

function rate_rows(family) {
  const rows = [];
  for (const s of family.series)
    for (const p of s.points)
      if (!is_floor(s))
        rows.push({
          label: s.label,
          sides: s.sides || 'not stated',
          width: p.width,
          resolution: p.resolution,
          status: p.status,
          fps: p.fps,
          low: p.fps * (1 - (p.spread ?? 0)),
          high: p.fps * (1 + (p.spread ?? 0)),
          read: p.read_B_per_s,
          write: p.write_B_per_s
        });
  for (const s of family.published ?? [])
    for (const p of s.points)
      rows.push({
        label: `published: ${s.label}`,
        sides: kSides.domain.includes(s.sides) ? s.sides : 'not stated',
        width: p.width,
        resolution: `${p.width}²`,
        status: 'ok',
        fps: p.fps,
        low: p.fps,
        high: p.fps
      });
  return rows;
}

const width_axis = rows => ({
  field: 'width',
  type: 'quantitative',
  title: 'vertices along one side',
  scale: {type: 'log', base: 2, nice: false, padding: 14},
  axis: {values: unique(rows.map(r => r.width)).sort((a, b) => a - b), format: '.4~g', grid: false}
});
const side_encoding = rows => {
  const used = kSides.domain.filter(s => rows.some(r => r.sides === s));
  const pick = list => used.map(s => list[kSides.domain.indexOf(s)]);
  const title = 'sides';
  return {
    strokeDash: {field: 'sides', type: 'nominal', title, scale: {domain: used, range: pick(kSides.dash)}},
    shape: {field: 'sides', type: 'nominal', title, scale: {domain: used, range: pick(kSides.shape)}}
  };
};

export function rates_figure(family, index) {
  const all = rate_rows(family), good = all.filter(r => r.fps > 0),
        failed = all.filter(r => kFailed.includes(r.status));
  const labels = unique(all.map(r => r.label)), sides = side_encoding(all);
  const tip = [
    {field: 'label', title: 'solver'}, {field: 'sides'}, {field: 'resolution'},
    {field: 'fps', format: ',.4~r', title: 'frames/s'}, {field: 'low', format: ',.4~r'},
    {field: 'high', format: ',.4~r'}
  ];
  const spec = (theme, width) => {
    const x = width_axis(all), color = colour(labels, theme);
    const y = {
      field: 'fps',
      type: 'quantitative',
      title: 'frames per second',
      scale: {type: 'log', nice: true},
      axis: {format: '~s', values: decades([...good.map(r => r.fps), 72])}
    };
    return {
      width: width - 270,
      height: 360,
      data: {values: good},
      layer: [
        {name: 'cap', data: {values: [{fps: 72}]}, mark: {type: 'rule', strokeDash: [3, 3]}, encoding: {y}},
        {
          name: 'cap_text',
          data: {values: [{fps: 72}]},
          mark: {type: 'text', align: 'left', baseline: 'top', dx: 4, dy: 5, text: '72 Hz, the display'},
          encoding: {x: {value: 0}, y}
        },
        {
          name: 'spread',
          mark: {type: 'rule', aria: false},
          encoding: {x, y: {...y, field: 'low'}, y2: {field: 'high'}, color, opacity: fade}
        },
        {
          name: 'lines',
          mark: {type: 'line', strokeWidth: 1.8},
          encoding: {x, y, color, strokeDash: sides.strokeDash, opacity: fade}
        },
        {
          name: 'points',
          ...picked,
          mark: {type: 'point', filled: true, size: 46},
          encoding: {x, y, color, shape: sides.shape, opacity: fade, tooltip: tip}
        },
        {
          name: 'failed',
          data: {values: failed},
          mark: {type: 'point', shape: 'cross', size: 60, filled: true, angle: 45},
          encoding: {x, y: {value: 360}, color, tooltip: [{field: 'label'}, {field: 'resolution'}, {field: 'status'}]}
        },
      ]
    };
  };
  const paper = family.paper_table === 3;
  return plot_figure({
    id: `rates-${index}`,
    title: `${paper ? 'Fig. 4: ' : ''}Frames per second by resolution (${family.name})`,
    spec,
    caption: 'Uncapped, median of the trials; bars: half their range; a cross on the lower edge: a cell that failed. ' +
        (paper ? 'Grey: published (Quest 3, capped at 72 Hz, rendering included). ' : '') +
        'Ballistic, the harness without a cloth model, is left out. Click a name to show it alone.',
    rows: () => [
        ['solver', 'sides', 'width', 'fps', 'low', 'high', 'status'],
        ...all.map(r => [r.label, r.sides, r.width, r.fps, r.low, r.high, r.status])]
  });
}

export function bandwidth_figure(family, index) {
  const rows =
      rate_rows(family)
          .flatMap(r => [{...r, way: 'read', GB_per_s: r.read / 1e9}, {...r, way: 'written', GB_per_s: r.write / 1e9}])
          .filter(r => r.GB_per_s > 0);
  const labels = unique(rows.map(r => r.label)), sides = side_encoding(rows);
  const spec = (theme, width) => {
    const x = width_axis(rows), color = colour(labels, theme);
    const y = {
      field: 'GB_per_s',
      type: 'quantitative',
      title: 'GB/s',
      scale: {type: 'log'},
      axis: {format: '~g', values: decades(rows.map(r => r.GB_per_s))}
    };
    return {
      data: {values: rows},
      facet: {column: {field: 'way', title: null}},
      spec: {
        width: (width - 330) / 2,
        height: 280,
        layer: [
          {
            name: 'lines',
            mark: {type: 'line', strokeWidth: 1.8},
            encoding: {x, y, color, strokeDash: sides.strokeDash, opacity: fade}
          },
          {
            name: 'points',
            ...picked,
            mark: {type: 'point', filled: true, size: 46},
            encoding: {
              x,
              y,
              color,
              shape: sides.shape,
              opacity: fade,
              tooltip: [
                {field: 'label', title: 'solver'}, {field: 'sides'}, {field: 'resolution'}, {field: 'way'},
                {field: 'GB_per_s', format: '.4~g', title: 'GB/s'}
              ]
            }
          }
        ]
      }
    };
  };
  return plot_figure({
    id: `bandwidth-${index}`,
    title: `${family.paper_table === 3 ? 'Fig. 5: ' : ''}Peak bandwidth by resolution (${family.name})`,
    spec,
    empty: 'No cell has bytes.',
    caption:
        'Bytes that shaders load and store, computed from the scene and the kernels, per second of wall time. CPU solvers are ' +
        'absent: nothing is known of their bytes. The paper’s values are published as a graph alone.',
    rows: () => [
        ['solver', 'sides', 'width', 'way', 'GB_per_s'],
        ...rows.map(r => [r.label, r.sides, r.width, r.way, r.GB_per_s])]
  });
}
