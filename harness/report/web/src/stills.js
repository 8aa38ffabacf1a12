// Draws the figures of a report in Node; bundle.mjs makes figures.cjs from this file.
//   node figures.cjs REPORT/index.html OUT
// writes OUT/<figure>.svg (84 mm wide), OUT/<figure>-wide.svg (174 mm), PDF files of both with rsvg-convert, and OUT/figures.md,
// which shows the wide ones from the parent folder. Puts the first screen's figure into the page for readers without JavaScript.
import {execFileSync} from 'node:child_process';
import {readFileSync, renameSync, rmSync, writeFileSync} from 'node:fs';
import {basename, join} from 'node:path';
import {inflateSync} from 'node:zlib';

import {view_of} from './draw.js';
import {make_figures, settled} from './figures.js';
import {looks, unique} from './look.js';

const kWidths = {'': 238, '-wide': 493}, kMostHeight = 311;  // points: 84 mm for one column of text, 174 mm for two; 110 mm
const kPoint = 0.625;                                        // points per pixel of the page; letters become 7.5 points high
const kPaper = {
  ink: '#000000', soft: '#222222', line: '#dddddd', back: '#ffffff',
  good: '#0b6b4b', bad: '#b23608', pass: '#8fcab6', fail: '#cc4a1b', none: '#eeeeee', ignored: '#d5d9de',
  'on-pass': '#000000', 'on-fail': '#ffffff', 'on-none': '#555555', 'on-ignored': '#000000'
};

/// A figure for white paper, as SVG of this width in points; `paper`: values of the style sheet's variables.
export async function draw_on_paper(figure, state, solvers, width) {
  const paper = {...kPaper, ...Object.fromEntries(Object.values(solvers).map((l, k) => [`s${k}`, l.light]))}, look = {solvers, paper, font: 'DejaVu Sans, Verdana, sans-serif'};
  for (let shrink = 1;;) {
    const svg = await view_of(figure, figure.rows(state), state, look, width / kPoint, shrink).toSVG();
    const [size, wide, tall] = svg.match(/width="([\d.]+)" height="([\d.]+)" viewBox="[^"]*"/), scale = Math.min(kPoint, width / wide), height = scale * tall;
    const root = `width="${width}pt" height="${height}pt" viewBox="0 0 ${width / scale} ${tall}" role="img" aria-label="${plain(figure.title(state)).replaceAll('"', '')}"`;
    if (height <= kMostHeight) return svg.replace(size, root).replace(/<text[^>]*><\/text>/g, '').replace(/var\(--([\w-]+)\)/g, (_, name) => paper[name]);
    shrink *= 0.98 * kMostHeight / height;
  }
}

const plain = text => text.replace(/\s+/g, ' ').replace(/[<[\]]/g, c => ({'<': '&lt;', '[': '(', ']': ')'}[c]));

/// Makes a PDF file of every SVG file, or of none; if none, returns a sentence with the reason. PDF files contain their
/// creation time, which is fixed here so that equal runs give equal files.
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

async function main(from, out) {
  const page = readFileSync(from, 'utf8'), packed = page.match(/ id="clothbench-data">([^]*?)<\/script>/)[1];
  const doc = JSON.parse(inflateSync(Buffer.from(packed, 'base64'))), solvers = looks(unique(doc.runs.map(r => r.solver)), doc.solvers);
  const pictures = [];
  let markdown = '', hero = '';
  for (const figure of make_figures(doc))
    for (const still of figure.stills ?? [{file: figure.id, state: {}}]) {
      const state = settled(figure, still.state), title = plain(figure.title(state));
      if (Object.entries(still.state).some(([label, value]) => state[label] !== value)) continue;  // no run has this value
      for (const [ending, width] of Object.entries(kWidths)) {
        const svg = await draw_on_paper(figure, state, solvers, width);
        pictures.push(join(out, `${still.file}${ending}.svg`));
        writeFileSync(pictures.at(-1), svg);
        if (ending && figure.hero) hero ||= svg;
      }
      markdown += `![${title}](${basename(out)}/${still.file}-wide.svg)\n\n${title}. ${plain(figure.caption)}\n\n`;
    }
  const fault = convert(pictures);
  if (fault) console.error(fault);
  writeFileSync(join(out, 'figures.md'), markdown + (fault && `${fault}\n\n`));
  writeFileSync(`${from}.tmp`, page.replace('<!--clothbench:figure-->', () => hero));
  renameSync(`${from}.tmp`, from);
}

if (require.main === module) main(...process.argv.slice(2));
