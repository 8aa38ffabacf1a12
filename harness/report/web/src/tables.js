// Tables: sortable by a click on a head, folded at 15 rows, filtered by solver, with an anchor and a command per row.
import {button, element, file_name, say} from './dom.js';
import {command_of} from './figures.js';
import {icon} from './look.js';
import {set_value, shown, state} from './state.js';

const kFolded = 15, kMostKeys = 4, kShort = 40, kLong = 60, kNarrow = matchMedia('(max-width: 760px)');
/// A cell of a document's table: a text, or [text, value, tone]. Tables sort by the value and tint by the tone.
const typed = c => Array.isArray(c) ? {text: c[0], value: c[1] ?? undefined, tone: c[2]} : {text: c};

export function copy_command(command) {
  navigator.clipboard?.writeText(command).catch(() => {});
  say(`Copied: ${command}`);
  const note = element('div', {id: 'copied'}, 'Copied: ', element('code', {}, command));
  document.getElementById('copied')?.remove();
  document.body.append(note);
  setTimeout(() => note.remove(), 6000);
}

/// A button that copies the commands of the runs' studies and names their files; null if none is known.
export function reproduce(doc, title, runs) {
  const studies = [...new Set(runs.map(r => r?.study).filter(s => s !== undefined))].map(s => doc.studies[s]).filter(s => s.command);
  const all = studies.map(s => s.command).join('\n'), files = `\nResult files: ${studies.map(s => `${s.folder}/*.h5`).join(', ')}`;
  return all ? button('reproduce', `Reproduce ${title}: copy the command`, () => copy_command(all), {class: 'quiet', title: all + files}) : null;
}

/// A head with an anchor; `more`: controls next to it.
export const block_head = (id, name, what, more) =>
    element('div', {class: 'head'}, element('h3', {}, name, element('a', {class: 'anchor', href: `#${id}`, 'aria-label': `Link to ${what}`}, '#')), more);

export class ShownTable {
  constructor(doc, look, table, id) {
    Object.assign(this, {doc, look, table, id, open: false});
    this.head = table.rows[0];
    this.body = table.rows.slice(1).map((cells, k) => ({cells: cells.map(typed), run: doc.runs[table.runs[k]], runs: table.again[k].map(n => doc.runs[n])}));
    this.numeric = this.head.map((_, k) => this.body.some(r => r.cells[k].value !== undefined));
    this.place = element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': `Table: ${table.title}`, onscroll: () => this.tell_hidden()});
    this.hidden_columns = button('', null, () => this.place.scrollBy(0.6 * this.place.clientWidth, 0), {class: 'quiet', hidden: true});
    new ResizeObserver(() => this.tell_hidden()).observe(this.place);
    this.find = element('input', {type: 'search', placeholder: 'filter rows', 'aria-label': `Filter ${table.title}`, hidden: this.body.length <= kFolded, oninput: () => this.fill()});
    this.more = button('Show all rows', null, () => {
      this.open = !this.open;
      this.fill();
    }, {class: 'more'});
    this.block = element(
        'div', {class: 'table', id},
        block_head(id, table.title, table.title, [this.find, this.hidden_columns, reproduce(doc, table.title, table.runs.map(k => doc.runs[k]))]), this.place, element('div', {class: 'bar small'}, this.more),
        table.note ? element('p', {class: 'note'}, table.note.replaceAll('`', '')) : null);
  }

  sorted() {
    const {table} = this, [column, way] = (state.values[`${this.id}.sort`] ?? '').split('.'),
                   k = this.head[Number(column)] === undefined || column === '' ? -1 : Number(column);
    this.sort = {k, down: way === 'down'};
    const words = this.find.value.toLowerCase().split(' '), has = r => words.every(w => r.cells.some(c => c.text.toLowerCase().includes(w)));
    const left = this.body.filter(r => (!r.run || table.solver_column < 0 || shown(r.run.solver)) && has(r));
    if (k < 0) return left;
    const sign = way === 'down' ? -1 : 1;
    return left.sort((a, b) => {
      const [p, q] = [a.cells[k], b.cells[k]];
      if (!this.numeric[k]) return sign * p.text.localeCompare(q.text, 'en', {numeric: true});
      return (p.value === undefined) - (q.value === undefined) || sign * (p.value - q.value) || 0;
    });
  }

  /// Orders the columns. In a narrow window the first cell also shows the other short keys, and detail columns come last.
  arrange() {
    const {solvers, keys = 1, late = []} = this.table, short = k => this.body.every(r => r.cells[k].text.length <= kShort);
    this.columns = this.head.map((_, k) => k).filter(k => shown(solvers[k]));
    this.joined = kNarrow.matches && keys <= kMostKeys ? this.columns.filter(k => k > 0 && k < keys && short(k)) : [];
    if (kNarrow.matches) this.columns = this.columns.filter(k => !this.joined.includes(k)).sort((a, b) => late.includes(a) - late.includes(b));
  }

  /// Shows how many columns are hidden to the right. The second key stays in view if both keys fit into half of the box.
  tell_hidden() {
    const edge = this.place.getBoundingClientRect().right + 1, heads = [...this.place.querySelectorAll('thead th')];
    const [first = 0, second = Infinity] = heads.map(h => h.offsetWidth), can_hold = this.table.keys > 1 && !kNarrow.matches;
    this.place.classList.toggle('held', can_hold && first + second <= this.place.clientWidth / 2);
    this.place.style.setProperty('--second', `${first}px`);
    const count = heads.filter(h => h.getBoundingClientRect().right > edge).length;
    this.hidden_columns.textContent = `${count} more ${count === 1 ? 'column' : 'columns'} →`;
    this.hidden_columns.hidden = !count;
  }

  head_cell(h, k) {
    const on = this.sort.k === k, next = on ? (this.sort.down ? 'up' : 'down') : this.numeric[k] ? 'down' : 'up';
    const sort = () => {
      set_value(`${this.id}.sort`, `${k}.${next}`);
      this.fill();
      this.place.querySelectorAll('thead button')[this.columns.indexOf(k)]?.focus();
    };
    const arrow = on ? element('span', {'aria-hidden': 'true'}, this.sort.down ? ' ↓' : ' ↑') : null;
    return element(
        'th', {scope: 'col', class: this.numeric[k] && 'n', 'aria-sort': on && (this.sort.down ? 'descending' : 'ascending')},
        button([h || ' ', arrow], null, sort));
  }

  cell(cells, k, run) {
    const {text, value, tone} = cells[k], long = k > 0 && text.length > kLong, shape = long ? 'long' : this.numeric[k] ? 'n' : '', more = k === 0 ? this.joined : [];
    const c = element(k === 0 ? 'th' : 'td', {scope: k === 0 && 'row', class: [shape, tone].filter(Boolean).join(' ') || null, 'data-value': value});
    if ([k, ...more].includes(this.table.solver_column) && run && !run.published)
      c.innerHTML = icon(this.look[run.solver]);
    c.append(long ? element('div', {tabindex: '0'}, text) : text, ...more.map(j => element('small', {}, cells[j].text)));
    return c;
  }

  /// The button that copies a row's command, which repeats all of its runs.
  again({cells, runs}) {
    const command = command_of(this.doc, runs.filter(r => !r.published)), label = `Copy the command of ${cells.slice(0, 3).map(c => c.text).join(', ')}`;
    return command ? button('copy', label, () => copy_command(command), {class: 'quiet', title: [command, ...runs.map(r => r.file)].filter(Boolean).join('\n')}) : null;
  }

  fill() {
    const rows = this.sorted(), {head} = this, buttons = rows.map(r => this.again(r)), any = buttons.some(Boolean);
    this.arrange();
    const titles = [this.columns.map(k => this.head_cell([k, ...(k === 0 ? this.joined : [])].map(j => head[j]).join(', '), k)), any ? element('th', {scope: 'col'}, 'run again') : null];
    const body = (this.open ? rows : rows.slice(0, kFolded)).map(({cells, run}, n) => {
      const last = any ? element('td', {}, buttons[n] ?? '') : null;
      return element('tr', {class: run?.published && 'published'}, this.columns.map(k => this.cell(cells, k, run)), last);
    });
    this.place.replaceChildren(element('table', {}, element('thead', {}, element('tr', {}, ...titles)), element('tbody', {}, body)));
    this.more.hidden = rows.length <= kFolded;
    this.more.textContent = this.open ? `Show ${kFolded} rows` : `Show all ${rows.length} rows`;
    this.filled = true;
    this.tell_hidden();
  }
}

const tables = [];

export function table_block(doc, look, table) {
  const base = `t-${file_name(table.title)}`, same = tables.filter(t => t.id.startsWith(base)).length;
  const t = new ShownTable(doc, look, table, same ? `${base}-${same + 1}` : base);
  tables.push(t);
  return t.block;
}

/// Makes blocks as they come near the window, and all of them for printing; remakes them after a change of the filter.
export function near_window(list, made, make) {
  const near = new IntersectionObserver(
      entries => list.filter(t => !made(t) && entries.some(e => e.isIntersecting && e.target === t.block)).forEach(make),
      {rootMargin: '500px'});
  list.forEach(t => near.observe(t.block));
  addEventListener('solvers', () => list.filter(made).forEach(make));
  addEventListener('beforeprint', () => list.filter(t => !made(t)).forEach(make));
}

export function start_tables() {
  near_window(tables, t => t.filled, t => t.fill());
  kNarrow.addEventListener('change', () => tables.filter(t => t.filled).forEach(t => t.fill()));
}
