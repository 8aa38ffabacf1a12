// Reads the prose of the documents: repeated words, clichés and vague words (write-good), and long sentences.
//   node check_prose.mjs NODE_MODULES      the packages of harness/report/web/package.json
// Prints one line a fault and exits with 1; with 77 (skipped) where the packages are not there.
import {execFileSync} from 'node:child_process';
import {existsSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const MOST_WORDS = 40;  // of a sentence
const RULES = {illusion: true, cliches: true, weasel: true,
               adverb: false, eprime: false, passive: false, so: false, thereIs: false, tooWordy: false};
// Words with a plain meaning in these documents.
const ALLOWED = ['few', 'many', 'several'];

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, '../..');
const packages = resolve(process.argv[2] ?? '');
if (!existsSync(join(packages, 'write-good'))) {
  console.log(`SKIPPED: no write-good in ${packages}: no Node with npm when this was built`);
  process.exit(77);
}
const writeGood = createRequire(join(packages, 'x.js'))('write-good');
const {marked} = await import(pathToFileURL(join(packages, 'marked/lib/marked.esm.js')));

// The words of a token: code is one word, each another, a link is its text, markup is none.
let codes = 0;
function words_of(token) {
  if (token.type === 'codespan') return `Code${++codes}`;
  if (token.type === 'html' || token.type === 'image') return ' ';
  if (token.type === 'br') return ' ';
  return token.tokens ? token.tokens.map(words_of).join('') : token.text ?? '';
}

// Every paragraph, heading, item and table run of a document.
function* passages(tokens) {
  for (const token of tokens) {
    if (token.type === 'paragraph' || token.type === 'heading' || token.type === 'text') yield words_of(token);
    else if (token.type === 'table') {
      for (const row of [token.header, ...token.rows])
        for (const run of row) yield run.tokens.map(words_of).join('');
    } else if (token.type === 'list') {
      for (const item of token.items) yield* passages(item.tokens);
    } else if (token.type === 'blockquote') yield* passages(token.tokens);
  }
}

function* faults_of(text) {
  for (const found of writeGood(text, {...RULES, whitelist: ALLOWED}))
    yield `${found.reason}: … ${text.slice(Math.max(0, found.index - 30), found.index + found.offset + 30)} …`;
  for (const sentence of text.split(/(?<=[.!?]["')\]]*)\s+(?=[^a-z])/)) {
    const words = sentence.split(/\s+/).filter(word => /[\p{L}\p{N}]/u.test(word)).length;
    if (words > MOST_WORDS) yield `a sentence of ${words} words; at most ${MOST_WORDS}: ${sentence.slice(0, 400)} …`;
  }
}

const names = execFileSync('python3', [join(here, 'documents.py')], {encoding: 'utf8'}).trim().split('\n');
let faults = 0;
for (const name of names)
  for (const text of passages(marked.lexer(readFileSync(join(root, name), 'utf8'))))
    for (const fault of faults_of(text.replace(/\s+/g, ' '))) {
      console.log(`${name}: ${fault}`);
      ++faults;
    }
if (names.length < 20) {
  console.log(`${names.length} documents found; there are more`);
  ++faults;
}
if (!faults) console.log(`${names.length} documents: no sentence above ${MOST_WORDS} words, no repeated or vague word`);
process.exit(faults ? 1 : 0);
