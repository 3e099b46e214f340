// What the page shows of each command's report, in one shape:
//
//   maker, names [old, new or null], madeFor()     the head
//   verdict(), tiles(), proof()                    what was found; proof() may be null
//   rows [{first_line, last_line, status, ..}]     chains of moves, in the order of the program
//   columns [[title, key to sort by, class, cell]], filters, tableTitle, tableNote
//   reasons [{id, text, advice, can_be_allowed, blocks}]
//   compared                                       two paths, and so a deviation
//   tolerance, machine, options                    as the command was called
//
// A row's status is 'rewritten' or 'kept' ('slow' of `time`).

const DASH = '\u2013';
const lines = (r) => linesText(r.first_line, r.last_line);

// What is kept by its nature and says nothing: it is folded.
const isUsual = (r) => r.status === 'kept' && (r.reason === 'plunge' || r.reason === 'too-short');

const statusCell = (text) => (r) => element('span', { className: 'what' },
  element('i', { className: r.status === 'kept' ? 'dot kept' : 'dot' }), text(r));

// Words of the shop's own: what they do is the user's word, not proved.
const wordsText = (words) => words.map((w) => `${w.word} = ${w.effect}`).join('; ');
const vouched = (words) => (words?.length ? [['You vouch for', wordsText(words)]] : []);

const saidOption = (value) => (value === null ? 'not given' : Array.isArray(value) ? (value.length ? value.join(', ') : 'none') : String(value));
const toleranceWord = (options) => ('tolerance_inch' in options ? `${options.tolerance_inch}in` : `${options.tolerance_mm}mm`);
const again = (text) => [element('p', {}, 'To check it again:'), element('pre', {}, text)];

// --- smooth -------------------------------------------------------------------------------------

