// Builds the page from its document: figures and tables by section, solver filter, contents, theme and motions.
import {button, element, unpacked} from './dom.js';
import {make_figures} from './figures.js';
import {looks, style_of, unique} from './look.js';
import {all_figures, figure_block, start_figures} from './plot.js';
import {hide_solvers, load_state, save_state, shown, state} from './state.js';
import {all_tables, reproduce, runs_of, solver_buttons, start_tables, table_block} from './tables.js';

const $ = id => document.getElementById(id);
const kMethod = ['features', 'environment'];

function start_theme() {
  const system = matchMedia('(prefers-color-scheme: dark)'), root = document.documentElement;
  const dark = () => root.style.colorScheme ? root.style.colorScheme === 'dark' : system.matches;
  const tell = () => $('theme').setAttribute('aria-pressed', String(dark()));
  $('theme').addEventListener('click', () => (root.style.colorScheme = dark() ? 'light' : 'dark', tell()));
  system.addEventListener('change', tell);
  tell();
}

function chips(doc, look) {
  const known = Object.keys(doc.solvers.look), place = s => known.includes(s) ? known.indexOf(s) : known.length;
  const solvers = unique(doc.runs.filter(r => !r.published).map(r => r.solver)).sort((a, b) => place(a) - place(b));
  const all = button('all', 'Show all solvers', () => hide_solvers([]), {hidden: !state.off.size});
  $('chips').append(...solver_buttons(look, solvers), all);
  addEventListener('solvers', () => all.hidden = !state.off.size);
}

/// A tile shows the best of the solvers that are shown, and below it the others.
function start_tiles(doc) {
  const places = document.querySelectorAll('.tile'), tell = () => doc.tiles.forEach(({title, entries}, k) => {
    const [best, ...rest] = [...entries.filter(e => shown(e.solver)), {value: '–', about: 'hidden by the solver filter'}], [name, value, others] = places[k].children;
    name.textContent = title + (best.label ? `, ${best.label}` : '');
    value.replaceChildren(`${best.value} `, element('small', {}, best.about));
    others.textContent = rest.slice(0, -1).map(e => `${e.label} ${e.value} (${e.about})`).join(' · ');
  });
  addEventListener('solvers', tell);
  tell();
}

/// The first screen has the first figure, below it the leading scenes, and next to them Table 3. All else follows in sections.
function sections(doc, look, motions) {
  const figures = make_figures(doc), hero = figures.find(f => f.hero), lead = doc.sections.flatMap(s => s.tables).slice(0, 2),
        below = doc.sections[0]?.id === 'overview' ? 1 : 0, links = [['overview', 'Overview']];
  const first = lead.map(t => table_block(doc, look, t));
  $('hero').replaceChildren(hero ? figure_block(doc, look, hero) : '', ...first.slice(0, below));
  $('first-table').replaceChildren(...first.slice(below));
  for (const s of doc.sections) {
    const blocks = [...figures.filter(f => f !== hero && f.section === s.id).map(f => figure_block(doc, look, f)), ...s.tables.filter(t => !lead.includes(t)).map(t => table_block(doc, look, t))];
    if (kMethod.includes(s.id)) {
      $('method-tables').append(...blocks);
    } else if (blocks.length) {
      const again = reproduce(doc, `section ${s.title}`, runs_of(doc, s.tables));
      const id = `${s.id}-title`, head = element('div', {class: 'head'}, element('h2', {id}, s.title), again);
      $('sections').append(element('section', {id: s.id, 'aria-labelledby': id}, head, blocks));
      links.push([s.id, s.title]);
    }
  }
  if (motions.runs.length) {
    $('motions').hidden = false;
    links.push(['motions', 'Motions']);
    start_motions(doc, motions);
  }
  $('contents').append(element('ol', {}, [...links, ['method', 'Method']].map(([id, title]) => element('li', {}, element('a', {href: `#${id}`}, title)))));
}

/// The viewer is a separate script, which starts when its section comes near the window.
function start_motions(doc, motions) {
  let loading;
  const load = () => {
    if (document.readyState === 'loading') return addEventListener('DOMContentLoaded', load);  // the motions come last in the file
    loading ??= unpacked('viewer-program').then(program => {
      (0, eval)(new TextDecoder().decode(program));
      window.clothbench.viewer = window.clothbench_viewer($('viewer'), motions, doc.runs);
    });
    return loading;
  };
  new IntersectionObserver(list => list.some(e => e.isIntersecting) && load(), {rootMargin: '300px'}).observe($('motions'));
  window.clothbench.load_viewer = load;
}

/// Blocks have no height before they are made, so all are made, and heads arranged, before the page scrolls to one.
async function go_to(id) {
  document.documentElement.classList.add('whole');
  dispatchEvent(new Event('whole'));
  await Promise.all(all_figures.map(f => f.view?.runAsync()));
  requestAnimationFrame(() => requestAnimationFrame(() => document.getElementById(id)?.scrollIntoView()));
}

function start_navigation() {
  const links = [...document.querySelectorAll('#contents a')], all = links.map(l => document.querySelector(l.hash));
  const bar = () => document.documentElement.style.setProperty('--bar', `${document.querySelector('header').offsetHeight}px`);
  const spy = () => {
    const edge = 0.3 * innerHeight, end = scrollY + innerHeight >= document.documentElement.scrollHeight - 2;
    const now = end ? all.at(-1) : all.findLast(s => s.getBoundingClientRect().top < edge) ?? all[0];
    links.forEach((l, k) => all[k] === now ? l.setAttribute('aria-current', 'true') : l.removeAttribute('aria-current'));
  };
  addEventListener('scroll', spy, {passive: true});  // at most once per frame
  addEventListener('resize', bar);
  const open = on => {
    $('contents').classList.toggle('open', on);
    $('menu').setAttribute('aria-expanded', String(on));
  };
  $('menu').addEventListener('click', () => open(!$('contents').classList.contains('open')));
  addEventListener('click', e => {
    const link = e.target.closest?.('a[href^="#"]');
    if (!link || link.classList.contains('skip')) return;
    e.preventDefault();  // the address also holds the reader's choices
    history.pushState(null, '', location.href);
    save_state(link.hash.slice(1));
    open(false);
    go_to(link.hash.slice(1));
  });
  addEventListener('popstate', () => {
    const anchor = load_state();
    dispatchEvent(new Event('solvers'));
    go_to(anchor || 'overview');
  });
  bar();
  spy();
}

async function start() {
  const data = async id => JSON.parse(new TextDecoder().decode(await unpacked(id)));
  const doc = await data('clothbench-data'), motions = await data('clothbench-motions'), anchor = load_state();
  doc.runs.forEach((r, k) => r.index = k);
  const look = looks(unique(doc.runs.map(r => r.solver)), doc.solvers);
  document.head.append(element('style', {}, style_of(look), `@page{@top-left{content:${JSON.stringify(doc.title)}}}`));
  document.documentElement.classList.add('js');
  window.clothbench = {document: doc, state, figures: all_figures, tables: all_tables};  // used by tests and the browser's console
  start_theme();
  chips(doc, look);
  start_tiles(doc);
  sections(doc, look, motions);
  $('conditions').append(...doc.notes.map(n => element('p', {class: 'note'}, n)));
  $('commands').append(...doc.studies.filter(s => s.command).map(s => element('p', {class: 'note'}, `${s.folder}: `, element('code', {}, s.command))));
  start_figures();
  start_tables();
  start_navigation();
  if (anchor) go_to(anchor);
  window.clothbench.ready_ms = performance.now();
}

start();
