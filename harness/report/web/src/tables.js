// Tables: sortable by a click on a head, filtered by solver and words, with an anchor and a command per row.
import {button, captioned, element, say} from './dom.js';
import {command_of, files_of} from './figures.js';
import {icon, unique} from './look.js';
import {hide_solvers, set_value, shown, state} from './state.js';

const kFew = 15, kMostKeys = 4, kShort = 40, kLong = 60, kNarrow = matchMedia('(max-width: 760px)'), kMedium = matchMedia('(max-width: 1180px)');
/// A cell of a document's table: a text, or [text, value, tone, index of a run, why]. Tables sort by the value and tint by the tone.
const typed = c => Array.isArray(c) ? {text: c[0], value: c[1] ?? undefined, tone: c[2], run: c[3] ?? undefined, why: c[4] || null} : {text: c};

const kLongCommand = 400;  // characters
export const shortened = text => text.length > kLongCommand ? `${text.slice(0, kLongCommand)} …` : text;

export function copy_command(command) {
  navigator.clipboard?.writeText(command).catch(() => {});
  say(`Copied: ${command}`);
  const note = element('div', {id: 'copied'}, 'Copied: ', element('code', {}, shortened(command)));
  document.getElementById('copied')?.remove();
  document.body.append(note);
  setTimeout(() => note.remove(), 6000);
}

/// A button that copies the commands of the runs' studies and names their files; null if none is known.
export function reproduce(doc, title, runs) {
  const all = command_of(doc, runs, true), files = runs[0]?.again ? [files_of(runs)] : unique(runs.map(r => r.study)).filter(k => doc.studies[k]).map(k => `${doc.studies[k].folder}/*.h5`);
  return all ? button('reproduce', `Reproduce ${title}: copy the command`, () => copy_command(all), {class: 'quiet', title: `${all}\nResult files: ${files.join(', ')}`}) : null;
}

/// All runs of tables, each once.
export const runs_of = (doc, tables) => unique(tables.flatMap(t => t.again.flat())).map(k => doc.runs[k]);

/// One button per solver, which hides or shows it in all figures, tables and motions.
export const solver_buttons = (look, solvers) => solvers.map(s => {
  const toggle = () => (hide_solvers(shown(s) ? [...state.off, s] : [...state.off].filter(o => o !== s)), say(`${s} ${shown(s) ? 'is shown' : 'is hidden'}`));
  const more = {title: 'Click: hide or show. Double click: only this solver.', 'data-solver': s, 'aria-pressed': String(shown(s)), ondblclick: () => hide_solvers(Object.keys(look).filter(o => o !== s))};
  return button([icon(look, s), s], null, toggle, more);
});

/// A head with an anchor; `more`: controls next to it.
export const block_head = (id, name, what, more) =>
    element('div', {class: 'head'}, element('h3', {}, name, element('a', {class: 'anchor', href: `#${id}`, 'aria-label': `Link to ${what}`}, '#')), more);

export const all_tables = [];

export class ShownTable {
  constructor(doc, look, table, id) {
    Object.assign(this, {doc, look, table, id});
    this.head = table.rows[0];
    this.body = table.rows.slice(1).map((cells, k) => ({cells: cells.map(typed), run: doc.runs[table.again[k][0]], runs: table.again[k].map(n => doc.runs[n])}));
    this.numeric = this.head.map((_, k) => this.body.some(r => r.cells[k].value !== undefined));
    this.place = element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': `Table: ${table.title}`, onscroll: () => this.tell_hidden()});
    this.rest = button('', null, () => (this.whole = !this.whole, this.fill()), {class: 'quiet', hidden: true});
    this.sizes = new ResizeObserver(() => this.tell_hidden());  // after the layout, so that no table needs one of its own
    this.hidden_columns = button('', null, () => this.place.scrollBy(0.6 * this.place.clientWidth, 0), {class: 'quiet', hidden: true});
    this.sizes.observe(this.place);
    this.find = element('input', {type: 'search', placeholder: `filter ${this.body.length} rows`, 'aria-label': `Filter ${table.title}`, hidden: this.body.length <= kFew, oninput: () => (this.picked = null, this.fill())});
    this.block = element(
        'div', {class: 'table', id, style: `contain-intrinsic-size: auto ${Math.min(this.body.length, kFew) * 27 + 110}px`},
        block_head(id, table.title, table.title, [this.find, this.hidden_columns, reproduce(doc, table.title, runs_of(doc, [table]))]), this.place, this.rest,
        table.note ? captioned('div', {class: 'note'}, table.note.replaceAll('`', '').split('\n')) : null);
  }