function smoothPage(report, path, columns) {
  const rows = rowsOf(report.runs);
  const { options } = report;
  const rewritten = rows.filter((r) => r.status === 'rewritten');
  const band = options.tolerance_kind === 'band';
  const slowest = rows.reduce((most, r) => Math.max(most, r.time_before_s, r.time_after_s), 1e-9);
  const bars = (r) => {
    const both = element('span', { className: r.status === 'kept' ? 'bars kept' : 'bars', ariaHidden: 'true' }, element('i'), element('i'));
    both.children[0].style.width = `${100 * r.time_before_s / slowest}%`;
    both.children[1].style.width = `${100 * r.time_after_s / slowest}%`;
    return both;
  };

  const verdict = () => {
    if (!report.understood) return ['bad', '\u2715', 'Not understood: nothing was written.', 'The messages below say what could not be read.'];
    if (!rewritten.length) return ['plain', DASH, 'Nothing was rewritten.', 'Every block is as it was. What was kept, and why, stands below.'];
    if (!report.proved) return ['bad', '\u2715', 'Not proved: nothing was written.', 'The new text could not be shown to keep the tolerance.'];
    const written = report.output.file ? '' : ' This was a dry run: nothing was written.';
    return ['good', '\u2713', `Proved: never more than ${lengthText(report.deviation_mm)} from the old path,`,
      `both ways and in order, by reading the written text again. Allowed: ${lengthText(options.tolerance_mm)}.${written}`];
  };

  const timeTile = () => {
    const { time_before_s: before, time_after_s: after } = report;
    if (!(before > 0)) return tile('Time, predicted', [DASH], ['nothing moves or waits']);
    // Less than half a percent is not worth a claim: the model is not that good.
    const same = Math.abs(after / before - 1) < 0.005;
    return tile('Time, predicted',
      [figure('time_before_s', before, timeText(before)), ' \u2192 ', figure('time_after_s', after, timeText(after))],
      [same ? 'unchanged' : gain(before, after, 1), ` on machine ${options.machine}`], twoBars(before, after));
  };

  const tiles = () => {
    if (!report.understood) return [];
    const [old, now] = [report.path_before, report.path_after];
    const inOut = [report.input.blocks, report.output.blocks];
    const kept = rows.length - rewritten.length;
    const corner = report.corner_mm > 0 ? `; corners at most ${lengthText(report.corner_mm)}` : '';
    const share = rewritten.reduce((sum, r) => sum + r.blocks_in, 0) / Math.max(1, report.input.blocks);
    const digits = (n) => (value) => value.toFixed(n);
    return [
      timeTile(),
      tile('Deviation, proved', rewritten.length ? [figure('deviation_mm', report.deviation_mm, lengthText(report.deviation_mm))] : ['none'],
        rewritten.length ? [`of ${lengthText(options.tolerance_mm)} allowed${report.deviation_line > 0 ? `, near line ${report.deviation_line}` : ''}${corner}`]
          : ['every block is as it was'], oneBar(report.deviation_mm / options.tolerance_mm)),
      tile('Blocks', [figure('input.blocks', inOut[0], thousands(inOut[0])), ' \u2192 ', figure('output.blocks', inOut[1], thousands(inOut[1]))],
        [gain(...inOut), `, ${thousands(report.input.bytes)} \u2192 ${thousands(report.output.bytes)} bytes`], twoBars(...inOut)),
      ...(old.length_mm > 0 ? [
        pairTile('Distance, rms', ['path_before.distance_mm', 'path_after.distance_mm'], [old.distance_mm, now.distance_mm], lengthDigits, `\u00a0${units.length}`, ', from the path that was meant'),
        pairTile('Roughness', ['path_before.roughness', 'path_after.roughness'], [old.roughness, now.roughness], digits(3), '', ', turns at joints, rad/\u221amm'),
      ] : []),
      ...(report.cutting_before_s > 0 ? [pairTile('Slow', ['slow_before', 'slow_after'], [100 * report.slow_share_before, 100 * report.slow_share_after],
        digits(1), '\u00a0%', ', of the cutting time below half of the programmed feed')] : []),
      tile('Runs', [figure('rewritten', rewritten.length, thousands(rewritten.length)), element('small', {}, ' rewritten, '),
        figure('kept', kept, thousands(kept)), element('small', {}, ' kept')],
      [rewritten.length ? `${percent(share)} of the blocks are in rewritten runs` : report.reasons.length ? `mostly kept: ${report.reasons[0].id}` : ''], oneBar(share)),
    ];
  };

  const proof = () => {
    if (!report.understood || !rewritten.length) {
      return [element('p', {}, report.understood ? 'The new program has the same bytes as the old one, so there is nothing to prove.'
        : 'Nothing was written, so nothing was to be proved.')];
    }
    const pairs = [
      ['Verdict', report.proved ? 'proved' : 'NOT PROVED'],
      ['Greatest deviation', `at most ${lengthText(report.deviation_mm, 5)}${report.deviation_line > 0 ? `, near line ${report.deviation_line}` : ''}`],
      ['Allowed', `${lengthText(options.tolerance_mm, 5)}, ${band ? 'in order, band reading' : 'both ways and in order'}`],
      comparedFact(columns),
    ];
    pairs.push(...vouched(options.words));
    if (report.corner_mm > 0) pairs.splice(2, 0, ['Corners', `at most ${lengthText(report.corner_mm, 5)} from the new path`]);
    const { file } = report.output;
    return [facts(pairs), ...proofNotes(report.proved, 'The new text could not be shown to keep the tolerance; nothing was written.', columns, path),
      ...(file && file !== '-' ? again(`batten verify ${shellWord(report.input.file)} ${shellWord(file)} --tolerance ${toleranceWord(options)}${band ? ' --tolerance-kind band' : ''}`) : [])];
  };

  const names = Object.keys(options).filter((name) => !['tolerance_mm', 'tolerance_inch', 'words'].includes(name));
  return {
    maker: 'Batten smooth', names: [report.input.file, report.output.file || 'nothing written'],
    madeFor: () => `for ${report.output.target}, machine ${options.machine}, tolerance ${lengthText(options.tolerance_mm)}${band ? ' (band reading)' : ''}`,
    verdict, tiles, proof, rows, reasons: report.reasons, compared: true, understood: report.understood,
    tolerance: options.tolerance_mm, machine: options.machine, colours: ['deviation', 'speed', 'status'],
    isRewritten: (i) => path.step[i] === STEP.rewritten, statusWords: ['rewritten', 'kept as it was'],
    tableTitle: 'Time by run', tableNote: 'Rewritten, slow and far off first; seconds are predictions, each run by itself.',
    filters: [['all', 'All'], ['rewritten', 'Rewritten'], ['kept', 'Kept']],
    interest: (r) => (r.status === 'rewritten' ? 3 : 0) + r.time_before_s / slowest + r.deviation_mm / options.tolerance_mm,
    columns: [
      ['Lines', (r) => r.first_line, '', lines],
      ['What became of it', (r) => r.status + (r.method || r.reason), '',
        statusCell((r) => (r.status === 'rewritten' ? `rewritten, ${r.form} (${r.method})` : `kept: ${r.reason}`))],
      ['Blocks', (r) => r.blocks_in, 'number', (r) => (r.blocks_in === r.blocks_out ? thousands(r.blocks_in)
        : `${thousands(r.blocks_in)} \u2192 ${thousands(r.blocks_out)}`)],
      ['Deviation', (r) => r.deviation_mm, 'number', (r) => (r.status === 'rewritten'
        ? [lengthText(r.deviation_mm), oneBar(r.deviation_mm / options.tolerance_mm, 'mini')] : ['none'])],
      ['Time', (r) => r.time_before_s, 'number', (r) => (!(r.time_before_s > 0) ? DASH
        : r.time_before_s === r.time_after_s ? timeText(r.time_before_s) : `${timeText(r.time_before_s)} \u2192 ${timeText(r.time_after_s)}`)],
      ['Before and after', (r) => r.time_before_s - r.time_after_s, '', bars],
    ],
    options: [['batten', report.batten], ['input', `${report.input.file}, ${thousands(report.input.bytes)} bytes`],
      ['tolerance', toleranceWord(options)], ...names.map((name) => [name.replaceAll('_', '-'), saidOption(options[name])]), ...vouched(options.words)],
  };
}

