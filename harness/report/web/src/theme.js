/// Light or dark: the system's choice until the button is used. `changed` is called with the theme's name.
const listeners = [];
export const on_theme = listener => listeners.push(listener);
export const theme = () => document.documentElement.dataset.theme === 'dark' ? 'dark' : 'light';

function apply(name) {
  document.documentElement.dataset.theme = name;
  const button = document.getElementById('theme');
  button.textContent = name === 'dark' ? 'Light' : 'Dark';
  button.setAttribute('aria-label', `Switch to the ${name === 'dark' ? 'light' : 'dark'} theme`);
  button.setAttribute('aria-pressed', String(name === 'dark'));
  for (const listener of listeners) listener(name);
}

export function start_theme() {
  const system = matchMedia('(prefers-color-scheme: dark)');
  let chosen = null;
  const wanted = () => chosen ?? (system.matches ? 'dark' : 'light');
  system.addEventListener('change', () => apply(wanted()));
  document.getElementById('theme').addEventListener(
      'click', () => apply(chosen = theme() === 'dark' ? 'light' : 'dark'));
  // Paper is white.
  addEventListener('beforeprint', () => apply('light'));
  addEventListener('afterprint', () => apply(wanted()));
  apply(wanted());
}

// Colours by label that the document asks for (solvers.json); others get the spare ones. Paper has those of light.
let asked = {light: {}, dark: {}};
export const ask_colours = colours => asked = colours;
// After Okabe & Ito's palette, readable with every common colour blindness.
const kSpare = {
  light: ['#7B4FB5', '#56B4E9', '#8C564B', '#E69F00', '#6B8E23', '#B03060', '#1B4F72', '#AAAA00'],
  dark: ['#B79AE8', '#8CC8E0', '#D0A090', '#F5B942', '#B5D05A', '#F080A0', '#9FB8FF', '#E8E86A']
};
const kPublished = {
  light: ['#9AA0A6', '#7C838A', '#5C646B'],
  dark: ['#6F7780', '#8C949C', '#B0B8C0']
};

const hex = v => Math.round(255 * v).toString(16).padStart(2, '0');
/// Further colours, all different: hues a golden angle apart, of changing lightness.
function generated(k, name) {
  const hue = (k * 137.508) % 360, light = name === 'dark' ? 0.62 + 0.06 * (k % 4) : 0.28 + 0.06 * (k % 4),
        saturation = 0.55 + 0.15 * (k % 3), a = saturation * Math.min(light, 1 - light);
  const channel = n => {
    const at = (n + hue / 30) % 12;
    return light - a * Math.max(-1, Math.min(at - 3, 9 - at, 1));
  };
  return `#${hex(channel(0))}${hex(channel(8))}${hex(channel(4))}`.toUpperCase();
}

const channels = colour => [1, 3, 5].map(at => parseInt(colour.slice(at, at + 2), 16));
const distance = (a, b) => Math.hypot(...channels(a).map((v, k) => v - channels(b)[k]));
/// The next further colour that is unlike all in `used`; where there are too many for that, the least alike so far.
function unlike(used, name) {
  const kUnlike = 60, kTries = 24;
  let best = null, apart = -1;
  for (let k = used.length; k < used.length + kTries && apart < kUnlike; ++k) {
    const colour = generated(k, name), nearest = Math.min(...used.map(u => distance(colour, u)));
    if (nearest > apart) [best, apart] = [colour, nearest];
  }
  return best;
}

/// {label: colour} for every label, stable as long as the labels are.
export function palette(labels, theme_name = theme()) {
  const name = theme_name === 'dark' ? 'dark' : 'light', out = {};
  let spare = 0, published = 0;
  for (const label of labels)
    out[label] = asked[name][label] ??
        (label.startsWith('published') ? kPublished[name][published++ % 3] :
                                         kSpare[name][spare++] ?? unlike([...Object.values(out), ...kSpare[name]], name));
  return out;
}
