/// An element with attributes and children; `on…` attributes are listeners, null children are skipped.
export function element(tag, attributes = {}, ...children) {
  const e = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) e.addEventListener(name.slice(2), value);
    else e.setAttribute(name, value === true ? '' : value);
  }
  e.append(...children.flat().filter(c => c !== null && c !== undefined));
  return e;
}

export const button = (words, label, clicked, more = {}) => element('button', {type: 'button', 'aria-label': label, onclick: clicked, ...more}, words);

export function select(label, options, value, changed) {
  const items = options.map(o => element('option', {value: o.value, selected: o.value === value}, o.text));
  const list = element('select', {onchange: () => changed(list.value)}, items);
  return element('label', {}, label, list);
}

/// A caption, and folded below it its details: all lines of the text except the first.
export const captioned = (tag, attributes, [caption, ...more]) => element(tag, attributes, caption, more.length ? element('details', {}, element('summary', {}, 'Note'), more.join(' ')) : null);

/// Decodes the text of an element (base64 of zlib) into a buffer.
export function unpacked(id) {
  const packed = Uint8Array.from(atob(document.getElementById(id).textContent), c => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer();
}

/// The element whose text screen readers announce.
let live = null;
export function say(text) {
  live ??= document.body.appendChild(element('div', {class: 'skip', role: 'status', 'aria-live': 'polite'}));
  live.textContent = text;
}
