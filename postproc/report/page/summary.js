// What a machinist reads first: the verdict and the figures; what the messages say, in one line.
// Each kind of page (kinds.js) has its own.

function rowsOf(columns) {
  const names = Object.keys(columns);
  const count = names.length ? columns[names[0]].length : 0;
  return Array.from({ length: count }, (_, i) => Object.fromEntries(names.map((name) => [name, columns[name][i]])));
}

// A figure that a test can find again: data-figure names the field of the JSON report.
function figure(name, value, text) {
  return element('span', { 'data-figure': name, 'data-value': String(value) }, text);
}

function tile(title, big, more, gauge = '') {
  const parts = big.map((part) => (typeof part === 'string' && part !== ' \u2192 ' ? element('span', {}, part) : part));
  return element('div', { className: 'tile' }, element('h3', {}, title), element('div', { className: 'big' }, ...parts), gauge,
    element('div', { className: 'more' }, ...more));
}

// Before above after, in proportion.
function twoBars(before, after) {
  const gauge = element('div', { className: 'gauge two', ariaHidden: 'true' }, element('i', { className: 'was' }), element('i'));
  const most = Math.max(before, after, 1e-9);
  gauge.children[0].style.width = `${100 * before / most}%`;
  gauge.children[1].style.width = `${100 * after / most}%`;
  return gauge;
}

function oneBar(share, className = 'gauge') {
  const gauge = element('span', { className, ariaHidden: 'true' }, element('i'));
  gauge.firstChild.style.width = `${Math.min(100, Math.max(0, 100 * share))}%`;
  return gauge;
}

function gain(before, after, digits) {
  const text = changeText(before, after, digits);
  return text ? element('span', { className: after < before ? 'gain' : 'loss' }, text) : 'unchanged';
}

// One figure before and after. `text`: of a value.
function pairTile(title, names, values, text, unit, note, digits) {
  const [before, after] = values.map((value) => text(value));
  return tile(title, [figure(names[0], values[0], before), ' \u2192 ', figure(names[1], values[1], after + unit)],
    [gain(values[0], before === after ? values[0] : values[1], digits), note], twoBars(...values));
}

function facts(pairs) {
  return element('dl', { className: 'facts' }, ...pairs.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
}

const count = (n, one, many) => `${thousands(n)} ${n === 1 ? one : many}`;
const percent = (share) => `${share > 0.99 && share < 1 ? (100 * share).toFixed(1) : (100 * share).toFixed(0)}\u00a0%`;
const shellWord = (word) => (/^[\w./:+,@%=-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

function drawVerdict([kind, sign, text, more]) {
  const place = byId('verdict');
  place.className = `verdict ${kind}`;
  place.replaceChildren(element('span', { className: 'sign', ariaHidden: 'true' }, sign),
    element('span', {}, `${text} `, element('small', {}, more)));
}

// --- messages -----------------------------------------------------------------------------------

const MESSAGES_AT_ONCE = 50;

function messageItem(d) {
  return element('li', { className: d.severity }, element('b', {}, `${d.severity} `),
    element('span', { className: 'mono' }, element('button', { type: 'button', title: 'Show it on the path', 'data-line': d.line }, `${d.line}:${d.column}`),
      ` ${d.id}`), ` \u2013 ${d.message}`);
}

function messageList(messages) {
  const items = messages.slice(0, MESSAGES_AT_ONCE).map(messageItem);
  if (messages.length > MESSAGES_AT_ONCE) {
    items.push(element('li', { className: 'note' }, `${thousands(messages.length - MESSAGES_AT_ONCE)} more; the JSON report has them all`));
  }
  return element('ul', {}, ...items);
}

// Errors in full, and the first lines behind which much is copied; other warnings and notes as one
// line with their counts, to be opened.
const CULPRIT = 'modes-unknown';
const CULPRITS_AT_ONCE = 3;

function drawMessages(messages) {
  const culprits = messages.filter((d) => d.id === CULPRIT).slice(0, CULPRITS_AT_ONCE);
  const isLoud = (d) => d.severity === 'error' || culprits.includes(d);
  const loud = messages.filter(isLoud);
  const others = messages.filter((d) => !isLoud(d));
  const parts = loud.length ? [messageList(loud)] : [];
  if (others.length) {
    const ids = new Map();
    for (const d of others) ids.set(d.id, (ids.get(d.id) ?? 0) + 1);
    const each = [...ids].sort((a, b) => b[1] - a[1]).map(([id, n]) => `${thousands(n)} ${id}`);
    const warnings = others.filter((d) => d.severity === 'warning').length;
    const counts = [warnings ? count(warnings, 'warning', 'warnings') : '',
      others.length > warnings ? count(others.length - warnings, 'note', 'notes') : ''].filter(Boolean).join(', ');
    const details = element('details', { id: 'notes' }, element('summary', {}, element('b', {}, counts), ` \u2013 ${each.join(', ')}`));
    details.addEventListener('toggle', () => { if (details.open && !details.querySelector('ul')) details.append(messageList(others)); });
    parts.push(details);
  }
  byId('messages').replaceChildren(...parts);
}

// --- how the page was made ------------------------------------------------------------------------

function drawAgain(command, pairs) {
  const parts = [];
  if (command) {
    const copy = element('button', { type: 'button', id: 'copy' }, 'Copy');
    copy.addEventListener('click', async () => {
      try {
        await navigator.clipboard.writeText(command);
        copy.textContent = 'Copied';
      } catch {
        getSelection().selectAllChildren(byId('command'));
        copy.textContent = 'Selected';
      }
      setTimeout(() => { copy.textContent = 'Copy'; }, 1500);
    });
    parts.push(element('pre', { id: 'command' }, command), element('p', {}, copy));
  }
  parts.push(facts(pairs), element('p', { className: 'note' }, 'The same version, input and options give the same bytes.'));
  byId('again-text').replaceChildren(...parts);
}
