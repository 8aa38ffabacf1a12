// The page of a report in headless Chromium: no console error, every point of the figures there, the viewer moves.
//   node web_browser.mjs PACKAGES INDEX.html [SHOTS]     PACKAGES: folder of node_modules; SHOTS: folder for screenshots
// Exit 77 where Chromium or the packages are missing.
import {existsSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [packages, page_file, shots] = process.argv.slice(2);
const browser_path = (process.env.CHROMIUM ? [process.env.CHROMIUM] : ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome']).find(existsSync);
const skip = why => { console.log(`SKIPPED: ${why}`); process.exit(77); };
if (!browser_path) skip('no Chromium (Debian: chromium)');
if (!existsSync(join(packages, 'puppeteer-core'))) skip(`no puppeteer-core in ${packages}`);
const puppeteer = createRequire(join(resolve(packages), 'x.js'))('puppeteer-core');

let failures = 0;
const check = (ok, what) => { if (!ok) { ++failures; console.error(`FAILED: ${what}`); } else console.log(`ok: ${what}`); };
const equal = (a, b, what) => check(JSON.stringify(a) === JSON.stringify(b), `${what}: ${JSON.stringify(a)}${JSON.stringify(a) === JSON.stringify(b) ? '' : `, expected ${JSON.stringify(b)}`}`);

const browser = await puppeteer.launch({executablePath: browser_path, headless: true,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--allow-file-access-from-files', '--hide-scrollbars']});
const problems = [], requests = [];
const page = await browser.newPage();
page.on('console', m => { if (['error', 'warn'].includes(m.type())) problems.push(`console: ${m.text()}`); });
page.on('pageerror', e => problems.push(`exception: ${e.message}`));
page.on('request', r => { if (!/^(file|data|blob):/.test(r.url())) requests.push(r.url()); });
await page.setViewport({width: 1280, height: 900});
await page.emulateMediaFeatures([{name: 'prefers-color-scheme', value: 'light'}]);
await page.goto(pathToFileURL(resolve(page_file)).href, {waitUntil: 'load'});

const marks = (id, name) => page.$$eval(`#${id} .${name}_marks > path`, list => list.length);

async function check_tables() {
  const sizes = await page.$$eval('.table table', list => list.map(t => [t.rows.length, t.rows[0].cells.length]));
  const wanted = await page.evaluate(() => window.clothbench.document.sections.flatMap(s => s.tables).map(t => [t.rows.length, t.rows[0].length]).sort());
  equal(sizes.sort(), wanted, 'rows and columns of the tables');
  const unnamed = await page.$$eval('button, select, input, canvas', list => list.filter(e => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length)).length);
  equal(unnamed, 0, 'controls without a name');
}

async function check_figures() {
  const families = await page.evaluate(() => window.clothbench.document.rates);
  for (const [k, family] of families.entries()) {
    const ours = family.series.filter(s => s.solver !== 'ballistic').flatMap(s => s.points).filter(p => p.fps > 0).length;
    const published = (family.published ?? []).flatMap(s => s.points).length;
    equal(await marks(`rates-${k}`, 'points'), ours + published, `points of the rates of ${family.name}`);
  }
  const work = await page.evaluate(() => window.clothbench.document.work);
  for (const d of work) {
    await page.select('figure:has(#work) select', d.scene);
    const good = d.points.filter(p => p.status === 'ok' && p.error > 0 && p.wall_ms_per_s > 0);
    equal(await marks('work', 'points'), good.length, `points of ${d.scene}`);
    equal(await marks('work', 'front_points'), good.filter(p => p.on_front).length, `points on the fronts of ${d.scene}`);
  }
  const ups = await page.evaluate(() => window.clothbench.document.penetration);
  for (const scene of ups.flatMap(u => u.scenes)) {
    await page.select('figure:has(#penetration-series) select', scene.name);
    const metric = await page.$eval('figure:has(#penetration-series) label:nth-of-type(2) select', e => e.value);
    const wanted = scene.rows.filter(r => r.solver !== 'ballistic').flatMap(r => r.metrics[metric]?.values ?? []).filter(v => v !== null).length;
    equal(await marks('penetration-series', 'points'), wanted, `points of ${scene.name}, ${metric}`);
  }
}

/// Pixels of the canvas that differ between two times; what a motionless or empty view would not have.
const picture = () => page.$eval('#stage canvas', c => {
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [c.width, c.height];
  const context = copy.getContext('2d');
  context.drawImage(c, 0, 0);
  return Array.from(context.getImageData(0, 0, c.width, c.height).data.filter((_, k) => k % 4 === 0));
});
const positions = () => page.evaluate(() => window.clothbench.viewer.panels.map(p => Array.from(p.position)));
const drawn = () => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));

async function check_viewer() {
  if (!await page.evaluate(() => window.clothbench.document.motions.cells.length)) return console.log('no motions in this report');
  await page.waitForFunction(() => window.clothbench.viewer.panels.length > 0, {timeout: 60000});
  await page.evaluate(() => window.clothbench.viewer.ready);
  const before = await positions(), picture_before = await picture();
  await page.focus('#stage canvas');
  await page.keyboard.press('End');
  await drawn();
  const after = await positions(), picture_after = await picture();
  check(before.every((p, k) => p.every(Number.isFinite) && after[k].some((x, n) => x !== p[n])), 'End moves the vertices of every panel');
  const changed = picture_before.filter((x, k) => x !== picture_after[k]).length / picture_before.length;
  check(changed > 0.005, `the picture changes (${(100 * changed).toFixed(1)} % of the pixels)`);
  await page.keyboard.press('Home');
  await drawn();
  check(JSON.stringify(await positions()) === JSON.stringify(before), 'Home brings them back');
}

try {
  await page.waitForFunction(() => window.clothbench?.document, {timeout: 60000});
  await check_tables();
  await check_figures();
  await check_viewer();
} catch (error) {
  problems.push(String(error.stack ?? error));
}
equal(problems, [], 'errors on the console');
equal(requests, [], 'requests to the network');
await browser.close();
process.exit(failures ? 1 : 0);
