import {download, downloads, element, file_name} from './dom.js';

const csv_field = text => /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
export const to_csv = rows => rows.map(row => row.map(csv_field).join(',') + '\n').join('');

const markdown_run = text => text.replaceAll('|', '\\|').replace(/[\n\r]/g, ' ');
export function to_markdown(t) {
  const line = row => '| ' + row.map(markdown_run).join(' | ') + ' |\n';
  const rule = '|---|' +
      '--:|'.repeat(t.rows[0].length - 1) + '\n';
  return `### ${t.title}\n\n` + line(t.rows[0]) + rule + t.rows.slice(1).map(line).join('') +
      (t.note ? `\n${t.note}\n` : '');
}

const kTex = {
  '\\': '\\textbackslash{}',
  '{': '\\{',
  '}': '\\}',
  '$': '\\$',
  '&': '\\&',
  '%': '\\%',
  '#': '\\#',
  '_': '\\_',
  '^': '\\textasciicircum{}',
  '~': '\\textasciitilde{}',
  '²': '$^2$',
  '³': '$^3$',
  '±': '$\\pm$',
  '×': '$\\times$',
  '·': '$\\cdot$',
  '–': '--',
  '−': '$-$',
  '≤': '$\\le$',
  '≥': '$\\ge$',
  '<': '$<$',
  '>': '$>$',
  '°': '$^\\circ$',
  '†': '$^\\dagger$',
  'µ': '$\\mu$',
  'ν': '$\\nu$',
  '₀': '$_0$',
  '₁': '$_1$',
  '₂': '$_2$',
  '₃': '$_3$',
  '₄': '$_4$',
  '₅': '$_5$',
  '∞': '$\\infty$',
  '…': '\\dots{}',
  '¾': '$\\frac34$',
  '\u00a0': '~',
  '|': '$|$',
  '`': '\\textasciigrave{}'
};
export const tex_text = text => [...text].map(c => kTex[c] ?? c).join('');

/// A booktabs table; needs \usepackage{booktabs}.
export function to_latex(t) {
  const line = row => '    ' + row.map(tex_text).join(' & ') + ' \\\\\n';
  return `% \\usepackage{booktabs}\n\\begin{table}\n  \\centering\n  \\caption{${tex_text(t.title)}}\n` +
      `  \\begin{tabular}{l${'r'.repeat(t.rows[0].length - 1)}}\n    \\toprule\n${line(t.rows[0])}    \\midrule\n` +
      t.rows.slice(1).map(line).join('') + '    \\bottomrule\n  \\end{tabular}\n' +
      (t.note ? `\n  \\footnotesize ${tex_text(t.note)}\n` : '') + '\\end{table}\n';
}

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
        Markdown: () => download(`${name}.md`, 'text/markdown', to_markdown(t)),
        LaTeX: () => download(`${name}.tex`, 'application/x-tex', to_latex(t))
      }));
}
