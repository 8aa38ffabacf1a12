// Draws the figures of a report in Node; bundle.mjs makes figures.cjs of this file.
//   node figures.cjs REPORT/index.html OUT
// writes OUT/<figure>.svg (84 mm wide) and OUT/<figure>-wide.svg (174 mm), OUT/figures.md, which shows the wide ones, and
// OUT/hero.html, the figure of the first screen for readers without JavaScript. Reads the data that the page embeds.
import {readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {inflateSync} from 'node:zlib';

import {draw_on_paper, paper_widths, unique} from './chart.js';
import {make_figures, settled} from './figures.js';
import {looks, paper_look} from './state.js';

const embedded = (text, id) => text.match(new RegExp(`<script type="[a-z/]+" id="${id}">([^]*?)</script>`))?.[1];

/// The document from a page, or from a JSON file.
function document_of(file) {
  const text = readFileSync(file, 'utf8'), doc = JSON.parse(embedded(text, 'clothbench-data') ?? text);
  if (typeof doc.series === 'number')
    doc.series = JSON.parse(inflateSync(Buffer.from(embedded(text, `blob-${doc.series}`), 'base64')).toString('utf8'));
  return doc;
}

const plain = text => text.replace(/\s+/g, ' ').replace(/[<[\]]/g, c => ({'<': '&lt;', '[': '(', ']': ')'}[c]));

function main(from, out) {
  const doc = document_of(from), look = paper_look(looks(unique(doc.runs.map(r => r.solver)), doc.solvers)), figures = make_figures(doc);
  let markdown = '', hero = '';
  for (const figure of figures)
    for (const still of figure.stills) {
      const state = settled(figure, Object.fromEntries(Object.entries(still.state))), rows = figure.rows(state);
      if (!rows.length) continue;
      for (const [ending, width] of Object.entries(paper_widths))
        writeFileSync(join(out, `${still.file}${ending}.svg`), draw_on_paper(figure, rows, state, look, width).svg);
      if (!hero && figure.hero) hero = draw_on_paper(figure, rows, state, look, paper_widths['-wide']).svg;
      const title = plain(figure.title(state));
      markdown += `![${title}](${still.file}-wide.svg)\n\n${title}. ${plain(figure.caption)}\n\n`;
    }
  writeFileSync(join(out, 'figures.md'), markdown);
  writeFileSync(join(out, 'hero.html'), hero);
}

const [from, out] = process.argv.slice(2);
if (!out) {
  console.error('usage: figures.cjs REPORT/index.html OUT');
  process.exit(2);
}
try {
  main(from, out);
} catch (e) {
  console.error(`figures: ${e.stack}`);
  process.exit(1);
}
