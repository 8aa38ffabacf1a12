/// Light or dark: as the system says until the button is used. `changed` is called with the theme's name.
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

// After Okabe & Ito's palette, readable with every common colour blindness; on paper as in the light.
const kColours = {
  light: {
    xpbd: '#0072B2',
    paper: '#D55E00',
    'paper readback=blocking': '#CC79A7',
    'bullet-soft': '#009E73',
    'bullet-deformable': '#B58900',
    reference: '#555555',
    ballistic: '#000000'
  },
  dark: {
    xpbd: '#56B4E9',
    paper: '#F0803C',
    'paper readback=blocking': '#E0A0C8',
    'bullet-soft': '#2FCB9B',
    'bullet-deformable': '#E6B422',
    reference: '#A8B0B8',
    ballistic: '#FFFFFF'
  }
};
const kSpare = {
  light: ['#7B4FB5', '#56B4E9', '#8C564B', '#E69F00', '#6B8E23', '#B03060', '#1B4F72', '#AAAA00'],
  dark: ['#B79AE8', '#8CC8E0', '#D0A090', '#F5B942', '#B5D05A', '#F080A0', '#9FB8FF', '#E8E86A']
};
const kPublished = {
  light: ['#9AA0A6', '#7C838A', '#5C646B'],
  dark: ['#6F7780', '#8C949C', '#B0B8C0']
};

/// {label: colour} for every label, stable as long as the labels are.
export function palette(labels, theme_name = theme()) {
  const name = theme_name === 'dark' ? 'dark' : 'light', out = {};
  let spare = 0, published = 0;
  for (const label of labels)
    out[label] = kColours[name][label] ??
        (label.startsWith('published') ? kPublished[name][published++ % 3] :
                                         kSpare[name][spare++ % kSpare[name].length]);
  return out;
}
