// What a machinist reads first: the verdict and four figures. Then proof and options in words.

function rowsOf(columns) {
  const names = Object.keys(columns);
  const count = names.length ? columns[names[0]].length : 0;
  return Array.from({ length: count }, (_, i) => Object.fromEntries(names.map((name) => [name, columns[name][i]])));
}

// A figure that a test can find again: data-figure names the field of the JSON report.
function figure(name, value, text) {
  return element('span', { 'data-figure': name, 'data-value': String(value) }, text);
}

class Summary {
  constructor(report, path) {
    Object.assign(this, { report, path });
    this.rewritten = report.runs.filter((r) => r.status === 'rewritten').length;
  }

  draw() {
    const { report } = this;
    byId('input-name').textContent = report.input.file;
    byId('output-name').textContent = report.output.file || 'nothing written';
    byId('made-for').textContent = `for ${report.output.target}, machine ${report.options.machine}, tolerance `
      + `${lengthText(report.options.tolerance_mm)}${report.options.tolerance_kind === 'band' ? ' (band reading)' : ''}`;
    this.drawVerdict();
    byId('tiles').replaceChildren(...(report.understood ? this.tiles() : []));
    this.drawMessages();
  }

  verdict() {
    const { report } = this;
    if (!report.understood) {
      return ['bad', '\u2715', 'Not understood: nothing was written', 'The messages below say what could not be read.'];
    }
    if (this.rewritten === 0) {
      return ['plain', '\u2013', 'Nothing was rewritten', 'Every block is as it was. What was kept, and why, stands below.'];
    }
    if (!report.proved) {
      return ['bad', '\u2715', 'Not proved: nothing was written', 'The new text could not be shown to keep the tolerance.'];
    }
    const written = report.output.file ? '' : ' Nothing was written: this was a dry run.';
    return ['good', '\u2713', `Proved: never more than ${lengthText(report.deviation_mm)} from the old path`,
      `The written text was read again and compared with the old program, both ways and in order. Allowed: ${lengthText(report.options.tolerance_mm)}.${written}`];
  }

  drawVerdict() {
    const [kind, sign, text, more] = this.verdict();
    const place = byId('verdict');
    place.className = `verdict ${kind}`;
    place.replaceChildren(element('span', { className: 'sign', ariaHidden: 'true' }, sign),
      element('span', {}, text, element('small', {}, more)));
  }

  tile(title, big, more, gauge = '') {
    return element('div', { className: 'tile' }, element('h3', {}, title), element('div', { className: 'big' }, ...big), gauge,
      element('div', { className: 'more' }, ...more));
  }

  bars(before, after) {
    const gauge = element('div', { className: 'gauge two', ariaHidden: 'true' }, element('i', { className: 'was' }), element('i'));
    const most = Math.max(before, after, 1e-9);
    gauge.children[0].style.width = `${100 * before / most}%`;
    gauge.children[1].style.width = `${100 * after / most}%`;
    return gauge;
  }

  shareRewritten() {
    const blocks = this.report.runs.reduce((sum, r) => sum + (r.status === 'rewritten' ? r.blocks_in : 0), 0);
    const share = 100 * blocks / Math.max(1, this.report.input.blocks);
    return `${share > 99 && share < 100 ? share.toFixed(1) : share.toFixed(0)}\u00a0%`;
  }

  shareGauge() {
    const gauge = element('div', { className: 'gauge', ariaHidden: 'true' }, element('i'));
    gauge.firstChild.style.width = this.shareRewritten().replace('\u00a0', '');
    return gauge;
  }

  tiles() {
    const { report } = this;
    const gain = (before, after, digits) => {
      const text = changeText(before, after, digits);
      return text ? element('span', { className: after < before ? 'gain' : 'loss' }, text) : 'unchanged';
    };
    const { time_before_s: before, time_after_s: after } = report;
    // Less than half a percent is not worth a claim: the model is not that good.
    const same = before > 0 && Math.abs(after / before - 1) < 0.005;
    const time = before > 0
      ? this.tile('Time, predicted',
        [figure('time_before_s', before, timeText(before)), ' \u2192 ', figure('time_after_s', after, timeText(after))],
        [same ? 'unchanged' : gain(before, after, 1), ` on machine ${report.options.machine}`], this.bars(before, after))
      : this.tile('Time, predicted', ['\u2013'], ['nothing moves or waits']);
    // Before and after of one figure.
    const pair = (title, names, values, digits, unit, note) => this.tile(title,
      [figure(names[0], values[0], values[0].toFixed(digits)), ' \u2192 ', figure(names[1], values[1], values[1].toFixed(digits) + unit)],
      [gain(...values), note], this.bars(...values));
    const [old, now] = [report.path_before, report.path_after];
    const ofPath = old.length_mm > 0 ? [
      pair('Distance, rms', ['path_before.distance_mm', 'path_after.distance_mm'], [old.distance_mm, now.distance_mm], 4, ' mm', ', from the path that was meant'),
      pair('Roughness', ['path_before.roughness', 'path_after.roughness'], [old.roughness, now.roughness], 3, '', ', turns at joints in rad/\u221amm'),
    ] : [];
    const slow = report.cutting_before_s > 0
      ? [pair('Slow', ['slow_before', 'slow_after'], [100 * report.slow_share_before, 100 * report.slow_share_after], 1, '\u00a0%',
        ', of the cutting time below half of the programmed feed')] : [];
    const kept = report.runs.length - this.rewritten;
    const inOut = [report.input.blocks, report.output.blocks];
    const allowed = report.options.tolerance_mm;
    const gauge = element('div', { className: 'gauge', ariaHidden: 'true' }, element('i'));
    gauge.firstChild.style.width = `${Math.min(100, 100 * report.deviation_mm / allowed)}%`;
    const corner = report.corner_mm > 0 ? `; corners at most ${lengthText(report.corner_mm)}` : '';
    return [
      time,
      this.tile('Deviation, proved', this.rewritten
        ? [figure('deviation_mm', report.deviation_mm, lengthText(report.deviation_mm))] : ['none'],
      this.rewritten ? [`of ${lengthText(allowed)} allowed${report.deviation_line > 0 ? `, near line ${report.deviation_line}` : ''}${corner}`]
        : ['every block is as it was'], gauge),
      this.tile('Blocks', [figure('input.blocks', inOut[0], thousands(inOut[0])), ' \u2192 ', figure('output.blocks', inOut[1], thousands(inOut[1]))],
        [gain(...inOut), `, ${thousands(report.input.bytes)} \u2192 ${thousands(report.output.bytes)} bytes`], this.bars(...inOut)),
      ...ofPath,
      ...slow,
      this.tile('Runs', [figure('rewritten', this.rewritten, thousands(this.rewritten)), element('small', {}, ' rewritten, '),
        figure('kept', kept, thousands(kept)), element('small', {}, ' kept')],
      [this.rewritten ? `${this.shareRewritten()} of the blocks are in rewritten runs` : report.reasons.length ? `mostly kept: ${report.reasons[0].id}` : ''],
      this.shareGauge()),
    ];
  }

