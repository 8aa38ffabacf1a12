import {download, downloads, element, file_name} from './dom.js';

const csv_field = text => /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
export const to_csv = rows => rows.map(row => row.map(csv_field).join(',') + '\n').join('');

const kBad = /^(fail\b|unsupported|missing|diverged|not_finite|timed_out|device_lost|error|no$|NO|REFUSED)/;
const kGood = /^(pass\b|yes$)/;
/// From here on a table's heads stand upright.
const kManyColumns = 11;
const is_number = text => /^[≤<>]?\s?[-−]?\d/.test(text) || text === '–';

function body_cell(text, row_header, numeric) {
  if (row_header) return element('th', {scope: 'row'}, text);
  const kind = text.length > 60 ? 'long' : numeric ? '' : 'text';
  const state = kBad.test(text) ? 'bad' : kGood.test(text) ? 'good' : '';
  return element('td', {class: `${kind} ${state}`.trim() || null}, text);
}

/// Title, downloads, table, note.
export function table_block(t) {
  const [head, ...body] = t.rows;
  // A column is aligned as text if most of its values are text.
  const numeric = head.map((_, k) => body.filter(r => is_number(r[k] ?? '')).length * 2 >= body.length);
  const table = element(
      'table', {class: head.length >= kManyColumns ? 'many' : null}, element('caption', {class: 'skip'}, t.title),
      element(
          'thead', {},
          element('tr', {}, head.map((h, k) => element('th', {scope: 'col', class: numeric[k] ? null : 'text'}, h)))),
      element(
          'tbody', {},
          body.map(
              row => element(
                  'tr', {class: row[0].startsWith('published') ? 'published' : null},
                  row.map((text, k) => body_cell(text, k === 0, numeric[k]))))));
  const name = file_name(t.title);
  return element(
      'div', {class: 'table'}, element('h3', {}, t.title),
      element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': t.title}, table),
      t.note ? element('p', {class: 'note'}, t.note.replaceAll('`', '')) : null, downloads(t.title, {
        CSV: () => download(`${name}.csv`, 'text/csv', to_csv(t.rows)),
        Markdown: () => download(`${name}.md`, 'text/markdown', t.markdown),
        LaTeX: () => download(`${name}.tex`, 'application/x-tex', t.latex)
      }));
}