// --- verify -------------------------------------------------------------------------------------

function comparedFact(columns) {
  return ['Compared', `${count(columns.sections, 'changed section', 'changed sections')} by ${count(columns.pairs, 'pair', 'pairs')} of places, `
    + `${count(columns.events ?? 0, 'acting word or block', 'acting words and blocks')}`];
}

function proofNotes(proved, otherwise, columns, path) {
  const notes = [
    element('p', {}, proved ? 'The new text was read as a control would read it, and compared with the old program. Between two neighbouring pairs both '
      + 'paths run straight, so no place between them is further off than the pairs. All other blocks do the same.' : otherwise),
    element('p', {}, 'Not part of the proof is what the control itself adds, such as blending at corners. Cutting times are predictions of a model.'),
  ];
  if (columns.sections_not_shown > 0) notes.push(element('p', {}, `${columns.sections_not_shown} compared sections are not drawn on this page.`));
  return [...notes, ...regionNotes(path.region).map((text) => element('p', {}, text))];
}

// Of which changed sections the page draws no region, and why.
function regionNotes({ drawn, inSpace, leftOut, mostEdges }) {
  const of = (n, text) => (n ? [`${count(n, 'changed section', 'changed sections')} ${text}.`] : []);
  if (!drawn && !inSpace && !leftOut) return ['Nothing was compared.'];
  return [
    ...of(inSpace, 'without a region: it is drawn of sections that lie in one plane across an axis'),
    ...of(leftOut, `without a region: a page draws it of ${thousands(mostEdges)} lines of the old program at most`)];
}

