// The figures of a report without a browser: what they count and omit, sizes on paper, and colours and symbols of
// solvers (harness/report/solvers.json), which must be distinguishable with all common colour-vision deficiencies.
//   node figures.mjs ROOT FIGURES.cjs     the script that bundle.mjs makes
import assert from 'node:assert';
import {readFileSync} from 'node:fs';
import {join, resolve} from 'node:path';

const report = join(process.argv[2], 'harness/report'), roles = JSON.parse(readFileSync(join(report, 'solvers.json'), 'utf8'));
const {draw_on_paper} = (await import(resolve(process.argv[3]))).default;
const [{make_figures, settled}, {looks, number}] = await Promise.all(['figures', 'look'].map(name => import(join(report, `web/src/${name}.js`))));

// Text shows "–" for everything that is not a finite number.
assert.deepEqual([NaN, Infinity, null, undefined, 0, 12.345, 4.5e-7].map(v => number(v)), ['–', '–', '–', '–', '0', '12.3', '4.5·10⁻⁷']);

/// Many scenes, solvers and settings of every kind.
const solvers = Object.keys(roles.look), runs = [];
for (const [n, solver] of solvers.entries()) {
  const common = {solver, label: solver, scene: 'a scene', setting: 'default', status: 'ok', wall: [1e-3, 9e-4, 1.1e-3, 2e-3, 3e-3, 0.1], trials: 3, trust: 'alone'};
  for (let k = 0; k < 60; ++k) runs.push({...common, part: 'contact', scene: `scene-with-a-long-name-${k}`, verdict: k % 3 ? 'pass' : 'fail'});
  for (let k = 0; k < 9; ++k) runs.push({...common, part: 'generated', kind: `kind-${k}`, speed: 1 + k, verdict: k < n ? 'pass' : ['fail', 'not measured', 'unsupported'][Math.max(0, k - 6)], status: k === 8 ? 'unsupported' : 'ok'});
  runs.push({...common, part: 'generated', kind: 'pendulum', speed: null, verdict: 'pass'});
  for (let k = 0; k < 36; ++k) runs.push({...common, part: 'claims', kind: `c${k % 6}-claim`, iterations: 1 + k, substeps: 1 + k % 20, dispatches: 9, claim: ['holds', 'near', 'fails'][k % 3]});
  for (let k = 0; k < 26; ++k) runs.push({...common, part: 'stability', case: `S${k} some case`, grade: k % 3, verdict: 'pass'});
  for (let k = 1; k < 9; ++k) {
    const times = {wall_ms_per_s: 10 ** k, error: 10 ** -k, space_error: 1e-4, reference_uncertainty: 1e-9};
    runs.push({...common, ...times, part: 'accuracy', scene: 'swing', setting: `substeps=${k}`, label: `${solver} substeps=${k}`, ranking: 'RMS error', refused: '', not_ranked: ''}, {...common, part: 'accuracy', scene: 'untimed', error: 0.1});
    runs.push({...common, part: 'rates', family: 'fall', paper_table: 3, width: 2 ** k, resolution: `${2 ** k}²`, is_grid: true, fps_median: 1e5 / 2 ** k, fps_low: 9e4 / 2 ** k, fps_high: 1.1e5 / 2 ** k, free_fall_error: 1e-6});
  }
}
// Landings have runs of a solver that the report has not, and values that are 0.
const history = ['a', 'b'].map((letter, k) => ({commit: letter.repeat(40), created: '', runs: [solvers[0], 'absent'].map(solver => ({gpu: 'CPU', solver, scene: 'fall', setting: 'default', values: {crossings_max: 0, stretch_max: 1 + k}}))}));
const doc = {runs, solvers: roles, studies: [], history}, figures = Object.fromEntries(make_figures(doc).map(f => [f.id, f])), rows = id => figures[id].rows(settled(figures[id], {}));
assert.deepEqual([Object.keys(figures), figures['error-time'].stills.map(s => s.state.Scene)], [['error-time', 'verdicts', 'forest', 'failure-speed', 'claims-map', 'rates', 'stability', 'frame-times', 'changes'], ['swing']]);
assert.deepEqual(rows('changes').map(r => [r.solver, r.change]), [[solvers[0], 1], [solvers[0], 2]]);
// A run that is unsupported or was not measured is not a failure, and has not passed. A pendulum has no contact.
assert.deepEqual([[...new Set(rows('failure-speed').filter(r => r.verdict !== 'pass').map(r => r.speed))]], [[1, 2, 3, 4, 5, 6, 7]]);
const all = rows('forest').find(r => r.kind === 'all' && r.solver === solvers[3]);
assert.deepEqual([all.good, all.runs, all.unsupported, Math.round(100 * all.low), Math.round(100 * all.high)], [3, 9, 1, 12, 65]);
const stable = rows('stability').find(r => r.case === 'all');
assert.deepEqual([stable.good, stable.runs], [9, 26]);

