// Draws the figures of a report in Node; bundle.mjs makes figures.cjs from this file.
//   node figures.cjs REPORT/index.html OUT
// writes OUT/<figure>.svg (84 mm wide), OUT/<figure>-wide.svg (174 mm), PDF files of both with rsvg-convert, and OUT/figures.md,
// which shows the wide ones from the parent folder. Puts the first screen's figure into the page for readers without JavaScript.
import {execFileSync} from 'node:child_process';
import {readFileSync, renameSync, rmSync, writeFileSync} from 'node:fs';
import {basename, join} from 'node:path';
import {inflateSync} from 'node:zlib';

import {draw_on_paper, paper_widths, unique} from './chart.js';
import {make_figures, settled} from './figures.js';
import {looks, paper_look} from './state.js';

const plain = text => text.replace(/\s+/g, ' ').replace(/[<[\]]/g, c => ({'<': '&lt;', '[': '(', ']': ')'}[c]));

/// Makes a PDF file of every SVG file, or none; returns a sentence on the reason for none. PDF files contain their creation
/// time, which is fixed here so that equal runs give equal files.
function convert(pictures) {
  const pdf = svg => svg.replace(/svg$/, 'pdf'), env = {...process.env, SOURCE_DATE_EPOCH: '0'};
  try {
    for (const svg of pictures) execFileSync('rsvg-convert', ['--format', 'pdf', svg, '-o', pdf(svg)], {env, stdio: 'ignore'});
    return '';
  } catch {
    for (const svg of pictures) rmSync(pdf(svg), {force: true});
    return 'PDF pictures were left out: rsvg-convert was not found (Debian: librsvg2-bin).';
  }
}

function main(from, out) {
  const page = readFileSync(from, 'utf8'), packed = page.match(/ id="clothbench-data">([^]*?)<\/script>/)[1];
  const doc = JSON.parse(inflateSync(Buffer.from(packed, 'base64')));
  const look = paper_look(looks(unique(doc.runs.map(r => r.solver)), doc.solvers));
  const pictures = [];
  let markdown = '', hero = '';
  for (const figure of make_figures(doc))
    for (const still of figure.stills ?? [{file: figure.id, state: {}}]) {
      const state = settled(figure, still.state);
      if (Object.entries(still.state).some(([label, value]) => state[label] !== value)) continue;  // no run has this value
      const rows = figure.rows(state), title = plain(figure.title(state));
      for (const [ending, width] of Object.entries(paper_widths)) {
        pictures.push(join(out, `${still.file}${ending}.svg`));
        writeFileSync(pictures.at(-1), draw_on_paper(figure, rows, state, look, width).svg);
      }
      if (!hero && figure.hero) hero = draw_on_paper(figure, rows, state, look, paper_widths['-wide']).svg;
      markdown += `![${title}](${basename(out)}/${still.file}-wide.svg)\n\n${title}. ${plain(figure.caption)}\n\n`;
    }
  const fault = convert(pictures);
  if (fault) console.error(fault);
  writeFileSync(join(out, 'figures.md'), markdown + (fault && `${fault}\n\n`));
  writeFileSync(`${from}.tmp`, page.replace('<!--clothbench:figure-->', () => hero));
  renameSync(`${from}.tmp`, from);
}

main(...process.argv.slice(2));
