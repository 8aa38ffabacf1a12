// Makes the page without data, template.html, what draws its figures by Node, figures.cjs, and template.cpp which holds
// both.
//   node bundle.mjs SRC README.md OUT      run beside node_modules
import {build} from 'esbuild';
import {marked} from 'marked';
import {existsSync, readdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [source, readme, out] = process.argv.slice(2);
const packages = join(dirname(fileURLToPath(import.meta.url)), 'node_modules');

/// A section of the README as HTML; links lead to places that a page on its own does not have.
function section(title) {
  const text = readFileSync(readme, 'utf8');
  const start = text.indexOf(`\n## ${title}\n`);
  if (start < 0) throw new Error(`${readme}: no section "${title}"`);
  const body = text.slice(text.indexOf('\n', start + 1), text.indexOf('\n## ', start + 1));
  return marked.parse(body).replace(/<a href="(?!https?:)[^"]*">(.*?)<\/a>/g, '$1');
}

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

/// Name, version and licence of every package in the bundle; texts that are the same stand once.
function licences(inputs) {
  const names =
      [...new Set(inputs.map(i => i.match(/.*node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1]).filter(Boolean))].sort();
  const texts = new Map();
  for (const name of names) {
    const folder = join(packages, name), info = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
    const file = readdirSync(folder).find(f => /^(licen[cs]e|copying)/i.test(f));
    if (!file && !info.license) throw new Error(`${name}: no licence`);
    // Some packages of a collection leave the text to the collection.
    const text = file && existsSync(join(folder, file)) ?
        readFileSync(join(folder, file), 'utf8').trim() :
        `Licence: ${info.license}, ${info.author?.name ?? info.author ?? ''}`;
    texts.set(text, [...(texts.get(text) ?? []), `${name} ${info.version}`]);
  }
  return [...texts].map(([text, who]) => `<h4>${escaped(who.join(', '))}</h4><pre>${escaped(text)}</pre>`).join('\n');
}

const program = await bundled('main.js', {format: 'iife'}), viewer = await bundled('viewer.js', {format: 'iife'});
const script = script_safe(program.text), style = (await bundled('style.css', {})).text.trim();
const parts = {
  style,
  script,
  viewer: `<script type="text/plain" id="viewer-program">${script_safe(viewer.text)}</script>`,
  rules: section('Rules of the comparison'),
  licences: licences([...program.inputs, ...viewer.inputs])
};
const html = readFileSync(join(source, 'index.html'), 'utf8').replace(/<!--part:(\w+)-->/g, (mark, name) => {
  if (!(name in parts)) throw new Error(`index.html: unknown mark ${mark}`);
  return name === 'script' ? `<script>${parts.script}</script>` :
      name === 'style' ? `<style>${parts.style}</style>` :
                         parts[name];
});
writeFileSync(join(out, 'template.html'), html);

const stills = await bundled('stills.js', {format: 'cjs', target: ['node18'], external: ['node:*']});
writeFileSync(join(out, 'figures.cjs'), stills.text);

// Adjacent literals: short enough for every compiler.
function literal(name, text) {
  const end = 'page_end_7d1f';
  if (text.includes(`)${end}"`)) throw new Error('the page holds the mark that ends its literal');
  const bytes = Buffer.from(text, 'utf8');
  const pieces = [];
  for (let at = 0; at < bytes.length;) {
    let to = Math.min(at + 15000, bytes.length);
    while (to < bytes.length && (bytes[to] & 0xc0) === 0x80) --to;  // never inside a character
    pieces.push(`R"${end}(${bytes.subarray(at, to).toString('utf8')})${end}"`);
    at = to;
  }
  return `static const char ${name}[] =\n${pieces.join('\n')};`;
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