  sorted() {
    const {table} = this, [column, way] = (state.values[`${this.id}.sort`] ?? '').split('.'), k = this.head[Number(column)] === undefined || column === '' ? -1 : Number(column);
    this.sort = {k, down: way === 'down'};
    const words = this.find.value.toLowerCase().split(' '), has = r => this.picked ? r.run === this.picked : words.every(w => r.cells.some(c => c.text.toLowerCase().includes(w)));
    const left = this.body.filter(r => (!r.run || table.solver_column < 0 || shown(r.run.solver)) && has(r));
    if (k < 0) return left;
    const sign = way === 'down' ? -1 : 1;
    return left.sort((a, b) => {
      const [p, q] = [a.cells[k], b.cells[k]];
      if (!this.numeric[k]) return sign * p.text.localeCompare(q.text, 'en', {numeric: true});
      return (p.value === undefined) - (q.value === undefined) || sign * (p.value - q.value) || 0;
    });
  }

  /// Orders the columns. In a narrow window the first cell also shows the other short keys.
  arrange() {
    const {solvers, keys = 1, lead = []} = this.table, short = k => this.body.every(r => r.cells[k].text.length <= kShort);
    const joins = !this.prints && keys <= kMostKeys && (kNarrow.matches || (keys > 2 && kMedium.matches));
    const rank = k => k < keys ? 0 : lead.includes(k) ? 1 : 2, all = this.head.map((_, k) => k).filter(k => shown(solvers[k]));
    this.joined = joins ? all.filter(k => k > 0 && k < keys && short(k)) : [];
    this.columns = all.filter(k => !this.joined.includes(k)).sort((a, b) => rank(a) - rank(b));
  }

  /// Shows how many columns are hidden to the right. The first key stays in view; the second does if half of the box is enough.
  tell_hidden() {
    const edge = this.place.getBoundingClientRect().right + 1, heads = [...this.place.querySelectorAll('thead th')], [first, second] = heads.map(h => h.offsetWidth);
    const keys = kNarrow.matches ? 0 : this.table.keys - this.joined?.length, count = heads.filter(h => h.getBoundingClientRect().right > edge).length;
    this.place.classList.toggle('held', keys > 1 && first + second <= this.place.clientWidth * 0.55);
    this.place.style.setProperty('--until-2', `${first}px`);
    this.hidden_columns.textContent = `${count} more ${count === 1 ? 'column' : 'columns'} →`;
    this.hidden_columns.hidden = !count;
  }

  head_cell(h, k) {
    if (this.prints) return element('th', {scope: 'col', class: this.numeric[k] && 'n'}, h);
    const on = this.sort.k === k, [first, second] = this.numeric[k] ? ['down', 'up'] : ['up', 'down'];
    const next = !on ? first : this.sort.down === (first === 'down') ? second : null;  // the third click restores the order
    const sort = () => {
      set_value(`${this.id}.sort`, next && `${k}.${next}`);
      this.fill();
      this.place.querySelectorAll('thead button')[this.columns.indexOf(k)]?.focus();
    };
    const arrow = on ? element('span', {'aria-hidden': 'true'}, this.sort.down ? ' ↓' : ' ↑') : null;
    return element(
        'th', {scope: 'col', class: this.numeric[k] && 'n', 'aria-sort': on && (this.sort.down ? 'descending' : 'ascending')},
        button([h || ' ', arrow], null, sort));
  }

