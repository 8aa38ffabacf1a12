// Makes the page without data: template.html, and template.cpp which holds it.
//   node bundle.mjs SRC README.md OUT      run beside node_modules
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {build} from 'esbuild';
import {marked} from 'marked';

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
  const result = await build({entryPoints: [join(source, entry)], bundle: true, minify: true, write: false, charset: 'ascii',
    target: ['chrome109', 'firefox115', 'safari16.4'], legalComments: 'none', nodePaths: [packages], logLevel: 'warning', ...options});
  return result.outputFiles[0].text;
}

const script = script_safe(await bundled('main.js', {format: 'iife'}));
const style = (await bundled('style.css', {})).trim();
const licences = ['three', 'three-mesh-bvh', 'vega', 'vega-lite', 'vega-tooltip'].map(name => {
  const info = JSON.parse(readFileSync(join(packages, name, 'package.json'), 'utf8'));
  return `${name} ${info.version} (${info.license})`;
});
const parts = {style, script, rules: section('Rules of the comparison'), limits: section('Limits'), packages: licences.join(', ')};
const html = readFileSync(join(source, 'index.html'), 'utf8').replace(/<!--part:(\w+)-->/g, (mark, name) => {
  if (!(name in parts)) throw new Error(`index.html: unknown mark ${mark}`);
  return name === 'script' ? `<script>${parts.script}</script>` : name === 'style' ? `<style>${parts.style}</style>` : parts[name];
});
writeFileSync(join(out, 'template.html'), html);

// Adjacent literals: short enough for every compiler.
const end = 'page_end_7d1f';
if (html.includes(`)${end}"`)) throw new Error('the page holds the mark that ends its literal');
const bytes = Buffer.from(html, 'utf8');
const pieces = [];
for (let at = 0; at < bytes.length;) {
  let to = Math.min(at + 15000, bytes.length);
  while (to < bytes.length && (bytes[to] & 0xc0) === 0x80) --to;  // never inside a character
  pieces.push(`R"${end}(${bytes.subarray(at, to).toString('utf8')})${end}"`);
  at = to;
}
writeFileSync(join(out, 'template.cpp'), `#include "report/web/template.hpp"
namespace clothbench {
PageTemplate page_template() {
  static const char text[] =
${pieces.join('\n')};
  return {{text, sizeof text - 1}, {}};
}
}  // namespace clothbench
`);
