import * as vega from 'vega';
import {compile} from 'vega-lite';
import {Handler} from 'vega-tooltip';

import {download, element, file_name} from './dom.js';
import {to_csv} from './tables.js';
import {on_theme, theme} from './theme.js';

function config(name) {
  const text = name === 'dark' ? '#e3e8ee' : '#1b1f24', soft = name === 'dark' ? '#a3adb9' : '#59636e',
        line = name === 'dark' ? '#2b343f' : '#e6e9ed';
  return {
    background: null,
    font: 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif',
    axis: {
      labelColor: soft,
      titleColor: text,
      gridColor: line,
      domainColor: soft,
      tickColor: soft,
      titleFontWeight: 'normal',
      labelFontSize: 12,
      titleFontSize: 13,
      labelFlush: false
    },
    legend: {
      labelColor: text,
      titleColor: soft,
      titleFontWeight: 'normal',
      labelFontSize: 12,
      titleFontSize: 12,
      symbolSize: 80,
      labelLimit: 260
    },
    header: {labelColor: text, titleColor: soft, labelFontSize: 13},
    title: {color: text, fontSize: 13, fontWeight: 'normal'},
    text: {color: text},
    view: {stroke: null},
    rule: {color: soft}
  };
}

const tooltip = new Handler({theme: 'custom', disableDefaultStyle: false}).call;
const figures = [];

function make_view(spec, name, container) {
  const full = {$schema: 'https://vega.github.io/schema/vega-lite/v5.json', ...spec, config: config(name)};
  const view = new vega.View(vega.parse(compile(full).spec), {renderer: container ? 'svg' : 'none'});
  if (container) view.initialize(container).tooltip(tooltip).hover();
  return view.run();
}

/// A figure with hover and downloads. `spec(theme, width)` gives a Vega-Lite specification, `rows()` the data for CSV
/// (header first). Controls call `redraw()` of what is returned;
/// `remark()` is a sentence about what is shown just now. Invalid data (an empty `rows`) shows `empty`.
export function plot_figure(
    {id, title, caption, spec, rows, controls = [], empty = 'Nothing to show.', remark = null}) {
  const plot = element('div', {class: 'plot', id});
  const remarks = element('p', {class: 'note'});
  let view = null;
  const width = () => Math.max(320, plot.clientWidth - 20);
  const redraw = () => {
    view?.finalize();
    view = null;
    plot.replaceChildren();
    remarks.textContent = remark?.() ?? '';
    if (rows().length < 2) return void plot.append(element('p', {class: 'soft'}, empty));
    view = make_view({...spec(theme(), width()), description: title}, theme(), plot);
  };
  // What is saved is for paper: light, on white, and of one size whatever the window's.
  const paper = () =>
      make_view({...spec('light', 760), description: title, background: '#ffffff', padding: 10}, 'light', null);
  const name = file_name(title);
  const save = (label, make) =>
      element('button', {type: 'button', 'aria-label': `${title}: download as ${label}`, onclick: make}, label);
  const block = element(
      'figure', {}, element('h3', {}, title), controls.length ? element('div', {class: 'bar'}, controls) : null, plot,
      remark ? remarks : null, element('figcaption', {}, caption),
      element(
          'div', {class: 'bar small', role: 'group', 'aria-label': `Downloads of ${title}`},
          save('SVG', async () => download(`${name}.svg`, 'image/svg+xml', await paper().toSVG())),
          save(
              'PNG',
              async () =>
                  download(`${name}.png`, 'image/png', await (await fetch(await paper().toImageURL('png', 3))).blob())),
          save(
              'CSV',
              () => download(
                  `${name}.csv`, 'text/csv',
                  to_csv(rows().map(r => r.map(v => v === null || v === undefined ? '' : String(v))))))));
  const figure = {block, redraw, width, drawn: 0};
  figures.push(figure);
  return figure;
}

/// Draws all figures, and again when the theme or the width changes.
export function start_plots() {
  const all = () => figures.forEach(f => {
    f.drawn = f.width();
    f.redraw();
  });
  all();
  on_theme(all);
  let timer = 0;
  addEventListener('resize', () => {
    clearTimeout(timer);
    timer = setTimeout(
        () => figures.filter(f => f.width() !== f.drawn).forEach(f => {
          f.drawn = f.width();
          f.redraw();
        }),
        200);
  });
}
