// Builds the page without data (template.html), the script that draws its figures in Node (figures.cjs), and page.json with
// both. First installs the packages of package-lock.json; if that fails, page.json states why, and the build goes on.
//   node bundle.mjs WEB OUT NPM
import {execFileSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {deflateSync} from 'node:zlib';

const [web, out, npm] = process.argv.slice(2), source = join(web, 'src'), packages = join(out, 'node_modules');
const read = file => readFileSync(file, 'utf8');

/// Installs the packages if they are missing. The copy of the lock file is written last, so that an interrupted download is repeated.
function install() {
  const lock = join(web, 'package-lock.json'), fetched = join(out, 'fetched-lock.json');
  if (existsSync(fetched) && read(fetched) === read(lock)) return;
  rmSync(fetched, {force: true});
  mkdirSync(out, {recursive: true});
  for (const file of ['package.json', 'package-lock.json']) copyFileSync(join(web, file), join(out, file));
  const options = ['--engine-strict', '--ignore-scripts', '--no-audit', '--no-fund', '--fetch-retries=1', '--fetch-timeout=60000'];
  process.env.PATH += `:${join(web, '../../../build/npm')}`;  // where scripts/bootstrap.sh unpacks npm
  execFileSync(npm, ['ci', ...options], {cwd: out, timeout: 420000});
  copyFileSync(lock, fetched);
}

const write = (html, missing, figures) => writeFileSync(join(out, 'page.json'), JSON.stringify({html, missing, figures}));
try {
  install();
} catch (error) {
  console.error(`The report's page is left out: ${error.message}. After fixing that, delete ${out}/page.o and build again.`);
  write('', 'npm ci failed when this was built (it needs Node 18 or later)', '');
  process.exit();
}
const {build} = createRequire(join(packages, 'x.js'))('esbuild');

/// esbuild escapes "</script" only in strings; this function escapes it elsewhere, and "<!--".
const script_safe = text => text.replaceAll('<!--', '\\x3C!--').replaceAll(/<\/(script)/gi, '<\\/$1');

async function bundled(entry, options) {
  const form = {bundle: true, minify: true, charset: 'ascii', target: ['chrome109', 'firefox115', 'safari16.4'], legalComments: 'none'};
  const result = await build({entryPoints: [join(source, entry)], ...form, write: false, metafile: true, nodePaths: [packages], logLevel: 'warning', ...options});
  return {text: result.outputFiles[0].text, inputs: Object.keys(result.metafile.inputs)};
}

/// Name, version and licence of every package in the bundle.
function licences(inputs) {
  const names = new Set(inputs.map(i => i.match(/.*node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1]).filter(Boolean));
  return [...names].sort().map(name => {
    const {version} = JSON.parse(read(join(packages, name, 'package.json'))), text = read(join(packages, name, 'LICENSE')).trim();
    return `<h4>${name} ${version}</h4><pre>${text.replaceAll('&', '&amp;').replaceAll('<', '&lt;')}</pre>`;
  }).join('\n');
}

const program = await bundled('main.js', {format: 'iife'}), viewer = await bundled('viewer.js', {format: 'iife'});
const parts = {
  style: `<style>${(await bundled('style.css', {})).text.trim()}</style>`,
  script: `<script>${script_safe(program.text)}</script>`,
  viewer: `<script type="text/plain" id="viewer-program">${deflateSync(viewer.text).toString('base64')}</script>`,
  licences: licences([...program.inputs, ...viewer.inputs])
};
const html = read(join(source, 'index.html')).replace(/<!--part:(\w+)-->/g, (_, name) => parts[name]);
const stills = await bundled('stills.js', {format: 'cjs', target: ['node18'], external: ['node:*']});
writeFileSync(join(out, 'template.html'), html);
writeFileSync(join(out, 'figures.cjs'), stills.text);
write(html, '', stills.text);