function verifyPage(report, path, columns) {
  const rows = report.sections.map((s) => ({
    ...s, first_line: s.old_first_line, last_line: s.old_last_line, status: 'rewritten', deviation_mm: s.at_most_mm ?? Infinity }));
  const band = report.tolerance_kind === 'band';
  const found = report.violations;
  const place = report.deviation_line > 0 ? `, near line ${report.deviation_line} of the old program` : '';
  return {
    maker: 'Batten verify', names: [report.old, report.new],
    madeFor: () => `tolerance ${lengthText(report.tolerance_mm)}${band ? ' (band reading)' : ''}`,
    verdict: () => (report.proved
      ? ['good', '\u2713', `Proved: never more than ${lengthText(report.deviation_mm)} from the old path,`,
        `${band ? 'in order, in the band reading' : 'both ways and in order'}; the same words act in the same places. Allowed: ${lengthText(report.tolerance_mm)}.`]
      : ['bad', '\u2715', `Not proved: ${count(found.length, 'violation', 'violations')}.`, 'They stand below, each with its line.']),
    tiles: () => [
      tile('Deviation', [rows.length ? figure('deviation_mm', report.deviation_mm, lengthText(report.deviation_mm)) : 'none'],
        [rows.length ? `of ${lengthText(report.tolerance_mm)} allowed${place}` : 'the paths are the same'], oneBar(report.deviation_mm / report.tolerance_mm)),
      tile('Changed sections', [figure('sections', rows.length, thousands(rows.length))], [count(columns.pairs, 'pair of places', 'pairs of places')]),
      tile('The same', [figure('events_compared', report.events_compared, thousands(report.events_compared))], ['acting words and blocks']),
      tile('Violations', [figure('violations', found.length, thousands(found.length))], [found.length ? 'see below' : 'none found']),
    ],
    messages: found.map((v) => ({ severity: 'error', id: v.id, line: v.new_line || v.old_line, column: v.new_line ? 'new' : 'old', message: v.message })),
    proof: () => [facts([['Verdict', report.proved ? 'proved' : 'NOT PROVED'],
      ['Greatest deviation', `at most ${lengthText(report.deviation_mm, 5)}${place}`],
      ['Allowed', `${lengthText(report.tolerance_mm, 5)}, ${band ? 'in order, band reading' : 'both ways and in order'}`], comparedFact(columns), ...vouched(report.words)]),
    ...proofNotes(report.proved, 'The new program could not be shown to do what the old one does.', columns, path)],
    rows, reasons: [], compared: true, understood: true, tolerance: report.tolerance_mm, machine: '', colours: ['deviation', 'status'],
    isRewritten: (i) => path.step[i] === STEP.rewritten, statusWords: ['changed', 'the same'],
    tableTitle: 'Changed sections', tableNote: 'Those that are farthest off first.', filters: [],
    interest: (r) => (r.proved ? 0 : 1) + Math.min(r.deviation_mm, 1e9) / report.tolerance_mm,
    columns: [
      ['Old lines', (r) => r.first_line, '', lines],
      ['New lines', (r) => r.new_first_line, '', (r) => linesText(r.new_first_line, r.new_last_line)],
      ['Verdict', (r) => String(r.proved), '', statusCell((r) => (r.proved ? 'proved' : 'NOT PROVED'))],
      ['Deviation at most', (r) => r.deviation_mm, 'number', (r) => (Number.isFinite(r.deviation_mm)
        ? [lengthText(r.deviation_mm), oneBar(r.deviation_mm / report.tolerance_mm, 'mini')] : [DASH])],
      ['Pairs', (r) => r.certificate_size, 'number', (r) => thousands(r.certificate_size)],
    ],
    options: [['batten', report.batten], ['old', report.old], ['new', report.new], ['tolerance', lengthText(report.tolerance_mm)],
      ['tolerance-kind', report.tolerance_kind], ['side', report.side], ...vouched(report.words)],
  };
}

