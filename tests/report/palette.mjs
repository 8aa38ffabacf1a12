// usage: node palette.mjs SOURCE: no two labels have the same colour, however many there are.
import assert from 'node:assert';

const {palette} = await import(`${process.argv[2]}/harness/report/web/src/theme.js`);
const labels = ['xpbd', 'paper', 'bullet-soft', ...Array.from({length: 40}, (_, k) => `plugin setting=${k}`)];
for (const theme of ['light', 'dark', 'paper']) {
  const colours = Object.values(palette(labels, theme));
  assert.strictEqual(new Set(colours).size, labels.length, `${theme}: ${colours}`);
  for (const c of colours) assert.match(c, /^#[0-9A-F]{6}$/, c);
}
// A report of a dozen and a half settings: none that the eye takes for another.
const channels = c => [1, 3, 5].map(at => parseInt(c.slice(at, at + 2), 16));
for (const theme of ['light', 'dark']) {
  const colours = Object.values(palette(labels.slice(3, 21), theme));
  colours.forEach((a, k) => colours.slice(k + 1).forEach(b => {
    const apart = Math.hypot(...channels(a).map((v, i) => v - channels(b)[i]));
    assert.ok(apart >= 35, `${theme}: ${a} and ${b} are ${apart} apart`);
  }));
}
console.log(`${labels.length} labels, all of different colours`);
