// usage: node palette.mjs SOURCE: no two labels have the same colour, however many there are.
import assert from 'node:assert';

const {palette} = await import(`${process.argv[2]}/harness/report/web/src/theme.js`);
const labels = ['xpbd', 'paper', 'bullet-soft', ...Array.from({length: 40}, (_, k) => `plugin setting=${k}`)];
for (const theme of ['light', 'dark', 'paper']) {
  const colours = Object.values(palette(labels, theme));
  assert.strictEqual(new Set(colours).size, labels.length, `${theme}: ${colours}`);
  for (const c of colours) assert.match(c, /^#[0-9A-F]{6}$/, c);
}
console.log(`${labels.length} labels, all of different colours`);
