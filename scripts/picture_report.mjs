// Pictures of a report's page, for the README.
//   node scripts/picture_report.mjs build/release/web/node_modules REPORT/index.html SCENE SHARE OUT
// Writes OUT/page-light.png (the viewer on SCENE, SHARE of the way through, coloured by strain) and OUT/page-dark.png
// (contour of SCENE over time). Needs Chromium (Debian: chromium) and the packages that the build gets.
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [packages, page_file, scene, share, out] = process.argv.slice(2);
if (!out) {
  console.error('usage: picture_report.mjs PACKAGES INDEX.html SCENE SHARE OUT');
  process.exit(2);
}
const puppeteer = createRequire(join(resolve(packages), 'x.js'))('puppeteer-core');
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader']
});
const page = await browser.newPage();
const open = async (scheme, width, height) => {
  await page.setViewport({width, height});
  await page.emulateMediaFeatures([{name: 'prefers-color-scheme', value: scheme}]);
  await page.goto(pathToFileURL(resolve(page_file)).href);
};
const box_of = selector => page.$eval(selector, e => {
  const b = e.getBoundingClientRect();
  return {x: b.x + scrollX, y: b.y + scrollY, width: b.width, height: b.height};
});

await open('light', 1000, 900);
await page.evaluate(async (name, part) => {
  const v = window.clothbench.viewer;
  await v.ready;
  await v.show_scene(name);
  v.colour('strain');
  v.seek(part * v.end);
}, scene, Number(share));
await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
const viewer = await box_of('#viewer'), first = await box_of('#viewer .bar'), last = await box_of('#viewer details');
await page.screenshot({
  path: join(out, 'page-light.png'),
  clip: {x: viewer.x - 10, y: first.y - 10, width: viewer.width + 20, height: last.y - first.y + 8}
});

await open('dark', 1000, 900);
await page.$eval('#penetration-series', (plot, wanted) => {
  const figure = plot.closest('figure');
  figure.id = 'pictured';
  for (const choice of figure.querySelectorAll('select')) {
    const option = [...choice.options].find(o => wanted.includes(o.text));
    if (option) choice.value = option.value;
    choice.dispatchEvent(new Event('change', {bubbles: true}));
  }
}, [scene, 'contour [mm]']);
await page.waitForNetworkIdle();
const figure = await box_of('#pictured'), plot = await box_of('#penetration-series');
await page.screenshot({
  path: join(out, 'page-dark.png'),
  clip: {x: figure.x - 10, y: figure.y - 6, width: figure.width + 20, height: plot.y + plot.height - figure.y + 14}
});
await browser.close();
