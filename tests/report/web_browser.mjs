// The page of a report in headless Chromium: no console error, every point of the figures there, the viewer moves.
//   node web_browser.mjs PACKAGES INDEX.html [SHOTS]     PACKAGES: folder of node_modules; SHOTS: folder for
//   screenshots
// Exit 77 where Chromium or the packages are missing.
import {existsSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [packages, page_file, shots] = process.argv.slice(2);
const browser_path = (process.env.CHROMIUM ? [process.env.CHROMIUM] : [
                       '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'
                     ]).find(existsSync);
const skip = why => {
  console.log(`SKIPPED: ${why}`);
  process.exit(77);
};
if (!browser_path) skip('no Chromium (Debian: chromium)');
if (!existsSync(join(packages, 'puppeteer-core'))) skip(`no puppeteer-core in ${packages}`);
const puppeteer = createRequire(join(resolve(packages), 'x.js'))('puppeteer-core');

let failures = 0;
const check = (ok, what) => {
  if (!ok) {
    ++failures;
    console.error(`FAILED: ${what}`);
  } else console.log(`ok: ${what}`);
};
const equal = (a, b, what) => check(
    JSON.stringify(a) === JSON.stringify(b),
    `${what}: ${JSON.stringify(a)}${JSON.stringify(a) === JSON.stringify(b) ? '' : `, expected ${JSON.stringify(b)}`}`);

const browser = await puppeteer.launch({
  executablePath: browser_path,
  headless: true,
  args: [
    '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--allow-file-access-from-files',
    '--hide-scrollbars'
  ]
});
const problems = [], requests = [];
const page = await browser.newPage();
page.on('console', m => {
  if (['error', 'warn'].includes(m.type())) problems.push(`console: ${m.text()}`);
});
page.on('pageerror', e => problems.push(`exception: ${e.message}`));
page.on('request', r => {
  if (!/^(file|data|blob):/.test(r.url())) requests.push(r.url());
});
await page.setViewport({width: 1280, height: 900});
await page.emulateMediaFeatures([{name: 'prefers-color-scheme', value: 'light'}]);
await page.goto(pathToFileURL(resolve(page_file)).href, {waitUntil: 'load'});

const marks = (id, name) => page.$$eval(`#${id} .${name}_marks > path`, list => list.length);

async function check_tables() {
  const sizes = await page.$$eval('.table table', list => list.map(t => [t.rows.length, t.rows[0].cells.length]));
  const wanted = await page.evaluate(
      () => window.clothbench.document.sections.flatMap(s => s.tables)
                .map(t => [t.rows.length, t.rows[0].length])
                .sort());
  equal(sizes.sort(), wanted, 'rows and columns of the tables');
  // Verdicts of many solvers: upright heads, and all of the table in sight.
  const upright = await page.$$eval(
      '.table table', list => list.every(t => t.classList.contains('many') === t.rows[0].cells.length >= 11));
  check(upright, 'tables of many columns, and no others, have upright heads');
  const cut = await page.evaluate(() => {
    const row = (tag, first, cell) => `<tr><th>${first}</th>${`<${tag}>${cell}</${tag}>`.repeat(13)}</tr>`;
    const box = document.createElement('div');
    box.className = 'scroll';
    box.innerHTML = `<table class="many"><thead>${row('th', 'scene', 'bullet-soft margin 20 mm')}</thead>` +
        `<tbody>${row('td', 'two-hand-stretch-0p5mps', 'unsupported')}</tbody></table>`;
    document.querySelector('main').append(box);
    const wide = box.scrollWidth - box.clientWidth;
    box.remove();
    return wide;
  });
  check(cut <= 0, `a table of verdicts of 13 solvers fits, ${cut} px too wide`);
  const hidden = await page.$$eval(
      'h2, h3, table, figure',
      list => list.filter(e => {
        const b = e.getBoundingClientRect(), main = document.querySelector('main').getBoundingClientRect();
        return !(b.width > 0 && b.height > 0 && b.bottom <= main.bottom + 1);
      }).length);
  equal(hidden, 0, 'headings, tables and figures cut off or without extent');
  const unnamed = await page.$$eval(
      'button, select, input, canvas',
      list => list.filter(e => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length)).length);
  equal(unnamed, 0, 'controls without a name');
  const twice = await page.$$eval('button[aria-label*="download as"]', list => {
    const names = list.map(b => b.getAttribute('aria-label'));
    return names.filter((n, k) => names.indexOf(n) !== k);
  });
  equal(twice, [], 'downloads that share a name');
}