  cell(cells, k, run) {
    const {text, value, tone} = cells[k], named = this.doc.runs[cells[k].run], long = k > 0 && text.length > kLong, shape = long ? 'long' : this.numeric[k] ? 'n' : '', more = k === 0 ? this.joined : [];
    const parts = j => [
      j === this.table.solver_column && cells[j].run !== undefined ? icon(this.look, run.solver) : null,
      ...cells[j].text.split(more.length ? /(?<=_)/ : /(?<= )(?=\((?:first|CPU))/).flatMap((part, n) => more.length ? [n ? element('wbr') : null, part] : [n ? element('small', {}, part) : part])
    ];
    const content = (named && k !== this.table.solver_column && this.criteria(named, text)) || (long && !this.prints ? element('div', {tabindex: '0'}, text) : parts(k));
    return element(
        k === 0 ? 'th' : 'td', {scope: k === 0 && 'row', class: [shape, tone].filter(Boolean).join(' ') || null, 'data-value': value, title: cells[k].why}, content,
        ...more.map(j => element('small', {}, ...parts(j).filter(p => p !== null))));
  }

  /// A link from a failed run to the criteria that it violates; null if no other table lists them.
  criteria(run, text) {
    const list = all_tables.find(t => t.table.explains && t !== this && t.body.some(r => r.run === run));
    const pick = () => (list.picked = run, Object.assign(list.find, {hidden: false, value: `${run.scene}, ${run.label}`}), list.fill());
    return list ? element('a', {href: `#${list.id}`, title: 'Show the criteria that it violates', onclick: pick}, text) : null;
  }

  /// The button that copies a row's command, which repeats all of its runs.
  again({cells, runs}) {
    const mine = runs.filter(r => this.doc.studies[r.study]?.command), label = `Copy the command of ${cells.slice(0, 3).map(c => c.text).join(', ')}`;
    const command = () => command_of(this.doc, mine), tell = e => e.currentTarget.title ||= `${shortened(command())}\n${files_of(mine)}`;
    return mine.length ? button('copy', label, () => copy_command(command()), {class: 'quiet', onpointerenter: tell, onfocus: tell}) : null;
  }

  fill() {
    const all = this.sorted(), rows = this.prints || this.whole ? all : all.slice(0, kFew), {head} = this, buttons = rows.map(r => this.prints ? null : this.again(r)), any = buttons.some(Boolean);
    this.arrange();
    const titles = [this.columns.map(k => this.head_cell([k, ...(k === 0 ? this.joined : [])].map(j => head[j]).join(', '), k)), any ? element('th', {scope: 'col'}, 'run again') : null];
    const body = rows.map(({cells, run}, n) => {
      const last = any ? element('td', {}, buttons[n] ?? '') : null;
      return element('tr', {class: run?.published && 'published'}, this.columns.map(k => this.cell(cells, k, run)), last);
    });
    const table = element('table', {}, element('thead', {}, element('tr', {}, ...titles)), element('tbody', {}, body));
    this.place.replaceChildren(table);
    this.place.classList.toggle('whole', rows.length > kFew);
    this.rest.hidden = all.length <= kFew;
    this.rest.textContent = this.whole ? `show the first ${kFew} rows` : `show all ${all.length} rows`;
    this.sizes.observe(table);
    this.filled = true;
  }
}

export function table_block(doc, look, table) {
  const base = `t-${table.title.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 60)}`, same = all_tables.filter(t => t.id.startsWith(base)).length;
  const t = new ShownTable(doc, look, table, same ? `${base}-${same + 1}` : base);
  all_tables.push(t);
  return t.block;
}

/// Makes blocks as they come near the window, and all of them for printing. After a change of the filter, remakes those near
/// the window at once and all others later.
export function near_window(list, make) {
  const near = new Set(), by_block = new Map(list.map(t => [t.block, t]));
  let due = new Set(list);
  const make_due = some => [...some].filter(t => due.delete(t)).forEach(make);
  const watch = new IntersectionObserver(entries => {
    for (const e of entries) near[e.isIntersecting ? 'add' : 'delete'](by_block.get(e.target));
    make_due(near);
  }, {rootMargin: '500px'});
  list.forEach(t => watch.observe(t.block));
  addEventListener('solvers', () => (due = new Set(list), make_due(near)));
  for (const event of ['whole', 'beforeprint']) addEventListener(event, () => make_due(list));
}

export function start_tables() {
  const fill = () => all_tables.filter(t => t.filled).forEach(t => t.fill());
  near_window(all_tables, t => t.fill());
  for (const width of [kNarrow, kMedium]) width.addEventListener('change', fill);
  const print = on => (all_tables.forEach(t => t.prints = on), fill());
  addEventListener('beforeprint', () => print(true));
  addEventListener('afterprint', () => print(false));
  addEventListener('solvers', () => document.querySelectorAll('[data-solver]').forEach(b => b.setAttribute('aria-pressed', String(shown(b.dataset.solver)))));
}
