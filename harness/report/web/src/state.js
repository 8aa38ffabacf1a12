// What the reader chose, kept in the address: #anchor?off=jolt,paper&Scene=…; and the look of solvers.
export const state = {
  off: new Set(),
  values: {}
};
const listeners = [];
export const on_change = listener => listeners.push(listener);

export function load_state() {
  const [anchor, query = ''] = location.hash.slice(1).split('?'), given = new URLSearchParams(query);
  state.off = new Set((given.get('off') ?? '').split(',').filter(Boolean));
  state.values = Object.fromEntries([...given].filter(([name]) => name !== 'off'));
  return decodeURIComponent(anchor);
}

/// Writes the address without a new entry of the browser's history.
export function save_state(anchor = location.hash.slice(1).split('?')[0]) {
  const query = new URLSearchParams(state.values);
  if (state.off.size) query.set('off', [...state.off].join(','));
  history.replaceState(null, '', `#${anchor}${query.size ?? [...query].length ? `?${query}` : ''}`);
}

export function set_value(name, value) {
  state.values[name] = value;
  save_state();
}

export function toggle_solver(solver) {
  state.off.has(solver) ? state.off.delete(solver) : state.off.add(solver);
  save_state();
  listeners.forEach(l => l());
  dispatchEvent(new Event('solvers'));  // the viewer is a program of its own
}

export const shown = solver => !solver || !state.off.has(solver);

/// One colour and one symbol for each solver, the same in all figures, from solvers.json; others get the spare ones.
export function looks(solvers, roles) {
  let spare = 0;
  return Object.fromEntries(solvers.map(s => {
    const [symbol, light, dark] = roles.look[s] ?? roles.spare[spare++ % roles.spare.length];
    return [s, {symbol, light, dark}];
  }));
}

const kFont = 'system-ui, -apple-system, Segoe UI, Roboto, DejaVu Sans, sans-serif';
const kTones = ['pass', 'part', 'fail', 'none', 'ignored'];

/// How charts look on the page: every colour is a variable of the style sheet, so a change of theme draws nothing again.
export function page_look(all, narrow) {
  const names = Object.keys(all);
  return {
    colour: s => s in all ? `var(--s${names.indexOf(s)})` : 'var(--soft)',
    symbol: s => all[s]?.symbol ?? 'circle',
    ink: 'var(--ink)',
    soft: 'var(--soft)',
    line: 'var(--line)',
    back: 'var(--back)',
    tones: Object.fromEntries(kTones.map(t => [t, `var(--${t})`])),
    tone_ink: Object.fromEntries(kTones.map(t => [t, `var(--on-${t})`])),
    size: narrow ? 11 : 12,
    unit: 1,
    stroke: 2,
    font: kFont
  };
}

export const style_of = all => `:root{${Object.values(all).map((l, k) => `--s${k}:light-dark(${l.light},${l.dark})`).join(';')}}`;

/// Black on white; sizes are in points, since a picture's width is that of a column of text.
export function paper_look(all) {
  return {
    colour: s => all[s]?.light ?? '#777777',
    symbol: s => all[s]?.symbol ?? 'circle',
    ink: '#000000',
    soft: '#222222',
    line: '#dddddd',
    back: '#ffffff',
    tones: {pass: '#8fcab6', part: '#f3d48b', fail: '#cc4a1b', none: '#eeeeee', ignored: '#d5d9de'},
    tone_ink: {pass: '#000000', part: '#000000', fail: '#ffffff', none: '#555555', ignored: '#000000'},
    size: 7.5,
    unit: 0.625,  // points for a pixel of the page
    stroke: 1.1,
    symbol_scale: 0.55,
    font: 'DejaVu Sans, Verdana, sans-serif',
    paper: true,
    legend: true
  };
}
