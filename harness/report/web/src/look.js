// Numbers as text, and the colours and symbols of solvers, which are equal in all figures and tables.
export const unique = list => [...new Set(list)];

const kMost = 1e4;  // numbers from 1e-3 up to this are printed without a power of ten

/// "0.0012", "12.5", "4.5·10⁻⁷"; "–" for what is not a number.
export function number(v, digits = 3) {
  if (v === null || v === undefined || !Number.isFinite(Number(v))) return '–';
  if (v === 0) return '0';
  const size = Math.abs(v);
  if (size < kMost && size >= 1e-3) return String(Number(v.toPrecision(digits)));
  const [mantissa, exponent] = v.toExponential(digits - 1).split('e');
  const power = '10' + [...String(Number(exponent))].map(c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]).join('');
  return Number(mantissa) === 1 ? power : `${Number(mantissa)}·${power}`;
}

/// Paths of the symbols, in pixels of a page.
export const kSymbols = {
  square: 'M-4 -4H4V4H-4Z',
  up: 'M0 -5.2L4.8 3.6H-4.8Z',
  down: 'M0 5.2L4.8 -3.6H-4.8Z',
  diamond: 'M0 -5.4L5.4 0L0 5.4L-5.4 0Z',
  right: 'M5.2 0L-3.6 4.8V-4.8Z',
  left: 'M-5.2 0L3.6 4.8V-4.8Z',
  x: 'M-4 -4L4 4M-4 4L4 -4',
  plus: 'M0 -5V5M-5 0H5',
  star: 'M0 -5.5L1.6 -1.8L5.4 -1.6L2.4 0.9L3.4 4.7L0 2.6L-3.4 4.7L-2.4 0.9L-5.4 -1.6L-1.6 -1.8Z',
  hexagon: 'M-2.6 -4.5H2.6L5.2 0L2.6 4.5H-2.6L-5.2 0Z',
  circle: 'M-4.4 0a4.4 4.4 0 1 0 8.8 0a4.4 4.4 0 1 0 -8.8 0Z',
  ring: 'M-4.4 0a4.4 4.4 0 1 0 8.8 0a4.4 4.4 0 1 0 -8.8 0ZM-1.2 0a1.2 1.2 0 1 0 2.4 0a1.2 1.2 0 1 0 -2.4 0Z'
};

/// {colour (a variable of the style sheet), symbol, light, dark} by solver, from solvers.json; other solvers get the spare ones.
export function looks(solvers, roles) {
  let spare = 0;
  return Object.fromEntries(solvers.map((s, k) => {
    const [symbol, light, dark] = roles.look[s] ?? roles.spare[spare++ % roles.spare.length];
    return [s, {symbol, light, dark, colour: `var(--s${k})`}];
  }));
}

/// Style sheet variables for the colours of solvers.
export const style_of = all => `:root{${Object.values(all).map((l, k) => `--s${k}:light-dark(${l.light},${l.dark})`).join(';')}}`;

/// A solver's symbol beside its name.
export function icon(all, solver) {
  const place = document.createElement('template'), {symbol = 'circle', colour = 'var(--soft)'} = all[solver] ?? {};
  place.innerHTML = `<svg class="icon" viewBox="-7 -7 14 14" aria-hidden="true"><path d="${kSymbols[symbol]}" style="stroke:${colour};fill:${colour};stroke-width:1.6"/></svg>`;
  return place.content.firstChild;
}
