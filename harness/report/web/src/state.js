// The reader's choices, stored in the address (#anchor?off=jolt,paper&Scene=…).
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
