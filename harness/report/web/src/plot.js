import * as vega from 'vega';
import {compile} from 'vega-lite';
import {Handler} from 'vega-tooltip';

import {download, downloads, element, file_name, select} from './dom.js';
import {config} from './plot_config.js';
import {to_csv} from './tables.js';
import {on_theme, theme} from './theme.js';

const tooltip = new Handler({theme: 'custom', disableDefaultStyle: false}).call;
const figures = [];

function make_view(spec, name, container) {
  const full = {$schema: 'https://vega.github.io/schema/vega-lite/v5.json', ...spec, config: config(name)};
  const view = new vega.View(vega.parse(compile(full).spec), {renderer: container ? 'svg' : 'none'});
  if (container) view.initialize(container).tooltip(tooltip).hover();
  return view.run();
}

/// The element of a figure (figures.js), with hover, controls and downloads.
export function plot_figure(
    {id, title, caption, hint, spec, rows, choices = [], empty = 'There are no data for this choice.', remark = null}) {
  const plot = element('div', {class: 'plot', id});
  const remarks = element('p', {class: 'note'});
  const state = {};
  let view = null;
  const width = () => Math.max(320, plot.clientWidth - 20);
  const redraw = () => {
    view?.finalize();
    view = null;
    plot.replaceChildren();
    remarks.textContent = remark?.(state) ?? '';
    if (rows(state).length < 2) return void plot.append(element('p', {class: 'soft'}, empty));
    view = make_view({...spec(theme(), width(), state), description: title}, theme(), plot);
  };
  const controls = choices.map(c => select(c.label, [], '', value => {
                                 state[c.label] = value;
                                 settle();
                                 redraw();
                               }));
  // The options of a control depend on the controls before it.
  const settle = () => choices.forEach(({label, options, first}, k) => {
    const list = options(state);
    if (!list.some(o => o.value === state[label])) state[label] = first?.(state) ?? list[0]?.value ?? '';
    controls[k].querySelector('select').replaceChildren(
        ...list.map(o => new Option(o.text, o.value, o.value === state[label], o.value === state[label])));
  });
  settle();
  // Saved figures are light, on white, and of one size for every window.
  const paper = () =>
      make_view({...spec('light', 760, state), description: title, background: '#ffffff', padding: 10}, 'light', null);
  const name = file_name(title);
  const block = element(
      'figure', {}, element('h3', {}, title), controls.length ? element('div', {class: 'bar'}, controls) : null, plot,
      remark ? remarks : null, element('figcaption', {}, [caption, hint].filter(Boolean).join(' ')), downloads(title, {
        SVG: async () => download(`${name}.svg`, 'image/svg+xml', await paper().toSVG()),
        PNG: async () =>
            download(`${name}.png`, 'image/png', await (await fetch(await paper().toImageURL('png', 3))).blob()),
        CSV: () => download(`${name}.csv`, 'text/csv', to_csv(rows(state).map(r => r.map(v => String(v ?? '')))))
      }));
  figures.push({redraw, width, drawn: 0});
  return block;
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
