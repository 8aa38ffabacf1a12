// Tables: sorted by a click on a head, folded at 15 rows, filtered by solver, each with an anchor and the command of a row.
import {symbol} from './chart.js';
import {download, element, file_name, say} from './dom.js';
import {command_of} from './figures.js';
import {on_change, page_look, set_value, shown, state} from './state.js';

const csv_field = text => /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
const to_csv = rows => rows.map(row => row.map(csv_field).join(',') + '\n').join('');

const kFolded = 15;
const kBad = /^(fail\b|diverged|not_finite|timed_out|device_lost|crashed|error\b)/;
const kDim = /^(unsupported|missing|ignored|not measured|not ranked|–)/;
const kGood = /^pass\b/;
const kScale = {
  k: 1e3,
  M: 1e6
};

/// The number or share ("3/5", "3 of 5") that a cell starts with, for sorting and alignment; NaN for text.
export function value_of(text) {
  const share = text.match(/^(\d+)(?:\/| of )(\d+)(?![\d.])/);
  if (share) return share[1] / share[2];
  const m = text.match(/^[≤≥<>~]?\s?([-−]?\d[\d.]*(?:e[-+]?\d+)?)([kM](?![a-z]))?/);
  return m && !/^\d+-\D|^\d{4}-/.test(text) ? Number(m[1].replace('−', '-')) * (kScale[m[2]] ?? 1) : NaN;
}

export function copy_command(command) {
  navigator.clipboard?.writeText(command).catch(() => {});
  say(`Copied: ${command}`);
  const note = element('div', {id: 'copied'}, 'Copied: ', element('code', {}, command));
  document.getElementById('copied')?.remove();
  document.body.append(note);
  setTimeout(() => note.remove(), 6000);
}

export class ShownTable {
  constructor(doc, look, table, id) {
    Object.assign(this, {doc, look, table, id, open: false});
    const [head, ...body] = table.rows;
    this.numeric = head.map(
        (_, k) => body.filter(r => !Number.isNaN(value_of(r[k])) || r[k] === '–').length * 2 >= body.length &&
            body.some(r => !Number.isNaN(value_of(r[k]))));
    this.place = element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': `Table: ${table.title}`});
    this.more = element(
        'button', {
          type: 'button',
          class: 'more',
          onclick: () => {
            this.open = !this.open;
            this.fill();
          }
        },
        'Show all rows');
    this.block = element(
        'div', {class: 'table', id: this.id},
        element(
            'div', {class: 'head'},
            element(
                'h3', {}, table.title, element('a', {class: 'anchor', href: `#${this.id}`, 'aria-label': `Link to ${table.title}`}, '#')),
            this.reproduce()),
        this.place,
        element(
            'div', {class: 'bar small'}, this.more,
            element(
                'button', {
                  type: 'button',
                  'aria-label': `${table.title}: download as CSV`,
                  onclick: () => download(`${file_name(table.title)}.csv`, 'text/csv', to_csv(table.rows))
                },
                'CSV')),
        table.note ? element('p', {class: 'note'}, table.note.replaceAll('`', '')) : '');
  }

  /// The commands of the studies that the table's runs come from.
  reproduce() {
    const studies = [...new Set(this.table.runs.map(k => this.doc.runs[k]?.study).filter(s => s !== undefined))];
    const commands = studies.map(s => this.doc.studies[s].command).filter(Boolean);
    return commands.length ? element(
                                 'button', {
                                   type: 'button',
                                   class: 'quiet',
                                   title: commands.join('\n'),
                                   'aria-label': `Reproduce ${this.table.title}: copy the command`,
                                   onclick: () => copy_command(commands.join('\n'))
                                 },
                                 'reproduce') :
                             null;
  }