// --- inspect ------------------------------------------------------------------------------------

function inspectPage(report, path) {
  const rows = report.sections.filter((s) => s.status === 'run' || s.cutting_moves > 0)
    .map((s) => ({ ...s, status: s.status === 'run' ? 'rewritten' : 'kept' }));
  const runs = rows.filter((r) => r.status === 'rewritten');
  const moves = rows.reduce((sum, r) => sum + r.cutting_moves, 0);
  const inRuns = runs.reduce((sum, r) => sum + r.cutting_moves, 0);
  const share = inRuns / Math.max(1, moves);
  const longest = Math.max(1, ...rows.map((r) => r.cutting_moves));
  const part = (name, text) => (r) => (r.segments ? text(r.segments[name]) : DASH);
  const length = (mm) => lengthText(mm, 3);
  const of = (name) => (r) => r.segments?.[name] ?? -1;
  return {
    maker: 'Batten inspect', names: [report.input.file, null], madeFor: () => 'nothing is written',
    verdict: () => (runs.length
      ? ['good', '\u2713', `${count(runs.length, 'run', 'runs')} may be rewritten.`, `${percent(share)} of the cutting moves are in them.`]
      : ['plain', DASH, 'No run may be rewritten.', 'Why, stands below.']),
    tiles: () => [
      tile('Blocks', [figure('input.blocks', report.input.blocks, thousands(report.input.blocks))], [`${thousands(report.input.bytes)} bytes`]),
      tile('Runs', [figure('runs', runs.length, thousands(runs.length))], [`${thousands(inRuns)} of ${thousands(moves)} cutting moves`], oneBar(share)),
      ...(runs.length ? [tile('Shortest move', [length(Math.min(...runs.map((r) => r.segments.shortest_mm)))],
        [`median of the longest run ${length(runs.reduce((a, b) => (b.segments.count > a.segments.count ? b : a)).segments.median_mm)}`])] : []),
      tile('Kept', [figure('kept', moves - inRuns, thousands(moves - inRuns))], ['cutting moves', report.kept.length ? `; reasons: ${report.kept.length}` : '']),
    ],
    proof: () => null,
    rows, reasons: report.kept.map((k) => ({ ...k, runs: k.sections })), compared: false, understood: true, tolerance: 0.01, machine: '', colours: ['status'],
    isRewritten: (i) => rows[path.run[i]]?.status === 'rewritten', statusWords: ['may be rewritten', 'kept'],
    tableTitle: 'Runs, and what is kept', tableNote: 'Runs of the most moves first.',
    filters: [['all', 'All'], ['rewritten', 'Runs'], ['kept', 'Kept']],
    interest: (r) => (r.status === 'rewritten' ? 3 : 0) + r.cutting_moves / longest,
    columns: [
      ['Lines', (r) => r.first_line, '', lines],
      ['What it is', (r) => r.status + r.reason, '', statusCell((r) => (r.status === 'kept' ? `kept: ${r.reason}` : r.closed ? 'run, closed' : 'run'))],
      ['Cutting moves', (r) => r.cutting_moves, 'number', (r) => thousands(r.cutting_moves)],
      ['Length', of('length_mm'), 'number', part('length_mm', length)],
      ['Shortest move', of('shortest_mm'), 'number', part('shortest_mm', length)],
      ['Longest move', of('longest_mm'), 'number', part('longest_mm', length)],
      ['Greatest turn', of('greatest_turn_deg'), 'number', part('greatest_turn_deg', (deg) => `${deg.toFixed(1)}\u00b0`)],
    ],
    options: [['batten', report.batten], ['input', `${report.input.file}, ${thousands(report.input.bytes)} bytes`], ...vouched(report.words)],
  };
}

// --- time ---------------------------------------------------------------------------------------

