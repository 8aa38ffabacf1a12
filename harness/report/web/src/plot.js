// A figure on the page: values on hover and by keyboard, controls, a table of its values. It is drawn when it comes near the
// window.
import {button, captioned, element, say, select} from './dom.js';
import {view_of} from './draw.js';
import {command_of, files_of, settled} from './figures.js';
import {unique} from './look.js';
import {set_value, shown, state} from './state.js';
import {block_head, copy_command, near_window, reproduce, shortened, ShownTable, solver_buttons} from './tables.js';

const tip = element('div', {id: 'tip', role: 'status', hidden: true});
export const all_figures = [];
let pinned = null;  // the figure whose value stays in view until it is closed

/// The runs behind a row; a row of a log has its own command, and no run in this report.
const runs_of = r => r.again ? [r] : r.behind ?? [r];

class Figure {
  constructor(doc, look, entry) {
    Object.assign(this, {doc, look, entry, marks: [], at: -1, drawn: 0});
    this.plot = element('div', {class: 'plot', tabindex: '0', role: 'group', 'aria-label': 'Figure. Left and right arrow: next value. Enter: copy the command of its run.'});
    this.heading = element('span', {});
    this.remark = element('p', {class: 'note'});
    this.legend = element('div', {class: 'solvers legend', role: 'group', 'aria-label': 'Legend: solvers of this figure'});
    this.values = element('div', {});
    this.choices = entry.choices ?? [];
    this.controls = this.choices.map(({label}) => select(label, [], '', v => {
      set_value(`${entry.id}.${label}`, v);
      this.redraw();
    }));
    this.details = element('details', {ontoggle: () => this.show_values()}, element('summary', {}, 'Values'), this.values);
    this.again = element('span', {});
    this.block = element('figure', {id: entry.id}, block_head(entry.id, this.heading, `figure ${entry.id}`, [...this.controls, this.again]), this.plot, this.legend,
                         captioned('figcaption', {}, entry.caption.split('\n')), this.remark, element('div', {class: 'bar small'}, this.details));
    this.listen();
    all_figures.push(this);
  }

  listen() {
    const mark_of = e => Number(e.target.dataset.i ?? -1), leave = () => pinned || this.point(-1);
    this.plot.addEventListener('pointermove', e => pinned || this.point(mark_of(e), e.clientX, e.clientY));
    for (const event of ['pointerleave', 'blur']) this.plot.addEventListener(event, leave);
    this.plot.addEventListener('click', e => {
      unpin();
      this.point(mark_of(e), e.clientX, e.clientY, true);
      e.stopPropagation();
    });
    this.plot.addEventListener('keydown', e => {
      const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[e.key];
      if (step && this.marks.length) {
        const at = (this.at + step + this.marks.length) % this.marks.length, box = this.elements(at).at(-1)?.getBoundingClientRect();
        this.point(at, box?.right ?? 0, box?.bottom ?? 0);
        say(tip.textContent);
        e.preventDefault();
      } else if (e.key === 'Enter' && this.command) {
        copy_command(this.command);
      }
    });
  }

  /// The SVG elements that draw a row.
  elements(at) { return [...this.plot.querySelectorAll(`[data-i="${at}"]`)]; }

