// The element of a figure: drawn when it comes near the window, with a value on hover and by keyboard, controls, a table of
// its values and downloads.
import {draw, draw_on_paper, paper_widths} from './chart.js';
import {download, element, file_name, say, select} from './dom.js';
import {command_of, settled} from './figures.js';
import {load_series} from './motion.js';
import {on_change, page_look, paper_look, set_value, shown, state} from './state.js';
import {to_csv} from './tables.js';

const tip = element('div', {id: 'tip', role: 'status', hidden: true});
const figures = [];
export {figures as all_figures};  // for tests

/// Rows of a figure as a table of text.
export function values_of(figure, rows) {
  const columns = Object.entries(figure.columns);
  return [
    columns.map(([name]) => name), ...rows.map(r => columns.map(([, of]) => {
      const v = of(r);
      return v === null || v === undefined || Number.isNaN(v) ? '' : String(v);
    }))
  ];
}

function show_tip(at, lines, x, y) {
  tip.textContent = lines.filter(Boolean).join('\n');
  tip.hidden = !lines.length;
  if (!lines.length) return;
  const box = tip.getBoundingClientRect();
  tip.style.left = `${Math.max(6, Math.min(x + 14, innerWidth - box.width - 8))}px`;
  tip.style.top = `${y + 18 + box.height > innerHeight ? y - box.height - 12 : y + 18}px`;
}

class Figure {
  constructor(doc, look, entry) {
    Object.assign(this, {doc, look, entry, marks: [], at: -1, drawn: 0});
    this.plot = element('div', {
      class: 'plot',
      tabindex: '0',
      role: 'group',
      'aria-label': 'Figure. Left and right arrow: next value. Enter: copy the command of its run.'
    });
    this.heading = element('span', {});
    this.remark = element('p', {class: 'note'});
    this.values = element('div', {});
    this.controls = entry.choices.map(c => select(c.label, [], '', v => this.choose(c.label, v)));
    const details = element('details', {ontoggle: () => details.open && this.show_values()}, element('summary', {}, 'Values'), this.values);
    this.details = details;
    this.block = element(
        'figure', {id: entry.id},
        element(
            'div', {class: 'head'},
            element(
                'h3', {}, this.heading,
                element('a', {class: 'anchor', href: `#${entry.id}`, 'aria-label': `Link to figure ${entry.id}`}, '#')),
            ...this.controls),
        this.plot, element('figcaption', {}, entry.caption), this.remark,
        element(
            'div', {class: 'bar small'}, details,
            ...['SVG', 'PNG', 'CSV'].map(
                kind => element(
                    'button', {type: 'button', 'aria-label': `${entry.id}: download as ${kind}`, onclick: () => this.save(kind)}, kind))));
    this.listen();
    figures.push(this);
  }

  listen() {
    const mark_of = e => Number(e.target.closest?.('[data-i]')?.dataset.i ?? -1);
    this.plot.addEventListener('pointermove', e => this.point(mark_of(e), e.clientX, e.clientY));
    this.plot.addEventListener('pointerleave', () => this.point(-1));
    this.plot.addEventListener('blur', () => this.point(-1));
    this.plot.addEventListener('click', e => this.point(mark_of(e), e.clientX, e.clientY) && this.copy());
    this.plot.addEventListener('keydown', e => {
      const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[e.key];
      if (step && this.marks.length) {
        const at = (this.at + step + this.marks.length) % this.marks.length,
              box = this.plot.querySelector(`[data-i="${at}"]`)?.getBoundingClientRect();
        this.point(at, box?.right ?? 0, box?.bottom ?? 0);
        say(tip.textContent);
        e.preventDefault();
      } else if (e.key === 'Enter') {
        this.copy();
      } else if (e.key === 'Escape') {
        this.point(-1);
      }
    });
  }

  point(at, x, y) {
    if (at !== this.at) {
      this.plot.querySelector('.on')?.classList.remove('on');
      this.plot.querySelector(`[data-i="${at}"]`)?.classList.add('on');
    }
    this.at = at;
    const row = this.marks[at]?.row, command = row && command_of(this.doc, row.row ?? row);
    show_tip(this.plot, row ? [...this.entry.tip(row), row.file, command && `Click: ${command}`] : [], x, y);
    return row;
  }

  copy() {
    const row = this.marks[this.at]?.row, command = row && command_of(this.doc, row.row ?? row);
    if (command) copy_command(command);
  }