async function check_figures() {
  const runs = await page.evaluate(() => window.clothbench.document.runs), rated = runs.filter(r => r.part === 'rates');
  for (const [k, family] of [...new Set(rated.map(r => r.family))].entries()) {
    const drawn = rated.filter(r => r.family === family && r.solver !== 'ballistic' && r.fps_median > 0);
    equal(await marks(`rates-${k}`, 'points'), drawn.length, `points of the rates of ${family}`);
  }
  const work = runs.filter(r => r.part === 'accuracy');
  for (const scene of new Set(work.map(r => r.scene))) {
    await page.select('figure:has(#work) select', scene);
    const good = work.filter(r => r.scene === scene && r.status === 'ok' && r.error > 0 && r.wall_ms_per_s > 0);
    equal(await marks('work', 'points'), good.length, `points of ${scene}`);
  }
  const series = (await page.evaluate(() => window.clothbench.document.series)).map(s => ({...s, ...runs[s.run]}));
  for (const scene of new Set(series.map(s => s.scene))) {
    await page.select('figure:has(#penetration-series) select', scene);
    const metric = await page.$eval('figure:has(#penetration-series) label:nth-of-type(2) select', e => e.value);
    const wanted = series.filter(s => s.scene === scene && s.solver !== 'ballistic')
                       .flatMap(s => s.metrics[metric]?.values ?? [])
                       .filter(v => v !== null)
                       .length;
    equal(await marks('penetration-series', 'points'), wanted, `points of ${scene}, ${metric}`);
  }
}

/// What a button saves, instead of saving it.
async function saved(label) {
  await page.evaluate(() => {
    window.saved = null;
    URL.createObjectURL = blob => {
      window.saved = blob;
      return 'blob:none';
    };
    HTMLAnchorElement.prototype.click = () => {};
  });
  await page.evaluate(l => document.querySelector(`button[aria-label="${l}"]`).click(), label);
  await page.waitForFunction(() => window.saved, {timeout: 20000});
  return page.evaluate(
      async () => ({type: window.saved.type, bytes: Array.from(new Uint8Array(await window.saved.arrayBuffer()))}));
}
const text_of = file => Buffer.from(file.bytes).toString('utf8');

async function check_downloads() {
  const table = await page.evaluate(
      () => window.clothbench.document.sections.flatMap(s => s.tables).find(t => t.rows.length > 2));
  const name = table.title;
  const csv = text_of(await saved(`${name}: download as CSV`)),
        markdown = text_of(await saved(`${name}: download as Markdown`)),
        tex = text_of(await saved(`${name}: download as LaTeX`));
  equal(csv.trim().split('\n').length, table.rows.length, 'lines of a table as CSV');
  equal(
      markdown.split('\n').filter(l => l.startsWith('|')).length, table.rows.length + 1,
      'lines of a table as Markdown');
  equal(tex.split('\n').filter(l => l.endsWith('\\\\')).length, table.rows.length, 'rows of a table as LaTeX');
  check(
      ['\\toprule', '\\midrule', '\\bottomrule'].every(r => tex.includes(r)) && !/[^\x00-\x7f]/.test(tex),
      'LaTeX has booktabs rules and plain characters alone');
  const figure = await page.$eval('figure h3', e => e.textContent),
        points = await page.$$eval('figure:first-of-type .points_marks > path', l => l.length);
  const svg = text_of(await saved(`${figure}: download as SVG`)), png = await saved(`${figure}: download as PNG`);
  check(
      svg.startsWith('<svg') &&
          (svg.match(/points_marks[^]*?<\/g>/)?.[0].match(/<path/g) ?? []).length >= Math.min(points, 1),
      'a figure as SVG has its points');
  const width = Buffer.from(png.bytes).readUInt32BE(16);
  check(png.bytes[1] === 0x50 && width > 1500, `a figure as PNG, ${width} pixels wide`);
}

async function check_hover() {
  const point = await page.$('.points_marks > path');
  await point.hover();
  await page.waitForFunction(
      () => document.querySelector('#vg-tooltip-element.visible')?.textContent.length > 10, {timeout: 5000});
  check(true, 'hover over a point: ' + await page.$eval('#vg-tooltip-element', e => e.innerText.replace(/\s+/g, ' ')));
}

async function check_themes() {
  const look = () => page.evaluate(() => ({
                                     back: getComputedStyle(document.body).backgroundColor,
                                     axis: getComputedStyle(document.querySelector('.plot .role-axis-label text')).fill,
                                     points: document.querySelectorAll('.points_marks > path').length
                                   }));
  const light = await look();
  await page.click('#theme');
  const dark = await look();
  check(
      light.back !== dark.back && light.axis !== dark.axis,
      `the button changes page and figures (${light.back} to ${dark.back})`);
  equal(dark.points, light.points, 'points in the dark');
  if (shots) await page.screenshot({path: join(shots, 'dark.png')});
  await page.click('#theme');
  equal(await look(), light, 'and back');
}

/// One channel of every pixel of the canvas.
const picture = () => page.$eval('#stage canvas', c => {
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [c.width, c.height];
  const context = copy.getContext('2d');
  context.drawImage(c, 0, 0);
  return Array.from(context.getImageData(0, 0, c.width, c.height).data.filter((_, k) => k % 4 === 0));
});
const positions = () => page.evaluate(() => window.clothbench.viewer.panels.map(p => Array.from(p.position)));
const drawn = () => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));

