import {symbol} from './chart.js';

// The reader's choices, stored in the address (#anchor?off=jolt,paper&Scene=…), and the colours and symbols of solvers.
export const state = {off: new Set(), values: {}};

export function load_state() {
  const [anchor, query = ''] = location.hash.slice(1).split('?'), given = new URLSearchParams(query);
  state.off = new Set((given.get('off') ?? '').split(',').filter(Boolean));
  state.values = Object.fromEntries([...given].filter(([name]) => name !== 'off'));
  return decodeURIComponent(anchor);
}

/// Writes the address without a new entry in the browser's history.
export function save_state(anchor = location.hash.slice(1).split('?')[0]) {
  const query = new URLSearchParams(state.values);
  if (state.off.size) query.set('off', [...state.off].join(','));
  history.replaceState(null, '', `#${anchor}${query.size ?? [...query].length ? `?${query}` : ''}`);
}

export function set_value(name, value) {
  value === null ? delete state.values[name] : state.values[name] = value;
  save_state();
}

export function hide_solvers(solvers) {
  state.off = new Set(solvers);
  save_state();
  dispatchEvent(new Event('solvers'));
}

export const shown = solver => !solver || !state.off.has(solver);

/// One colour and one symbol per solver from solvers.json, equal in all figures; other solvers get the spare ones.
export function looks(solvers, roles) {
  let spare = 0;
  return Object.fromEntries(solvers.map(s => {
    const [symbol, light, dark] = roles.look[s] ?? roles.spare[spare++ % roles.spare.length];
    return [s, {symbol, light, dark}];
  }));
}

/// Style sheet variables for the colours of solvers.
export const style_of = all => `:root{${Object.values(all).map((l, k) => `--s${k}:light-dark(${l.light},${l.dark})`).join(';')}}`;

/// How charts look. Every colour is a variable of the style sheet, so that a change of theme needs no redrawing.
export const page_look = (all, narrow) => ({
  colour: s => s in all ? `var(--s${Object.keys(all).indexOf(s)})` : 'var(--soft)',
  symbol: s => all[s]?.symbol ?? 'circle',
  size: narrow ? 11 : 12,
  small: 11, unit: 1, stroke: 2, symbol_scale: 1,
  font: 'system-ui, -apple-system, Segoe UI, Roboto, DejaVu Sans, sans-serif'
});

/// A solver's symbol beside its name.
export function icon(all, solver) {
  const place = document.createElement('template');
  place.innerHTML = `<svg class="icon" viewBox="-7 -7 14 14" aria-hidden="true">${symbol(page_look(all), solver, 0, 0)}</svg>`;
  return place.content.firstChild;
}

const kPaper = {
  ink: '#000000', soft: '#222222', line: '#dddddd', back: '#ffffff',
  good: '#0b6b4b', bad: '#b23608', pass: '#8fcab6', fail: '#cc4a1b', none: '#eeeeee', ignored: '#d5d9de',
  'on-pass': '#000000', 'on-fail': '#ffffff', 'on-none': '#555555', 'on-ignored': '#000000'
};

/// Black on white; sizes in points, because a picture is as wide as a text column. `paper`: values of the variables.
export const paper_look = all => ({
  ...page_look(all),
  size: 7.5, small: 7,
  unit: 0.625,  // points for a pixel of the page
  stroke: 1.1, symbol_scale: 0.55,
  font: 'DejaVu Sans, Verdana, sans-serif',
  paper: {...kPaper, ...Object.fromEntries(Object.values(all).map((l, k) => [`s${k}`, l.light]))}
});
