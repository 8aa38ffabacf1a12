import {element} from './dom.js';
import {make_figures} from './figures.js';
import {plot_figure, start_plots} from './plot.js';
import {table_block} from './tables.js';
import {start_theme} from './theme.js';
import {start_viewer} from './viewer.js';

const kOrder = [
  'studies', 'claims', 'devices', 'summary', 'rates', 'work-precision', 'penetration', 'stability', 'material',
  'feature-cost', 'features', 'failed', 'expect', 'environment'
];
const kAfterViewer = ['material', 'feature-cost', 'features', 'failed', 'expect', 'environment'];
const rank = id => kOrder.includes(id) ? kOrder.indexOf(id) : kOrder.length;

/// "**" marks warnings; blank lines separate paragraphs.
function headline(text) {
  return text.split(/\n+/).filter(Boolean).map(line => {
    const parts = line.split('**');
    return element(
        'p', {class: parts.length > 1 ? 'warning' : 'soft'}, parts.map((p, k) => k % 2 ? element('strong', {}, p) : p));
  });
}

function section(s, id, figures) {
  // The main table, then the figures, then the other tables. Work-precision figures come before all tables.
  const blocks = s.tables.map(table_block), first = s.id === 'work-precision' ? 0 : 1;
  return element(
      'section', {id, 'aria-labelledby': `${id}-title`}, element('h2', {id: `${id}-title`}, s.title),
      blocks.slice(0, first), figures.map(plot_figure), blocks.slice(first));
}

function start() {
  const doc = JSON.parse(document.getElementById('clothbench-data').textContent);
  start_theme();
  document.getElementById('headline')
      .append(
          ...headline(doc.headline),
          ...(doc.commands.length ? [element(
                                        'p', {class: 'soft'}, 'Written by ',
                                        doc.commands.flatMap((c, k) => [k ? ', ' : '', element('code', {}, c)]), '.')] :
                                    []));

  const figures = make_figures(doc), links = [], seen = {};
  const sorted = doc.sections.map((s, k) => ({s, k})).sort((a, b) => rank(a.s.id) - rank(b.s.id) || a.k - b.k);
  for (const {s} of sorted) {
    const nth = seen[s.id] = (seen[s.id] ?? 0) + 1, id = nth > 1 ? `${s.id}-${nth}` : s.id;
    // Each section of rates has figures of its own. Elsewhere the first section has all of them.
    const own = s.id === 'rates' ? figures.rates[nth - 1] ?? [] : nth === 1 ? figures[s.id] ?? [] : [];
    document.getElementById(kAfterViewer.includes(s.id) ? 'later' : 'sections').append(section(s, id, own));
    links.push({id, title: s.title, later: kAfterViewer.includes(s.id)});
  }
  const has_viewer = doc.motions.runs.length > 0;
  const all = [
    ...links.filter(l => !l.later), ...(has_viewer ? [{id: 'viewer-section', title: 'Motions'}] : []),
    ...links.filter(l => l.later), {id: 'rules', title: 'Rules and limits'}
  ];
  document.getElementById('contents')
      .append(element('ul', {}, all.map(l => element('li', {}, element('a', {href: `#${l.id}`}, l.title)))));
  start_plots();
  // Used by tests and the browser's console.
  window.clothbench = {document: doc};
  if (!has_viewer) return;
  document.getElementById('viewer-section').hidden = false;
  window.clothbench.viewer = start_viewer(document.getElementById('viewer'), doc.motions);
}

start();
