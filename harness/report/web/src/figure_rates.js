// Figs. 4 and 5, as Vega-Lite specifications.
import {beside, colour, device_note, fade, is_floor, kCross, kFailed, log_axis, picked, unique, without_floor} from './figure_parts.js';

const kSides = {
  domain: ['single', 'double-duplicated', 'double', 'not stated'],
  dash: [[1, 0], [6, 4], [2, 3], [1, 0]],
  shape: ['circle', 'square', 'triangle-up', 'diamond']
};

const sides_of = s => {
  const sides = kSides.domain.includes(s.sides) ? s.sides : 'not stated';
  return {sides, dash: kSides.domain.indexOf(sides)};
};

function rate_rows(family) {
  const rows = [];
  for (const s of without_floor(family.series))
    for (const p of s.points)
      rows.push({
        label: s.label,
        ...sides_of(s),
        width: p.width,
        resolution: p.resolution,
        status: p.status,
        gpu: p.gpu,
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
        ...sides_of(s),
        width: p.width,
        resolution: `${p.width}²`,
        status: 'ok',
        fps: p.fps,
        low: p.fps,
        high: p.fps
      });
  return rows;
}

/// On paper points are hollow, so that overlapping lines stay visible.
const hollow = theme => theme === 'paper' ? {type: 'point', fill: '#ffffff', size: 34, strokeWidth: 1.4} :
                                            {type: 'point', filled: true, size: 46};

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
  return {
    // A field with a domain of its own; otherwise the symbols of the legend would be dashed.
    strokeDash: {
      field: 'dash',
      type: 'nominal',
      scale: {domain: used.map(s => kSides.domain.indexOf(s)), range: pick(kSides.dash)},
      legend: null
    },
    shape: {
      field: 'sides',
      type: 'nominal',
      title: 'sides',
      scale: {domain: used, range: pick(kSides.shape)},
      legend: {encoding: {symbols: {stroke: {value: '#777777'}, fill: {value: 'transparent'}}}}
    }
  };
};

/// A note with the rates above the axis of Fig. 4.
function floor_note(family) {
  const floor = family.series.filter(is_floor), names = unique(floor.map(s => s.solver)).join(', ');
  const rates = floor.flatMap(s => s.points).map(p => p.fps).filter(fps => fps > 0);
  if (!rates.length || family.series.every(is_floor)) return '';
  const [low, high] = [Math.min(...rates), Math.max(...rates)].map(v => Math.round(v).toLocaleString('en-US'));
  return `Not drawn: ${names}, which is the harness without a cloth model (${low} to ${high} frames per second).`;
}

function rates_spec(all, labels, theme, width) {
  const good = all.filter(r => r.fps > 0), failed = all.filter(r => kFailed.includes(r.status)),
        sides = side_encoding(all);
  const tip = [
    {field: 'label', title: 'solver'}, {field: 'sides'}, {field: 'resolution'},
    {field: 'fps', format: ',.4~r', title: 'frames/s'}, {field: 'low', format: ',.4~r'},
    {field: 'high', format: ',.4~r'}
  ];
  const x = width_axis(all), color = colour(labels, theme), opacity = fade(theme),
        height = theme === 'paper' ? 300 : 360;
  const y = log_axis(
      'fps', 'frames per second, uncapped', [...good.map(r => r.fps), 72], {scale: {nice: true}, axis: {format: '~s'}});
  return {
    width: beside(theme, width, 270),
    height,
    data: {values: good},
    layer: [
      {name: 'cap', data: {values: [{fps: 72}]}, mark: {type: 'rule', strokeDash: [3, 3]}, encoding: {y}},
      {
        name: 'cap_text',
        data: {values: [{fps: 72}]},
        mark: {type: 'text', align: 'left', baseline: 'top', dx: 4, dy: 5, text: '72 Hz, refresh rate of the display'},
        encoding: {x: {value: 0}, y}
      },
      {
        name: 'spread',
        mark: {type: 'rule', aria: false},
        encoding: {x, y: {...y, field: 'low'}, y2: {field: 'high'}, color, opacity}
      },
      {
        name: 'lines',
        mark: {type: 'line', strokeWidth: 1.8},
        encoding: {x, y, color, strokeDash: sides.strokeDash, opacity}
      },
      {
        name: 'points',
        ...picked(theme),
        mark: hollow(theme),
        encoding: {x, y, color, shape: sides.shape, opacity, tooltip: tip}
      },
      {
        name: 'failed',
        data: {values: failed},
        mark: kCross,
        encoding: {x, y: {value: height}, color, tooltip: [{field: 'label'}, {field: 'resolution'}, {field: 'status'}]}
      },
    ]
  };
}