async function check_motion() {
  await page.waitForFunction(() => window.clothbench.viewer.panels.length > 0, {timeout: 60000});
  await page.evaluate(() => window.clothbench.viewer.ready);
  await page.focus('#stage canvas');
  await page.keyboard.press('Home');
  await drawn();
  const before = await positions(), picture_before = await picture();
  await page.keyboard.press('End');
  await drawn();
  const after = await positions(), picture_after = await picture();
  check(
      before.every((p, k) => p.every(Number.isFinite) && after[k].some((x, n) => x !== p[n])),
      'End moves the vertices of every panel');
  const changed = picture_before.filter((x, k) => x !== picture_after[k]).length / picture_before.length;
  check(changed > 0.005, `the picture changes (${(100 * changed).toFixed(1)} % of the pixels)`);
  await page.keyboard.press('Home');
  await drawn();
  check(JSON.stringify(await positions()) === JSON.stringify(before), 'Home brings them back');
  await page.keyboard.press('ArrowRight');
  equal(
      await page.evaluate(() => window.clothbench.viewer.time),
      await page.evaluate(() => window.clothbench.viewer.panels[0].motion.time_s[1]),
      'an arrow goes to the next frame');
  await page.keyboard.press('Space');
  await page.waitForFunction(
      () => window.clothbench.viewer.time > window.clothbench.viewer.panels[0].motion.time_s[2], {timeout: 10000});
  await page.keyboard.press('Space');
  equal(await page.evaluate(() => window.clothbench.viewer.playing), false, 'Space plays and stops; playing');
}

/// The page's own strain and depth against what the files say of the same frames.
async function check_colours() {
  const results = await page.evaluate(async () => {
    const v = window.clothbench.viewer, out = [];
    for (const run of v.motions.runs) {
      if (!run.metrics.stretch_max || run.columns.length !== run.grid[0]) continue;
      await v.set([run]);
      const contour = run.metrics.contact_length_m ?? [], touching = contour.indexOf(Math.max(...contour));
      const [p] = v.panels, f = touching > 0 ? touching : run.frames.length - 1;
      const tolerance = 4 * run.step_m / Math.min(...p.edges.map(e => e[2])) + 1e-5;
      const strain = p.show(run.time_s[f], 'strain', 1).greatest,
            penetration = p.show(run.time_s[f], 'penetration', 1);
      out.push({
        name: `${run.scene} ${run.label}`,
        strain,
        stored: run.metrics.stretch_max[f],
        tolerance,
        depth: penetration.greatest,
        crossing: penetration.crossing,
        stored_depth: run.metrics.depth_m?.[f],
        stored_contour: run.metrics.contact_length_m?.[f]
      });
    }
    return out;
  });
  const off = results.filter(r => !(r.strain >= r.stored - r.tolerance));
  equal(off, [], `strain of ${results.length} motions below what the file says`);
  // What the page shows may be greater: it counts edges that are too short, too.
  const stretched = results.filter(r => r.stored > 0.005),
        agree = stretched.filter(r => Math.abs(r.strain - r.stored) <= r.tolerance);
  check(
      agree.length > 0 && 2 * agree.length >= stretched.length,
      `strain is the file's in ${agree.length} of ${stretched.length} stretched motions`);
  const crossed = results.filter(r => r.stored_contour > 0.1);
  check(
      crossed.every(r => r.crossing > 0 || r.depth > 0),
      `what crosses is coloured (${crossed.map(r => `${r.name} ${r.crossing}`).join(', ') || 'none'})`);
  const deep = results.filter(r => r.stored_depth > 0.005);
  check(
      deep.every(r => r.depth > 0 || r.crossing > 0),
      `what is deep in a collider is coloured (${
          deep.map(r => `${r.name} ${(1e3 * r.depth).toFixed(1)} mm`).join(', ') || 'none'})`);
  const clear = results.filter(r => r.stored_depth === 0 && r.stored_contour === 0);
  check(
      clear.every(r => (r.depth ?? 0) < 1e-4 && r.crossing === 0),
      `what touches nothing is not (${clear.length} motions)`);
}

try {
  await page.waitForFunction(() => window.clothbench?.document, {timeout: 60000});
  await check_tables();
  await check_figures();
  await check_downloads();
  await check_hover();
  await check_themes();
  if (await page.evaluate(() => window.clothbench.document.motions.runs.length)) {
    await check_motion();
    await check_colours();
  } else console.log('no motions in this report');
  check((await page.pdf({format: 'A4'})).length > 20000, 'it prints');
} catch (error) { problems.push(String(error.stack ?? error)); }
equal(problems, [], 'errors on the console');
equal(requests, [], 'requests to the network');
await browser.close();
process.exit(failures ? 1 : 0);
