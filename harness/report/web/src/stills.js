// Draws the figures of a report in Node; bundle.mjs makes stills.cjs of this file.
//   node stills.cjs REPORT/index.html OUT      writes OUT/<figure>.svg, and OUT/figures.md, which shows them
// Reads the data that the page embeds. Vega measures text with a canvas, which Node lacks. The widths here are those of
// DejaVu Sans, which is wider than most system fonts, so no text is cut off.
import {readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import * as vega from 'vega';
import {compile} from 'vega-lite';

import {make_figures} from './figures.js';
import {config} from './plot_config.js';

const kWidth_px = 460;  // of the plots: with these fonts legible in one column of a paper
const kNote_px = 9.5;

// Advances of ' ' to '~' in hundredths of the font's size.
const kAdvances = '32 40 46 84 64 95 78 27 39 39 50 84 32 36 32 34 64 64 64 64 64 64 64 64 64 64 34 34 84 84 84 53 ' +
    '100 68 69 70 77 63 58 77 75 29 29 66 56 86 75 79 60 79 69 63 61 73 68 99 69 61 69 39 34 39 84 50 ' +
    '50 61 63 55 63 62 35 63 63 28 28 58 28 97 63 61 63 63 41 52 39 63 59 82 59 59 52 64 34 64 84';
const advances = kAdvances.split(' ').map(Number);
const width_of = (text, size) =>
    size / 100 * [...String(text)].reduce((sum, c) => sum + (advances[c.codePointAt(0) - 32] ?? 70), 0);
vega.textMetrics.width = (item, text) =>
    width_of(text ?? '', vega.textMetrics.height(item)) * (item.fontWeight === 'bold' ? 1.1 : 1);

/// Wraps text to the width of the picture.
function wrapped(text, width) {
  const lines = [''];
  for (const word of text.split(' '))
    if (width_of(`${lines.at(-1)} ${word}`, kNote_px) <= width)
      lines.push(`${lines.pop()} ${word}`.trim());
    else
      lines.push(word);
  return lines.filter(Boolean);
}

/// Number of columns of the legend, by its longest label.
const columns_for = labels =>
    Math.max(1, Math.floor(kWidth_px / (30 + Math.max(0, ...labels.map(l => width_of(l, 11))))));

function full_spec({title, empty, labels = [], notes = [], make}) {
  const plot =
      empty ? {data: {values: [{}]}, width: kWidth_px, height: 60, mark: {type: 'text', text: empty}} : make(kWidth_px);
  const lines = notes.filter(Boolean).flatMap(n => wrapped(n, kWidth_px));
  const below = lines.length ? {text: lines, orient: 'bottom', anchor: 'start', fontSize: kNote_px, offset: 8} : null;
  const look = config('paper');
  look.legend.columns = columns_for(labels);
  return {
    $schema: 'https://vega.github.io/schema/vega-lite/v5.json',
    description: title,
    padding: 8,
    vconcat: [plot],
    title: below,
    config: look
  };
}

async function draw(still) {
  const view = new vega.View(vega.parse(compile(full_spec(still)).spec), {renderer: 'none', logLevel: vega.Error});
  return (await view.runAsync()).toSVG();
}

/// The document from a page, or from a JSON file.
function document_of(file) {
  const text = readFileSync(file, 'utf8');
  const data = text.match(/<script type="application\/json" id="clothbench-data">([^]*?)<\/script>/)?.[1] ?? text;
  return JSON.parse(data);
}

const plain = text => text.replace(/\s+/g, ' ').replace(/[<[\]]/g, c => ({'<': '&lt;', '[': '(', ']': ')'}[c]));

async function main(from, out) {
  let markdown = '';
  for (const figure of make_figures(document_of(from)))
    for (const still of figure.stills) {
      writeFileSync(join(out, `${still.file}.svg`), await draw(still));
      const title = plain(still.title);
      markdown +=
          `![${title}](${still.file}.svg)\n\n${title}. ${still.empty ? plain(still.empty) : figure.caption}\n\n`;
    }
  writeFileSync(join(out, 'figures.md'), markdown);
}

const [from, out] = process.argv.slice(2);
if (!out) {
  console.error('usage: stills.cjs REPORT/index.html OUT');
  process.exit(2);
}
main(from, out).catch(e => {
  console.error(`figures: ${e.message}`);
  process.exit(1);
});
