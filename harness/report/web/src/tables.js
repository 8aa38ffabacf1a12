// Tables: sorted by a click on a head, folded at 15 rows, filtered by solver, each with an anchor and the command of a row.
import {symbol} from './chart.js';
import {button, element, file_name, say} from './dom.js';
import {command_of} from './figures.js';
import {page_look, set_value, shown, state} from './state.js';

const kFolded = 15;
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

/// A button that copies the commands of the studies that the runs come from; null if none is known.
export function reproduce(doc, title, runs) {
  const commands = [...new Set(runs.map(r => r?.study).filter(s => s !== undefined))].map(s => doc.studies[s].command).filter(Boolean);
  const all = commands.join('\n'), label = `Reproduce ${title}: copy the command`;
  return commands.length ? button('reproduce', label, () => copy_command(all), {class: 'quiet', title: all}) : null;
}

/// A head with an anchor; `more`: controls beside it.
export const block_head = (id, name, what, more) =>
    element('div', {class: 'head'}, element('h3', {}, name, element('a', {class: 'anchor', href: `#${id}`, 'aria-label': `Link to ${what}`}, '#')), more);

export class ShownTable {
  constructor(doc, look, table, id) {
    Object.assign(this, {doc, look, table, id, open: false});
    this.head = table.rows[0];
    this.body = table.rows.slice(1).map((cells, k) => ({cells: cells.map(typed), run: doc.runs[table.runs[k]]}));
    this.numeric = this.head.map((_, k) => this.body.some(r => r.cells[k].value !== undefined));
    this.place = element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': `Table: ${table.title}`});
    this.more = button('Show all rows', null, () => {
      this.open = !this.open;
      this.fill();
    }, {class: 'more'});
    this.block = element(
        'div', {class: 'table', id}, block_head(id, table.title, table.title, reproduce(doc, table.title, table.runs.map(k => doc.runs[k]))),
        this.place, element('div', {class: 'bar small'}, this.more),
        table.note ? element('p', {class: 'note'}, table.note.replaceAll('`', '')) : null);
  }

  sorted() {
    const {table} = this, [column, way] = (state.values[`${this.id}.sort`] ?? '').split('.'),
                   k = this.head[Number(column)] === undefined || column === '' ? -1 : Number(column);
    this.sort = {k, down: way === 'down'};
    const left = this.body.filter(r => !r.run || table.solver_column < 0 || shown(r.run.solver));
    if (k < 0) return left;
    const sign = way === 'down' ? -1 : 1;
    return left.sort((a, b) => {
      const [p, q] = [a.cells[k], b.cells[k]];
      if (!this.numeric[k]) return sign * p.text.localeCompare(q.text, 'en', {numeric: true});
      return (p.value === undefined) - (q.value === undefined) || sign * (p.value - q.value) || 0;
    });
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

  cell({text, value, tone}, k, run) {
    const shape = this.numeric[k] ? 'n' : text.length > 60 ? 'long' : '';
    const c = element(k === 0 ? 'th' : 'td', {scope: k === 0 && 'row', class: [shape, tone].filter(Boolean).join(' ') || null, 'data-value': value});
    if (k === this.table.solver_column && run && !run.published)
      c.innerHTML = `<svg class="icon" viewBox="-7 -7 14 14" aria-hidden="true">${symbol(page_look(this.look), run.solver, 0, 0)}</svg>`;
    c.append(text);
    return c;
  }

  /// The button that copies the command of a row.
  again({cells, run}) {
    const command = run && !run.published ? command_of(this.doc, run) : null, label = `Copy the command of ${cells.slice(0, 3).map(c => c.text).join(', ')}`;
    return command ? button('copy', label, () => copy_command(command), {class: 'quiet', title: [command, run.file].filter(Boolean).join('\n')}) : null;
  }

  fill() {
    const rows = this.sorted(), {table, head} = this, buttons = rows.map(r => this.again(r)), any = buttons.some(Boolean);
    this.columns = head.map((_, k) => k).filter(k => shown(table.solvers[k]));
    const titles = [this.columns.map(k => this.head_cell(head[k], k)), any ? element('th', {scope: 'col'}, 'run again') : null];
    const body = (this.open ? rows : rows.slice(0, kFolded)).map(({cells, run}, n) => {
      const last = any ? element('td', {}, buttons[n] ?? '') : null;
      return element('tr', {class: run?.published && 'published'}, this.columns.map(k => this.cell(cells[k], k, run)), last);
    });
    this.place.replaceChildren(element('table', {}, element('thead', {}, element('tr', {}, ...titles)), element('tbody', {}, body)));
    this.more.hidden = rows.length <= kFolded;
    this.more.textContent = this.open ? `Show ${kFolded} rows` : `Show all ${rows.length} rows`;
    this.filled = true;
  }
}

const tables = [];

export function table_block(doc, look, table) {
  const base = `t-${file_name(table.title)}`, same = tables.filter(t => t.id.startsWith(base)).length;
  const t = new ShownTable(doc, look, table, same ? `${base}-${same + 1}` : base);
  tables.push(t);
  return t.block;
}

/// Makes blocks as they come near the window, and all of them to print; those that are made again after a change of the
/// filter.
export function near_window(list, made, make) {
  const near = new IntersectionObserver(
      entries => list.filter(t => !made(t) && entries.some(e => e.isIntersecting && e.target === t.block)).forEach(make),
      {rootMargin: '500px'});
  list.forEach(t => near.observe(t.block));
  addEventListener('solvers', () => list.filter(made).forEach(make));
  addEventListener('beforeprint', () => list.filter(t => !made(t)).forEach(make));
}

export const start_tables = () => near_window(tables, t => t.filled, t => t.fill());