  sorted() {
    const {table} = this, [head, ...body] = table.rows, rows = body.map((cells, k) => ({cells, run: this.doc.runs[table.runs[k]]}));
    const [column, way] = (state.values[`${this.id}.sort`] ?? '').split('.'),
                   k = head[Number(column)] === undefined || column === '' ? -1 : Number(column);
    this.sort = {k, down: way === 'down'};
    const left = rows.filter(r => !r.run || table.solver_column < 0 || shown(r.run.solver));
    if (k < 0) return left;
    const sign = way === 'down' ? -1 : 1, value = r => value_of(r.cells[k]);
    return left.sort((a, b) => {
      const [p, q] = [value(a), value(b)], none = Number.isNaN(p) - Number.isNaN(q);
      if (!this.numeric[k]) return sign * a.cells[k].localeCompare(b.cells[k], 'en', {numeric: true});
      return none || sign * (p - q) || 0;
    });
  }

  head_cell(h, k) {
    const on = this.sort.k === k, next = on ? (this.sort.down ? 'up' : 'down') : this.numeric[k] ? 'down' : 'up';
    return element(
        'th', {scope: 'col', class: this.numeric[k] ? 'n' : null, 'aria-sort': on ? (this.sort.down ? 'descending' : 'ascending') : null},
        element(
            'button', {
              type: 'button',
              onclick: () => {
                set_value(`${this.id}.sort`, `${k}.${next}`);
                this.fill();
                this.place.querySelectorAll('thead button')[this.columns.indexOf(k)]?.focus();
              }
            },
            h || ' ', on ? element('span', {'aria-hidden': 'true'}, this.sort.down ? ' ↓' : ' ↑') : null));
  }

  cell(text, k, run) {
    const icon = k === this.table.solver_column && run && !run.published ?
        `<svg class="icon" viewBox="-7 -7 14 14" aria-hidden="true">${symbol(page_look(this.look), run.solver, 0, 0)}</svg>` :
        '';
    const tone = kBad.test(text) || / !$/.test(text) ? 'bad' : kGood.test(text) ? 'good' : kDim.test(text) ? 'dim' : '';
    const c = element(k === 0 ? 'th' : 'td', {
      scope: k === 0 ? 'row' : null,
      class:
          [this.numeric[k]      ? 'n' :
               text.length > 60 ? 'long' :
                                  '',
           tone]
              .filter(Boolean)
              .join(' ') ||
          null
    });
    c.innerHTML = icon;
    c.append(text);
    return c;
  }

  fill() {
    const rows = this.sorted(), {table} = this, [head] = table.rows;
    this.columns = head.map((_, k) => k).filter(k => shown(table.solvers[k]));
    const commands = rows.map(r => r.run && !r.run.published ? command_of(this.doc, r.run) : null), any = commands.some(Boolean);
    const shown_rows = this.open ? rows : rows.slice(0, kFolded);
    this.place.replaceChildren(element(
        'table', {},
        element(
            'thead', {},
            element('tr', {}, this.columns.map(k => this.head_cell(head[k], k)), any ? element('th', {scope: 'col'}, 'run again') : null)),
        element(
            'tbody', {},
            shown_rows.map(
                (r, n) => element(
                    'tr', {class: r.run?.published ? 'published' : null}, this.columns.map(k => this.cell(r.cells[k], k, r.run)),
                    any ? element(
                              'td', {},
                              commands[n] ? element(
                                                'button', {
                                                  type: 'button',
                                                  class: 'quiet',
                                                  title: `${commands[n]}${r.run.file ? `\n${r.run.file}` : ''}`,
                                                  'aria-label': `Copy the command of ${r.cells.slice(0, 3).join(', ')}`,
                                                  onclick: () => copy_command(commands[n])
                                                },
                                                'copy') :
                                                                                       '') :
                                                                                       null)))));
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
  on_change(() => list.filter(made).forEach(make));
  addEventListener('beforeprint', () => list.filter(t => !made(t)).forEach(make));
}

export const start_tables = () => near_window(tables, t => t.filled, t => t.fill());