function timePage(report, path) {
  const rows = report.slowest.map((s) => ({ ...s, status: 'slow' })).sort((a, b) => a.first_line - b.first_line);
  const parts = [['Cutting', 'cutting_s'], ['Rapids', 'rapid_s'], ['Dwells', 'dwell_s'], ['Tool changes', 'tool_change_s'],
    ['Spindle', 'spindle_s'], ['Rotary axes', 'rotary_s']];
  const whole = Math.max(report.time_s, 1e-9);
  const more = { cutting_s: `${thousands(report.cuts)} moves, ${lengthText(report.cutting_mm, 0)}`, rapid_s: `${thousands(report.rapids)} moves, ${lengthText(report.rapid_mm, 0)}`,
    dwell_s: thousands(report.dwells), tool_change_s: thousands(report.tool_changes), spindle_s: count(report.spindle_starts, 'start', 'starts') };
  const slow = report.below_half_feed_s / Math.max(report.cutting_s, 1e-9);
  const speed = (r) => r.length_mm / r.time_s * 60;
  const tools = report.tools.filter((t) => t.time_s > 0);
  return {
    maker: 'Batten time', names: [report.input.file, null], madeFor: () => `on machine ${report.machine}, predicted by the model of its control`,
    verdict: () => ['plain', '\u23f1', `${timeText(report.time_s)} on ${report.machine}.`,
      report.cutting_s > 0 ? `${percent(slow)} of the cutting time is below half of the programmed feed.` : 'Nothing is cut.'],
    tiles: () => [tile('Time, predicted', [figure('time_s', report.time_s, timeText(report.time_s))], [`machine ${report.machine}`]),
      ...parts.filter(([, name]) => report[name] > 0).map(([title, name]) => tile(title, [figure(name, report[name], timeText(report[name]))],
        [`${percent(report[name] / whole)}${more[name] ? `; ${more[name]}` : ''}`], oneBar(report[name] / whole))),
      ...(report.cutting_s > 0 ? [tile('Slow', [figure('below_half_feed_s', report.below_half_feed_s, timeText(report.below_half_feed_s))],
        [`${percent(slow)} of the cutting time is below half of the programmed feed`], oneBar(slow))] : []),
      ...(tools.length > 1 ? tools.map((t) => tile(t.tool === null ? 'Before a tool' : `Tool T${t.tool}`, [timeText(t.time_s)],
        [`cutting ${timeText(t.cutting_s)}`], oneBar(t.time_s / whole))) : [])],
    messages: report.not_timed.map((n) => ({ severity: 'note', id: n.id, line: n.first_line, column: 1, message: `${count(n.count, 'block', 'blocks')}: ${n.text}` })),
    proof: () => null,
    rows, reasons: [], compared: false, understood: true, tolerance: 0.01, machine: report.machine, colours: ['speed'],
    isRewritten: () => true, statusWords: ['', ''],
    tableTitle: 'Slow places', tableNote: 'Blocks below half of their programmed feed, most time lost first.', filters: [],
    interest: (r) => r.lost_s,
    columns: [
      ['Lines', (r) => r.first_line, '', lines],
      ['Lost', (r) => r.lost_s, 'number', (r) => timeText(r.lost_s)],
      ['Time', (r) => r.time_s, 'number', (r) => timeText(r.time_s)],
      ['Length', (r) => r.length_mm, 'number', (r) => lengthText(r.length_mm, 1)],
      ['Speed', speed, 'number', (r) => feedText(speed(r))],
      ['Programmed', (r) => r.feed_mm_per_min, 'number', (r) => feedText(r.feed_mm_per_min)],
    ],
    options: [['batten', report.batten], ['input', `${report.input.file}, ${thousands(report.input.bytes)} bytes`], ['machine', report.machine], ...vouched(report.words)],
  };
}

const KINDS = { smooth: smoothPage, verify: verifyPage, inspect: inspectPage, time: timePage };
