// Draws every figure, on the page and on paper: Vega-Lite compiles an entry's spec, Vega draws it.
import {expressionFunction, parse, textMetrics, View} from 'vega';
import {compile} from 'vega-lite';

import {number} from './look.js';

expressionFunction('number', number);
if (typeof document === 'undefined') textMetrics.width = (item, text) => 0.58 * String(text ?? '').length * item.fontSize;  // Node has no fonts

/// Colours are variables of the style sheet, so that a change of theme needs no redrawing.
function config({font, paper}, width) {
  const fontSize = width < 560 && !paper ? 11 : 12, size = paper ? 3.1 : 4, labels = {labelFontSize: fontSize, labelColor: 'var(--soft)'};
  return {
    font,
    background: paper?.back ?? null,
    padding: {left: 2, right: 8, top: 2, bottom: 6},
    view: {stroke: null},
    line: {strokeWidth: 2, strokeJoin: 'round'},
    point: {opacity: 1, size, strokeWidth: 1.6},
    rule: {strokeWidth: 1.6},
    text: {fontSize, fill: 'var(--soft)'},
    title: {anchor: 'start', frame: 'group', fontSize, fontWeight: 600, color: 'var(--ink)', offset: 6},
    axis: {...labels, labelPadding: 6, titleColor: 'var(--ink)', titleFontSize: fontSize, titleFontWeight: 'normal', gridColor: 'var(--line)', domain: false, ticks: false},
    axisX: {labelSeparation: 7, titleAnchor: 'end', titlePadding: 4},
    axisY: {titleAngle: 0, titleAlign: 'left', titleAnchor: 'end', titleBaseline: 'bottom', titleY: -8},
    legend: {
      ...labels, orient: 'bottom', direction: 'horizontal', title: null, labelLimit: 0, columnPadding: 14, rowPadding: 4, offset: 8, symbolSize: size, symbolStrokeWidth: 1.6, symbolOpacity: 1,
      layout: {bottom: {frame: 'bounds', direction: 'vertical'}}
    }
  };
}

const kAnchors = ['right', 'top-right', 'bottom-right', 'left', 'top', 'bottom', 'top-left', 'bottom-left'];
/// Vega's transform that places labels without overlap, for the layer "names"; Vega-Lite specs cannot contain it.
const placed = right => ({
  type: 'label',
  size: {signal: `[width + ${right}, height]`},
  sort: {field: 'datum.order'},
  anchor: [10, 18, 28, 44].flatMap(() => kAnchors),
  offset: [10, 18, 28, 44].flatMap(d => kAnchors.map(() => d))
});

/// A view of an entry's rows, not yet drawn. `width` in pixels of a page; `shrink`: factor on heights.
export function view_of(entry, rows, state, look, width, shrink = 1) {
  rows = rows.filter(entry.drawn ?? Boolean);
  const spec = entry.spec(rows, state, {...look, width, shrink}), single = spec.layer && {width, autosize: {type: 'fit-x', contains: 'padding'}};
  const {spec: vega} = compile({data: {name: 'rows'}, ...single, ...spec}, {config: config(look, width)});
  for (const m of vega.marks) if (m.name === 'names_marks') m.transform = [placed(spec.padding?.right ?? 0)];
  return new View(parse(vega, {events: {bind: 'none'}}), {renderer: 'svg'}).data('rows', rows.map((r, i) => ({...r, i})));
}
