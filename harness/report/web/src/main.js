import {element} from './dom.js';
import {make_figures} from './figures.js';
import {plot_figure, start_plots} from './plot.js';
import {table_block} from './tables.js';
import {start_theme} from './theme.js';
import {start_viewer} from './viewer.js';

const kAfterViewer = ['features', 'failed', 'environment'];

/// "**" marks warnings; blank lines separate paragraphs.
function headline(text) {
  return text.split(/\n+/).filter(Boolean).map(line => {
    const parts = line.split('**');
    return element(
        'p', {class: parts.length > 1 ? 'warning' : 'soft'}, parts.map((p, k) => k % 2 ? element('strong', {}, p) : p));
  });
}

/// Figures come first: they show at a glance what the tables state.
function section(s, figures) {
  return element(
      'section', {id: s.id, 'aria-labelledby': `${s.id}-title`}, element('h2', {id: `${s.id}-title`}, s.title),
      figures.map(plot_figure), s.tables.map(table_block));
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

  const figures = make_figures(doc), links = [];
  for (const s of doc.sections) {
    const later = kAfterViewer.includes(s.id);
    document.getElementById(later ? 'later' : 'sections').append(section(s, figures.filter(f => f.section === s.id)));
    links.push({id: s.id, title: s.title, later});
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
