// Makes the page without data, template.html, what draws its figures by Node, figures.cjs, and template.cpp which holds
// both.
//   node bundle.mjs SRC OUT      run beside node_modules
import {build} from 'esbuild';
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [source, out] = process.argv.slice(2);
const packages = join(dirname(fileURLToPath(import.meta.url)), 'node_modules');

/// esbuild already escapes "</script" in strings; what begins a comment is left to us.
const script_safe = text => text.replaceAll('<!--', '\\x3C!--').replaceAll(/<\/(script)/gi, '<\\/$1');

async function bundled(entry, options) {
  const result = await build({
    entryPoints: [join(source, entry)],
    bundle: true,
    minify: true,
    write: false,
    charset: 'ascii',
    target: ['chrome109', 'firefox115', 'safari16.4'],
    legalComments: 'none',
    metafile: true,
    nodePaths: [packages],
    logLevel: 'warning',
    ...options
  });
  return {text: result.outputFiles[0].text, inputs: Object.keys(result.metafile.inputs)};
}

const escaped = text => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;');

/// Name, version and licence of every package in the bundle.
function licences(inputs) {
  const names = new Set(inputs.map(i => i.match(/.*node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1]).filter(Boolean));
  return [...names].sort().map(name => {
    const read = file => readFileSync(join(packages, name, file), 'utf8');
    return `<h4>${name} ${JSON.parse(read('package.json')).version}</h4><pre>${escaped(read('LICENSE').trim())}</pre>`;
  }).join('\n');
}

const program = await bundled('main.js', {format: 'iife'}), viewer = await bundled('viewer.js', {format: 'iife'});
const parts = {
  style: `<style>${(await bundled('style.css', {})).text.trim()}</style>`,
  script: `<script>${script_safe(program.text)}</script>`,
  viewer: `<script type="text/plain" id="viewer-program">${script_safe(viewer.text)}</script>`,
  licences: licences([...program.inputs, ...viewer.inputs])
};
const html = readFileSync(join(source, 'index.html'), 'utf8').replace(/<!--part:(\w+)-->/g, (_, name) => parts[name]);
writeFileSync(join(out, 'template.html'), html);

const stills = await bundled('stills.js', {format: 'cjs', target: ['node18'], external: ['node:*']});
writeFileSync(join(out, 'figures.cjs'), stills.text);

function literal(name, text) {
  const end = 'page_end_7d1f';
  if (text.includes(`)${end}"`)) throw new Error('the page holds the mark that ends its literal');
  return `static const char ${name}[] = R"${end}(${text})${end}";`;
}
writeFileSync(join(out, 'template.cpp'), `#include "report/web/page.hpp"
namespace clothbench {
PageTemplate page_template() {
  ${literal('html', html)}
  ${literal('figures', stills.text)}
  return {{html, sizeof html - 1}, {}, {figures, sizeof figures - 1}};
}
}  // namespace clothbench
`);