  drawMessages() {
    const most = 50;
    const { diagnostics } = this.report;
    const items = diagnostics.slice(0, most).map((d) => element('li', { className: d.severity },
      element('b', {}, `${d.severity} `), element('span', { className: 'mono' }, `${d.line}:${d.column} ${d.id}`), ` \u2013 ${d.message}`));
    if (diagnostics.length > most) items.push(element('li', { className: 'note' }, `${diagnostics.length - most} more; the JSON report has them all`));
    byId('messages').replaceChildren(...(items.length ? [element('ul', {}, ...items)] : []));
  }

  facts(pairs) {
    return element('dl', { className: 'facts' }, ...pairs.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
  }

  drawProof(columns) {
    const { report } = this;
    const place = byId('proof-text');
    if (!report.understood || this.rewritten === 0) {
      place.replaceChildren(element('p', {}, report.understood
        ? 'The new program has the same bytes as the old one, so there is nothing to prove.'
        : 'Nothing was written, so nothing was to be proved.'));
      return;
    }
    const band = report.options.tolerance_kind === 'band';
    const pairs = [
      ['Verdict', report.proved ? 'proved' : 'NOT PROVED'],
      ['Greatest deviation', `at most ${lengthText(report.deviation_mm, 5)}${report.deviation_line > 0 ? `, near line ${report.deviation_line}` : ''}`],
      ['Allowed', `${lengthText(report.options.tolerance_mm, 5)}, ${band ? 'in order, band reading' : 'both ways and in order'}`],
      ['Compared', `${count(columns.stretches, 'changed stretch', 'changed stretches')} by ${count(columns.pairs, 'pair', 'pairs')} of places, ${count(columns.events ?? 0, 'acting word or block', 'acting words and blocks')}`],
    ];
    if (report.corner_mm > 0) pairs.splice(2, 0, ['Corners', `at most ${lengthText(report.corner_mm, 5)} from the new path`]);
    const notes = [
      element('p', {}, report.proved
        ? 'The new text was read again, as a control would read it, and compared with the old program. Between two neighbouring pairs both paths run straight, so no place between them is further off than the pairs. All other blocks are the same, byte for byte.'
        : 'The new text could not be shown to keep the tolerance; nothing was written.'),
      element('p', {}, 'Not part of the proof is what the control itself adds, such as blending at corners. Cutting times are predictions of a model.'),
    ];
    if (columns.stretches_not_shown > 0) {
      notes.push(element('p', {}, `${columns.stretches_not_shown} compared stretches are not drawn on this page.`));
    }
    const again = report.output.file && report.output.file !== '-'
      ? [element('p', {}, 'To check it again:'), element('pre', {}, `batten verify ${shellWord(report.input.file)} ${shellWord(report.output.file)} --tolerance ${toleranceWord(report.options)}${band ? ' --tolerance-kind band' : ''}`)] : [];
    place.replaceChildren(this.facts(pairs), ...notes, ...again);
  }

  drawAgain(command) {
    const { options } = this.report;
    const said = (value) => (value === null ? 'not given' : Array.isArray(value) ? (value.length ? value.join(', ') : 'none') : String(value));
    const names = Object.keys(options).filter((name) => name !== 'tolerance_mm' && name !== 'tolerance_inch');
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
    parts.push(this.facts([
      ['batten', this.report.batten],
      ['input', `${this.report.input.file}, ${thousands(this.report.input.bytes)} bytes`],
      ['tolerance', toleranceWord(options)],
      ...names.map((name) => [name.replaceAll('_', '-'), said(options[name])]),
    ]));
    parts.push(element('p', { className: 'note' }, 'The same version, input and options give the same bytes.'));
    byId('again-text').replaceChildren(...parts);
  }
}

const count = (n, one, many) => `${thousands(n)} ${n === 1 ? one : many}`;
const shellWord = (word) => (/^[\w./:+,@%=-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
const toleranceWord = (options) => ('tolerance_inch' in options ? `${options.tolerance_inch}in` : `${options.tolerance_mm}mm`);