  point(at, x, y, pin = false) {
    if (at !== this.at) {
      for (const e of this.elements(this.at)) e.classList.remove('on');
      for (const e of this.elements(at)) e.classList.add('on');
    }
    this.at = at;
    const row = this.marks[at], runs = row && runs_of(row);
    this.command = row && command_of(this.doc, runs);
    pinned = pin && row ? this : null;
    tip.hidden = !row;
    if (!row) return;
    const copy = this.command && button('Copy the command', null, () => copy_command(this.command));
    const lines = [...this.entry.tip(row), files_of(runs), shortened(this.command)].filter(Boolean);
    tip.replaceChildren(lines.join('\n'), ...(pinned ? [element('div', {class: 'bar'}, copy, button('Close', null, unpin))] : []));
    const box = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(6, Math.min(x + 14, innerWidth - box.width - 8))}px`;
    tip.style.top = `${y + 18 + box.height > innerHeight ? y - box.height - 12 : y + 18}px`;
  }

  settle() {
    const given = Object.fromEntries(this.choices.map(c => [c.label, state.values[`${this.entry.id}.${c.label}`]]));
    const chosen = settled(this.entry, given);
    this.choices.forEach(({label, options}, k) => {
      const list = options(chosen), box = this.controls[k].querySelector('select');
      box.replaceChildren(...list.map(o => new Option(o.text, o.value, o.value === chosen[label], o.value === chosen[label])));
      this.controls[k].hidden = list.length < 2;
    });
    return chosen;
  }

  async redraw() {
    const {entry} = this;
    this.state = this.settle();
    const all = entry.rows(this.state), rows = this.rows = all.filter(r => shown(r.solver)), width = Math.max(280, Math.floor(this.plot.clientWidth));
    this.heading.textContent = entry.title(this.state);
    this.again.replaceChildren(reproduce(this.doc, `figure ${entry.id}`, rows.flatMap(runs_of)) ?? '');
    this.show_legend(unique(all.filter(entry.drawn ?? Boolean).map(r => r.solver)));
    this.remark.textContent = entry.remark?.(this.state) ?? '';
    this.drawn = width;
    this.marks = rows.filter(entry.drawn ?? Boolean);
    this.show_values();
    this.view?.finalize();
    this.view = null;
    if (!this.marks.length) return this.plot.replaceChildren(element('p', {class: 'note'}, 'No runs are left: see the solver filter above.'));
    const place = element('div', {}), look = {solvers: this.look, font: getComputedStyle(document.body).fontFamily};
    const view = this.view = view_of(entry, rows, this.state, look, width).initialize(place);
    await view.runAsync();
    if (this.view !== view) return;
    for (const e of place.querySelectorAll('.role-mark:not(.mark-line) > *'))
      if (e.__data__?.datum?.i >= 0) e.dataset.i = e.__data__.datum.i;  // Vega's item; `i` is from draw.js
    for (const [name, value] of [['role', 'img'], ['aria-label', entry.title(this.state)]]) place.querySelector('svg').setAttribute(name, value);
    place.querySelector('svg > g').setAttribute('aria-hidden', 'true');
    this.plot.replaceChildren(place);
  }

  /// A legend of all solvers that the figure can show. Its buttons stay when a solver is hidden, and so does the focus.
  show_legend(solvers) {
    if (this.legend.dataset.of === solvers.join()) return;
    this.legend.dataset.of = solvers.join();
    this.legend.replaceChildren(...(this.entry.legend === false || solvers.length < 2 ? [] : solver_buttons(this.look, solvers)));
  }

  show_values() {
    if (!this.details.open) return;
    const {entry, doc, rows} = this;
    const table = {
      title: `Values: ${entry.title(this.state)}`,
      rows: [entry.columns, ...rows.map(r => entry.columns.map(name => typeof r[name] === 'number' ? [String(r[name]), r[name]] : String(r[name] ?? '')))],
      again: rows.map(r => (r.behind ?? [r]).map(d => d.index)), solver_column: -1, solvers: []
    };
    const values = new ShownTable(doc, this.look, table, `${entry.id}-values`);
    this.values.replaceChildren(values.block);
    values.fill();
  }
}

const unpin = () => all_figures.find(f => f.at >= 0)?.point(-1);

export const figure_block = (doc, look, entry) => new Figure(doc, look, entry).block;

/// Draws figures as they come near the window, and redraws them after a change of filter or width.
export function start_figures() {
  document.body.append(tip);
  addEventListener('click', e => e.target.closest?.('#tip button') || unpin());
  addEventListener('keydown', e => e.key === 'Escape' && unpin());
  near_window(all_figures, f => f.redraw());
  let timer = 0;
  addEventListener('resize', () => {
    clearTimeout(timer);
    const changed = f => f.drawn && f.plot.clientWidth && f.drawn !== Math.floor(f.plot.clientWidth);
    timer = setTimeout(() => all_figures.filter(changed).forEach(f => f.redraw()), 150);
  });
}