// On paper: as wide as one or two columns of text, at most 110 mm high, letters of 7 to 8 points.
const kPoint = 25.4 / 72;
for (const figure of Object.values(figures))
  for (const width of [238, 493]) {
    assert.ok(figure.caption.split('\n')[0].match(/[.](\s|$)/g).length <= 2, `${figure.id}: a caption of more than two sentences`);
    const svg = await draw_on_paper(figure, settled(figure, {}), looks(solvers, roles), width);
    const [, wide, tall] = svg.match(/width="([\d.]+)pt" height="([\d.]+)pt"/).map(Number), scale = wide / svg.match(/viewBox="0 0 ([\d.]+)/)[1], sizes = [...svg.matchAll(/font-size="([\d.]+)px"/g)].map(m => scale * m[1]);
    assert.ok([84, 174].includes(Math.round(wide * kPoint)) && tall * kPoint < 110.5, `${figure.id}: ${wide * kPoint} x ${tall * kPoint} mm`);
    assert.ok(sizes.length > 2 && sizes.every(s => s >= 7 && s <= 8), `${figure.id}: letters of ${[...new Set(sizes)]} points`);
    assert.ok(!/NaN|undefined|var\(/.test(svg), `${figure.id}: ${svg.match(/.{80}(NaN|undefined|var\().{40}/)?.[0]}`);
  }

const kLeastDistance = 15, kLeastSpare = 11, kLeastContrast = 3;  // CIEDE2000: between known solvers, and with a spare look; WCAG 2 for graphics
const kBack = {light: '#ffffff', dark: '#12161c'};
// Machado, Oliveira and Fernandes (2009), severity 1.
const kVision = {
  normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]]
};
const times = (m, v) => m.map(row => row.reduce((sum, x, k) => sum + x * v[k], 0));
const linear = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16) / 255).map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

function lab(rgb) {
  const xyz = times([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]], rgb.map(c => Math.min(Math.max(c, 0), 1)));
  const [x, y, z] = [xyz[0] / 0.95047, xyz[1], xyz[2] / 1.08883].map(t => t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/// CIEDE2000 (Sharma, Wu and Dalal 2005).
function distance([l1, a1, b1], [l2, a2, b2]) {
  const rad = Math.PI / 180, mean_c = (Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2, g = 0.5 * (1 - Math.sqrt(mean_c ** 7 / (mean_c ** 7 + 25 ** 7)));
  const [p1, p2] = [(1 + g) * a1, (1 + g) * a2], [c1, c2] = [Math.hypot(p1, b1), Math.hypot(p2, b2)];
  const hue = (a, b) => (Math.atan2(b, a) / rad + 360) % 360, [h1, h2] = [hue(p1, b1), hue(p2, b2)];
  const dh = c1 * c2 === 0 ? 0 : ((h2 - h1 + 540) % 360) - 180, dH = 2 * Math.sqrt(c1 * c2) * Math.sin(dh / 2 * rad);
  const l = (l1 + l2) / 2, c = (c1 + c2) / 2, h = c1 * c2 === 0 ? h1 + h2 : (h1 + dh / 2 + 360) % 360;
  const t = 1 - 0.17 * Math.cos((h - 30) * rad) + 0.24 * Math.cos(2 * h * rad) + 0.32 * Math.cos((3 * h + 6) * rad) - 0.2 * Math.cos((4 * h - 63) * rad);
  const sl = 1 + 0.015 * (l - 50) ** 2 / Math.sqrt(20 + (l - 50) ** 2), sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
  const turn = -2 * Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7)) * Math.sin(60 * Math.exp(-(((h - 275) / 25) ** 2)) * rad);
  const [x, y, z] = [(l2 - l1) / sl, (c2 - c1) / sc, dH / sh];
  return Math.sqrt(x * x + y * y + z * z + turn * y * z);
}
assert.ok(Math.abs(distance([50, 2.6772, -79.7751], [50, 0, -82.7485]) - 2.0425) < 1e-3, 'a published pair of the formula');

const all_looks = {...roles.look, ...Object.fromEntries(roles.spare.map(l => [`another plugin, ${l[0]}`, l]))};
const names = Object.keys(all_looks), luminance = hex => times([[0.2126, 0.7152, 0.0722]], linear(hex))[0];
let least = Infinity;
for (const [at, theme] of [[1, 'light'], [2, 'dark']]) {
  for (const [k, a] of names.entries()) {
    const [low, high] = [luminance(all_looks[a][at]), luminance(kBack[theme])].sort((x, y) => x - y);
    assert.ok((high + 0.05) / (low + 0.05) >= kLeastContrast, `${theme}: contrast of ${a}`);
    for (const b of names.slice(k + 1))
      for (const [vision, matrix] of Object.entries(kVision)) {
        const apart = distance(...[a, b].map(n => lab(times(matrix, linear(all_looks[n][at])))));
        least = Math.min(least, apart);
        assert.ok(apart >= (b in roles.look ? kLeastDistance : kLeastSpare), `${theme}, ${vision}: ${a} and ${b} are ${apart.toFixed(1)} apart`);
      }
  }
}
const symbols = Object.values(all_looks).map(l => l[0]);
assert.equal(new Set(symbols).size, symbols.length, 'each solver has a symbol of its own');
console.log(`${names.length} solvers, at least ${least.toFixed(1)} apart`);