  choose(label, value) {
    set_value(`${this.entry.id}.${label}`, value);
    this.redraw();
  }

  settle() {
    const given = Object.fromEntries(this.entry.choices.map(c => [c.label, state.values[`${this.entry.id}.${c.label}`]]));
    const chosen = settled(this.entry, given);
    this.entry.choices.forEach(({label, options}, k) => {
      const list = options(chosen), box = this.controls[k].querySelector('select');
      box.replaceChildren(...list.map(o => new Option(o.text, o.value, o.value === chosen[label], o.value === chosen[label])));
      this.controls[k].hidden = list.length < 2;
    });
    return chosen;
  }

  async redraw() {
    const {entry} = this;
    if (entry.needs_series) await load_series(this.doc);
    this.state = this.settle();
    this.rows = entry.rows(this.state);
    const rows = this.rows.filter(r => shown(r.solver)), width = Math.max(280, Math.floor(this.plot.clientWidth));
    this.heading.textContent = entry.title(this.state);
    this.remark.textContent = entry.remark?.(this.state) ?? '';
    this.drawn = width;
    if (!rows.length) {
      this.marks = [];
      return void this.plot.replaceChildren(
          element('p', {class: 'note'}, entry.empty ?? 'No run is left: see the filter of solvers above.'));
    }
    const drawn = draw(entry.chart(rows, this.state, width), page_look(this.look, width < 560), width, entry.title(this.state));
    this.plot.innerHTML = drawn.svg;  // text in it is escaped (chart.js)
    this.marks = drawn.marks;
    if (this.details.open) this.show_values();
  }

  show_values() {
    const rows = this.rows.filter(r => shown(r.solver)), [head, ...body] = values_of(this.entry, rows), most = 200;
    this.values.replaceChildren(
        element(
            'div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': `Values of ${this.entry.title(this.state)}`},
            element(
                'table', {}, element('thead', {}, element('tr', {}, head.map(h => element('th', {scope: 'col'}, h)))),
                element('tbody', {}, body.slice(0, most).map(r => element('tr', {}, r.map(v => element('td', {}, v))))))),
        element('p', {class: 'note'}, body.length > most ? `The first ${most} of ${body.length} values; the CSV has all.` : ''));
  }

  async save(kind) {
    if (!this.drawn) await this.redraw();
    const name = file_name(this.entry.title(this.state)), rows = this.rows.filter(r => shown(r.solver));
    if (kind === 'CSV') return download(`${name}.csv`, 'text/csv', to_csv(values_of(this.entry, rows)));
    const {svg, width, height} = draw_on_paper(this.entry, rows, this.state, paper_look(this.look), paper_widths['-wide']);
    if (kind === 'SVG') return download(`${name}.svg`, 'image/svg+xml', svg);
    const image = new Image(), canvas = Object.assign(document.createElement('canvas'), {width: 4 * width, height: 4 * height});
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
    await image.decode();
    canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob(blob => download(`${name}.png`, 'image/png', blob));
  }
}

export function copy_command(command) {
  navigator.clipboard?.writeText(command).catch(() => {});
  say(`Copied: ${command}`);
  const note = element('div', {id: 'copied'}, 'Copied: ', element('code', {}, command));
  document.getElementById('copied')?.remove();
  document.body.append(note);
  setTimeout(() => note.remove(), 6000);
}

export const figure_block = (doc, look, entry) => new Figure(doc, look, entry).block;

/// Draws figures as they come near the window; again after a change of the filter, the address or the width.
export function start_figures() {
  document.body.append(tip);
  const near = new IntersectionObserver(
      list => list.filter(e => e.isIntersecting).forEach(e => {
        const figure = figures.find(f => f.block === e.target);
        if (figure && !figure.drawn) figure.redraw();
      }),
      {rootMargin: '500px'});
  figures.forEach(f => near.observe(f.block));
  on_change(() => figures.filter(f => f.drawn).forEach(f => f.redraw()));
  let timer = 0;
  addEventListener('resize', () => {
    clearTimeout(timer);
    timer = setTimeout(
        () => figures.filter(f => f.drawn && f.plot.clientWidth && f.drawn !== Math.floor(f.plot.clientWidth)).forEach(f => f.redraw()),
        150);
  });
  addEventListener('beforeprint', () => figures.filter(f => !f.drawn && !f.entry.needs_series).forEach(f => f.redraw()));
}
