// Draws every figure, on the page and on paper: Vega-Lite compiles an entry's spec, Vega draws it.
import {expressionFunction, parse, textMetrics, Transform, transforms, View} from 'vega';
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

const kLine = 14, kGap = 9, kCover = 11, kFar = 60;  // pixels: between the middles of two names; between a name and its mark, beside, above, and at most
/// Transform of the layer "names": moves each name to where it covers no other name, no mark, little of a line, and is near its
/// place. A name that would cover a mark, or stand far off beside another line, is left out: the legend names all solvers.
transforms.names = class extends Transform {
  transform(_, pulse) {
    if (!_.modified() && !pulse.changed(pulse.ADD_REM)) return pulse.StopPropagation;
    const {size: [right, bottom]} = _, items = pulse.materialize(pulse.SOURCE).source, taken = [];
    const [marks, line] = [true, undefined].map(is => items.filter(i => !i.datum.name && i.datum.mark === is).map(i => [i.x, i.y]));
    for (const item of items.filter(i => i.datum.name).sort((a, b) => a.y - b.y)) {
      const {x} = item, y = item.y + (item.datum.dy ?? 0), width = textMetrics.width(item, item.text), covers = (list, left, top, h) => {
        let n = 0;
        for (const [a, b, wide = 0] of list) n += a < left + width + 6 && a + wide + 6 > left && Math.abs(b - top) < h;
        return n;
      };
      let least = Infinity, best = null;
      for (const [k, wanted] of [x + kGap, x - width - kGap, x - width / 2].entries()) {
        const left = Math.max(0, Math.min(wanted, right - width));
        for (let top = 4; top <= bottom - 4; top += 4) {
          const far = Math.abs(top - y) + 6 * k + Math.abs(left - wanted) / 3, cost = far < least ? far + 1e4 * covers(taken, left, top, kLine) + 80 * covers(marks, left, top, kCover) + 12 * covers(line, left, top, 9) : far;
          if (cost < least) [least, best] = [cost, [left, top, width, far]];
        }
      }
      const lost = covers(marks, best[0], best[1], kCover) || (best[3] > kFar && best[0] < x);
      if (!lost) taken.push(best);
      Object.assign(item, {text: lost ? '' : item.text, x: best[0], y: best[1], align: 'left', baseline: 'middle'});
    }
    return pulse.reflow(true).modifies(['x', 'y', 'text', 'align', 'baseline']);
  }
};
transforms.names.Definition = {type: 'names', metadata: {modifies: true}, params: [{name: 'size', type: 'number', array: true, length: 2}]};

/// A view of an entry's rows, not yet drawn. `width` in pixels of a page; `shrink`: factor on heights.
export function view_of(entry, rows, state, look, width, shrink = 1) {
  rows = rows.filter(entry.drawn ?? Boolean);
  const {room = 0, ...spec} = entry.spec(rows, state, {...look, width, shrink}), single = spec.layer && {width, autosize: {type: 'fit-x', contains: 'padding'}};
  const {spec: vega} = compile({data: {name: 'rows'}, ...single, ...spec, padding: {left: 2, right: 8 + 0.06 * room, top: 2, bottom: 6}}, {config: config(look, width)});
  for (const m of vega.marks) if (m.name === 'names_marks') m.transform = [{type: 'names', size: {signal: `[width + ${room}, height]`}}];
  return new View(parse(vega, {events: {bind: 'none'}}), {renderer: 'svg'}).data('rows', rows.map((r, i) => ({...r, i})));
}