/// `file`: of the picture, where the report has one.
export function rates_figure(family, index, file) {
  const all = rate_rows(family), labels = unique(all.map(r => r.label));
  const spec = (theme, width) => rates_spec(all, labels, theme, width);
  const paper = family.paper_table === 3;
  const title = `${paper ? 'Fig. 4: ' : ''}Frames per second by resolution (${family.name})`;
  return {
    id: `rates-${index}`,
    title,
    spec,
    caption:
        'Uncapped frame rates. Points: median of the trials. Bars: half their range. A cross on the lower edge: a run that failed. ' +
        (paper ? 'Grey: published values (Quest 3, capped at 72 Hz, with rendering). ' : '') +
        'Ballistic, which is the harness without a cloth model, is not drawn.',
    hint: 'Click a name in the legend to show that solver alone.',
    rows: () => [
        ['solver', 'sides', 'width', 'fps', 'low', 'high', 'status'],
        ...all.map(r => [r.label, r.sides, r.width, r.fps, r.low, r.high, r.status])],
    stills: file ? [{file, title, labels, notes: [floor_note(family), device_note(all)], make: w => spec('paper', w)}] :
                   []
  };
}

function bandwidth_spec(rows, failed, labels, theme, width) {
  const sides = side_encoding([...rows, ...failed]);
  const x = width_axis([...rows, ...failed]), color = colour(labels, theme), opacity = fade(theme),
        height = theme === 'paper' ? 220 : 280;
  const y = log_axis('GB_per_s', 'peak bandwidth [GB/s]', rows.map(r => r.GB_per_s));
  return {
    data: {values: [...rows, ...failed.flatMap(r => [{...r, way: 'read'}, {...r, way: 'written'}])]},
    facet: {column: {field: 'way', title: null}},
    spec: {
      width: theme === 'paper' ? (width - 20) / 2 : (width - 330) / 2,
      height,
      layer: [
        {
          name: 'lines',
          transform: [{filter: 'datum.GB_per_s > 0'}],
          mark: {type: 'line', strokeWidth: 1.8},
          encoding: {x, y, color, strokeDash: sides.strokeDash, opacity}
        },
        {
          name: 'points',
          ...picked(theme),
          transform: [{filter: 'datum.GB_per_s > 0'}],
          mark: hollow(theme),
          encoding: {
            x,
            y,
            color,
            shape: sides.shape,
            opacity,
            tooltip: [
              {field: 'label', title: 'solver'}, {field: 'sides'}, {field: 'resolution'}, {field: 'way'},
              {field: 'GB_per_s', format: '.4~g', title: 'GB/s'}
            ]
          }
        },
        {
          name: 'failed',
          transform: [{filter: '!(datum.GB_per_s > 0)'}],
          mark: kCross,
          encoding: {x, y: {value: height}, color}
        }
      ]
    }
  };
}

export function bandwidth_figure(family, index, file) {
  const all = rate_rows(family), points = family.series.flatMap(s => s.points);
  const rows =
      all.flatMap(r => [{...r, way: 'read', GB_per_s: r.read / 1e9}, {...r, way: 'written', GB_per_s: r.write / 1e9}])
          .filter(r => r.GB_per_s > 0);
  const failed = rows.length ? all.filter(r => r.gpu && kFailed.includes(r.status)) : [];
  const labels = unique([...rows, ...failed].map(r => r.label));
  const spec = (theme, width) => bandwidth_spec(rows, failed, labels, theme, width);
  const windows = points.filter(p => p.read_B_per_s > 0).map(p => p.window_s).filter(w => w > 0),
        digits = v => Number(v.toPrecision(2));
  const over = windows.length ?
      `, peak over windows of ${digits(Math.min(...windows))} to ${digits(Math.max(...windows))} s` :
      ', peak';
  const absent = unique(
      family.series.filter(s => s.points.some(p => p.status === 'ok') && !labels.includes(s.label)).map(s => s.solver));
  const title = `${family.paper_table === 3 ? 'Fig. 5: ' : ''}Peak bandwidth by resolution (${family.name})`;
  const empty = 'No run is of a GPU solver, so no bytes are known.';
  return {
    id: `bandwidth-${index}`,
    title,
    spec,
    empty,
    caption: 'Bytes that shaders load and store, computed from the scene and the kernels, per second of wall time' +
        `${over}. The bytes of CPU solvers are not known. ` +
        'The paper publishes its values as a graph only.',
    rows: () => [
        ['solver', 'sides', 'width', 'way', 'GB_per_s'],
        ...rows.map(r => [r.label, r.sides, r.width, r.way, r.GB_per_s])],
    stills: file ? [{
      file,
      title,
      labels,
      empty: rows.length ? '' : empty,
      notes: [absent.length ? `Not known: ${absent.join(', ')}.` : '', device_note(all)],
      make: w => spec('paper', w)
    }] :
                   []
  };
}
