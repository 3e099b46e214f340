// Everything together: one state, drawn again when it changes.

(() => {
  const started = performance.now();
  const data = JSON.parse(byId('data').textContent);
  const { report } = data;
  const path = readPath(data.path);
  const page = KINDS[data.kind](report, path, data.path);
  const ranges = verticesOfRuns(path, page.rows.length);
  const colours = page.colours.filter((name) => name !== 'speed' || path.fastest > 0);
  const settings = {
    old: page.compared, now: true, rapids: false, region: false, colour: colours[0] ?? 'status', magnify: 1, tolerance: page.tolerance,
    isRewritten: page.isRewritten, compared: page.compared,
  };
  units.inch = data.units === 'inch';
  document.documentElement.dataset.theme =
    matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';

  const toolPath = new ToolPath(byId('canvas'), path, settings);
  const charts = new Charts(['chart-deviation', 'chart-radius', 'chart-speed'].map(byId), path, settings);
  const runs = new Runs(page, {
    head: byId('run-table').tHead.rows[0], body: byId('run-table').tBodies[0], strip: byId('strip'),
    more: byId('more-runs'), empty: byId('runs-empty'),
  });
  const isEmpty = path.n === 0;
  const hasCut = path.length > 0;

  // --- what the path shows ----------------------------------------------------------------------

  // The slider goes from 1 to the magnification at which the tolerance is some 40 px wide in the
  // picture of all.
  const sizeOfAll = () => Math.max(1e-3, Math.hypot(...toolPath.box.map(([low, high]) => high - low)));
  const mostMagnified = () => Math.max(10, 0.06 * sizeOfAll() / settings.tolerance);
  const magnifyOf = (share) => mostMagnified() ** share;
  const magnifyText = () => {
    const m = settings.magnify;
    return m < 1.05 ? 'as it is' : `${m < 10 ? m.toFixed(1) : thousands(Number(m.toPrecision(2)))} times`;
  };

  function drawLegend() {
    const parts = [];
    const row = (colour, text, dashed) => {
      const line = element('i');
      line.style.borderTopColor = colour;
      if (dashed) line.style.borderTopStyle = 'dashed';
      return element('div', { className: 'row' }, line, text);
    };
    const colours = themeColours();
    if (settings.now && settings.colour !== 'status') {
      const stops = [0, 0.25, 0.5, 0.75, 1].map(scaleColour).join(', ');
      const scale = element('i');
      scale.style.background = `linear-gradient(to right, ${stops})`;
      const deviation = settings.colour === 'deviation';
      parts.push(element('b', {}, deviation ? 'Deviation, new from old' : 'Predicted speed'),
        element('div', { className: 'scale' }, scale,
          element('div', { className: 'ends' }, element('span', {}, deviation ? '0' : feedText(path.fastest)),
            element('span', {}, deviation ? `${lengthText(settings.tolerance)} allowed` : '0'))));
    }
    if (settings.now && settings.colour === 'status') parts.push(row(colours.now, page.statusWords[0]), row(colours.kept, page.statusWords[1]));
    if (settings.old) parts.push(row(colours.old, 'old path'));
    if (settings.rapids) parts.push(row(colours.rapid, 'rapids', true));
    if (settings.region) {
      parts.push(element('div', { className: 'row' }, element('i', { className: 'area' }), 'region of the tolerance',
        element('span', { id: 'region-note' })));
    }
    byId('legend').replaceChildren(...parts);
    drawRegionNote();
  }

  // It changes with the scale of the picture.
  function drawRegionNote() {
    const note = byId('region-note');
    const why = toolPath.whyNoRegion();
    if (note) note.textContent = why && `(${why})`;
  }

  function drawReadout() {
    const place = byId('readout');
    const mark = toolPath.marked;
    if (!mark) {
      place.textContent = isEmpty ? '' : 'Point at the path to read it; drag to move, turn the wheel to zoom.';
      return;
    }
    const i = mark.vertex;
    const before = path.step[i] === STEP.none ? i : Math.max(0, i - 1);
    const mix = (column) => column[before] + mark.share * (column[i] - column[before]);
    const item = (name, text) => element('span', {}, `${name} `, element('b', {}, text));
    const line = page.compared && path.newLine[i] > 0 ? `${path.oldLine[i]} \u2192 ${path.newLine[i]}` : String(path.oldLine[i]);
    const items = [item('line', line),
      item('at', ['x', 'y', 'z'].map((axis) => `${axis.toUpperCase()}${units.of(mix(path[axis])).toFixed(units.inch ? 4 : 3)}`).join(' '))];
    if (path.step[i] === STEP.rapid) items.push(item('rapid', page.compared ? 'copied' : ''));
    if (path.step[i] >= STEP.copied) {
      const both = (before, after, text) => (page.compared ? `${text(mix(before))} \u2192 ${text(mix(after))}` : text(mix(after)));
      if (page.compared) items.push(item('deviation', path.step[i] === STEP.rewritten ? lengthText(mix(path.deviation)) : 'none, copied'));
      items.push(item('bend', both(path.bendBefore, path.bendAfter, radiusText)));
      if (path.fastest > 0) items.push(item('speed', both(path.speedBefore, path.speedAfter, feedText)));
      if (path.feed[i] > 0) items.push(item('programmed', feedText(path.feed[i])));
    }
    if (path.run[i] >= 0) {
      const run = page.rows[path.run[i]];
      items.push(item('run', `${linesText(run.first_line, run.last_line)}${run.status === 'kept' ? `, kept: ${run.reason}` : ''}`));
    }
    place.replaceChildren(...items);
  }

  function mark(place) {
    toolPath.marked = place;
    charts.marked = place;
    toolPath.draw();
    charts.draw();
    drawReadout();
  }

  function drawButtons() {
    const press = (selector, isOn) => document.querySelectorAll(selector).forEach((b) => b.setAttribute('aria-pressed', String(isOn(b))));
    press('[data-view]', (b) => b.dataset.view === toolPath.view);
    press('[data-layer]', (b) => settings[b.dataset.layer]);
    press('[data-runs]', (b) => b.dataset.runs === runs.filter);
    byId('units').textContent = units.inch ? 'inch' : 'mm';
    byId('theme').textContent = isDark() ? 'Light' : 'Dark';
    byId('colour').value = settings.colour;
    byId('magnify-text').textContent = magnifyText();
  }

  function drawAlong() {
    byId('deviation-unit').textContent = `${units.length}, of the pairs that prove it`;
    byId('radius-unit').textContent = `${units.length}, high is a tight bend`;
    byId('speed-title').textContent = path.fastest > 0 ? 'Predicted speed' : 'Programmed feed';
    byId('speed-unit').textContent = path.fastest > 0 ? `${units.feed}, model of ${page.machine}` : units.feed;
    byId('along-note').textContent = hasCut ? `${units.of(path.length).toFixed(units.inch ? 2 : 1)} ${units.length} of cutting moves` : '';
    const colours = themeColours();
    const entry = (colour, text, dashed) => {
      const line = element('i');
      line.style.borderTopColor = colour;
      if (dashed) line.style.borderTopStyle = 'dotted';
      return element('span', {}, line, text);
    };
    byId('along-key').replaceChildren(...(page.compared ? [entry(colours.old, 'before'), entry(colours.now, 'after')] : []),
      entry(colours.soft, 'programmed feed', true), page.compared ? element('span', {}, 'grey ground: copied as it was') : '');
    byId('chart-deviation').parentElement.hidden = !page.compared;
    byId('charts').hidden = byId('along-key').hidden = !hasCut;
    byId('along-empty').hidden = hasCut;
    byId('along-empty').textContent = 'There are no cutting moves to draw.';
    document.querySelector('#chart-speed').parentElement.hidden = !(path.fastest > 0 || path.feed.some((feed) => feed > 0));
    charts.draw();
  }

  function drawAll() {
    byId('made-for').textContent = page.madeFor();
    drawVerdict(page.verdict());
    byId('tiles').replaceChildren(...page.tiles());
    const proof = page.proof();
    byId('proof').hidden = !proof;
    if (proof) byId('proof-text').replaceChildren(...proof);
    drawAgain(data.command, page.options);
    drawLegend();
    drawButtons();
    drawReadout();
    drawAlong();
    byId('runs-note').textContent = page.rows.length ? page.tableNote : '';
    runs.draw();
    runs.drawReasons(byId('reasons'), (i) => choose(i, true));
    byId('path-empty').hidden = !isEmpty;
    byId('path-empty').textContent = page.understood ? 'This program has no moves that could be drawn.' : 'The program was not understood, so there is no path to show.';
    toolPath.draw();
  }

  function choose(index, scrollToPath) {
    runs.choose(index, !scrollToPath);
    const range = index >= 0 ? ranges[index] : null;
    toolPath.chosen = range;
    if (range) {
      toolPath.fit(...range);
      charts.show(path.way[range[0]], Math.max(path.way[range[1]], path.way[range[0]] + 1e-3));
      if (scrollToPath) byId('path').scrollIntoView({ block: 'start' });
    } else {
      toolPath.fit();
      charts.show(0, path.length);
    }
  }

  // --- what the user does -------------------------------------------------------------------------

  function setView(view) {
    toolPath.show(view);
    drawButtons();
  }

  function toggle(layer) {
    if (!page.compared && layer !== 'rapids') return;
    if (layer === 'region' && !path.region.drawn) return;
    settings[layer] = !settings[layer];
    drawLegend();
    drawButtons();
    toolPath.draw();
  }

  function setMagnify(share) {
    byId('magnify').value = 100 * share;
    settings.magnify = magnifyOf(share);
    byId('magnify-text').textContent = magnifyText();
    toolPath.draw();
  }

  function goToWorst() {
    if (path.worst < 1) return;
    const vertex = path.worst;
    // So near that the tolerance is some 60 px wide, but some moves of the path are to be seen.
    const width = byId('canvas').getBoundingClientRect().width;
    const around = path.way[Math.min(path.n - 1, vertex + 4)] - path.way[Math.max(0, vertex - 4)];
    const near = Math.max(settings.tolerance * width / 60, Math.min(around, settings.tolerance * width / 8), 0.02);
    toolPath.goTo(vertex, near);
    const half = Math.max(near, path.length / 400);
    charts.show(path.way[vertex] - half, path.way[vertex] + half);
    mark({ vertex, share: 1 });
  }

  // What a message is about, so near that the tolerance is to be seen.
  function goToLine(line) {
    const vertex = path.oldLine.findIndex((of, i) => of >= line && path.step[i] >= STEP.copied);
    if (vertex < 0) return;
    toolPath.goTo(vertex, settings.tolerance * byId('canvas').getBoundingClientRect().width / 30);
    mark({ vertex, share: 0.5 });
    byId('path').scrollIntoView({ block: 'start' });
  }

  function showAll() {
    choose(-1);
    mark(null);
  }

  function setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    drawAll();
  }

  const KEYS = [
    ['1 2 3 4', 'plan, front, side, 3D', { 1: () => setView('plan'), 2: () => setView('front'), 3: () => setView('side'), 4: () => setView('space') }],
    ['0', 'show all', { 0: showAll }],
    ['w', 'go to the greatest deviation', { w: goToWorst }],
    ['[ ]', 'deviation drawn smaller, larger', { '[': () => nudgeMagnify(-0.1), ']': () => nudgeMagnify(0.1) }],
    ['o n r', 'old path, new path, rapids', { o: () => toggle('old'), n: () => toggle('now'), r: () => toggle('rapids') }],
    ['g', 'region of the tolerance', { g: () => toggle('region') }],
    ['c', 'next colour', { c: nextColour }],
    ['j k', 'next run, run before', { j: () => stepRun(1), k: () => stepRun(-1) }],
    ['u t', 'millimetres or inches, light or dark', { u: toggleUnits, t: () => setTheme(isDark() ? 'light' : 'dark') }],
    ['?', 'these keys', { '?': () => byId('keys').showModal() }],
    ['arrows, + \u2212', 'move and zoom the picture that has the focus; Shift turns in 3D', {}],
  ];
  const actions = Object.assign({}, ...KEYS.map(([, , doing]) => doing));

  function nudgeMagnify(by) {
    setMagnify(Math.min(1, Math.max(0, Number(byId('magnify').value) / 100 + by)));
  }

  function nextColour() {
    const names = [...byId('colour').options].map((option) => option.value);
    setColour(names[(names.indexOf(settings.colour) + 1) % names.length]);
  }

  function setColour(colour) {
    settings.colour = colour;
    drawLegend();
    drawButtons();
    toolPath.draw();
  }

  function stepRun(by) {
    const listed = runs.listed();
    if (!listed.length) return;
    const at = listed.indexOf(runs.chosen);
    choose(listed[(at < 0 ? (by > 0 ? 0 : listed.length - 1) : at + by + listed.length) % listed.length]);
  }

  function toggleUnits() {
    units.inch = !units.inch;
    drawAll();
  }

  function listenToPath() {
    const canvas = byId('canvas');
    const fingers = new Map();
    const at = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    const spread = () => {
      const [a, b] = [...fingers.values()];
      return Math.hypot(a[0] - b[0], a[1] - b[1]);
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, at(event));
      canvas.classList.add('moving');
    });
    const end = (event) => {
      fingers.delete(event.pointerId);
      canvas.classList.toggle('moving', fingers.size > 0);
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
    canvas.addEventListener('pointermove', (event) => {
      const [x, y] = at(event);
      const last = fingers.get(event.pointerId);
      if (!last) {
        if (fingers.size === 0) mark(toolPath.nearest(x, y));
        return;
      }
      if (fingers.size === 2) {
        const before = spread();
        fingers.set(event.pointerId, [x, y]);
        toolPath.zoom(spread() / Math.max(1, before), x, y);
        return;
      }
      fingers.set(event.pointerId, [x, y]);
      if (toolPath.view === 'space' && (event.shiftKey || event.buttons === 2)) {
        toolPath.rotate((x - last[0]) * -0.008, (y - last[1]) * 0.008);
      } else {
        toolPath.move(x - last[0], y - last[1]);
      }
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      toolPath.zoom(Math.exp(-event.deltaY * 0.0018), ...at(event));
    }, { passive: false });
    canvas.addEventListener('dblclick', (event) => toolPath.zoom(2, ...at(event)));
    canvas.addEventListener('keydown', (event) => {
      const steps = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      if (event.key in steps) {
        const [right, down] = steps[event.key];
        if (event.shiftKey) toolPath.rotate(-0.1 * right, -0.1 * down);
        else toolPath.move(40 * right, 40 * down);
      } else if (event.key === '+' || event.key === '=') toolPath.zoom(1.4);
      else if (event.key === '-') toolPath.zoom(1 / 1.4);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  function listen() {
    document.querySelectorAll('[data-view]').forEach((b) => b.addEventListener('click', () => setView(b.dataset.view)));
    document.querySelectorAll('[data-layer]').forEach((b) => b.addEventListener('click', () => toggle(b.dataset.layer)));
    byId('run-filters').replaceChildren(...page.filters.map(([name, text]) => element('button', { type: 'button', 'data-runs': name }, text)));
    document.querySelectorAll('[data-runs]').forEach((b) => b.addEventListener('click', () => {
      runs.filter = b.dataset.runs;
      runs.shown = RUNS_AT_ONCE;
      runs.draw();
      drawButtons();
    }));
    byId('colour').addEventListener('change', (event) => setColour(event.target.value));
    byId('magnify').addEventListener('input', (event) => setMagnify(event.target.value / 100));
    byId('fit').addEventListener('click', showAll);
    byId('worst').addEventListener('click', goToWorst);
    byId('along-all').addEventListener('click', () => charts.show(0, path.length));
    byId('units').addEventListener('click', toggleUnits);
    byId('theme').addEventListener('click', () => setTheme(isDark() ? 'light' : 'dark'));
    byId('print').addEventListener('click', () => print());
    byId('help').addEventListener('click', () => byId('keys').showModal());
    byId('more-runs').addEventListener('click', () => { runs.shown += RUNS_AT_ONCE; runs.draw(); });
    const body = byId('run-table').tBodies[0];
    const rowOf = (event) => event.target.closest('tr');
    const pick = (row) => choose(Number(row.dataset.run) === runs.chosen ? -1 : Number(row.dataset.run));
    body.addEventListener('click', (event) => { if (rowOf(event)) pick(rowOf(event)); });
    body.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' || !rowOf(event)) return;
      const index = rowOf(event).dataset.run;
      pick(rowOf(event));
      body.querySelector(`[data-run="${index}"]`)?.focus();
    });
    byId('messages').addEventListener('click', (event) => {
      const { line } = event.target.dataset;
      if (line) goToLine(Number(line));
    });
    byId('strip').addEventListener('click', (event) => {
      const box = byId('strip').getBoundingClientRect();
      const index = runs.runAtStrip(event.clientX - box.left, event.clientY - box.top);
      if (index >= 0) choose(index);
    });
    byId('strip').addEventListener('pointermove', (event) => {
      const box = byId('strip').getBoundingClientRect();
      const index = runs.runAtStrip(event.clientX - box.left, event.clientY - box.top);
      const r = page.rows[index];
      byId('strip').title = r ? `lines ${linesText(r.first_line, r.last_line)}: ${timeText(r.time_before_s)} \u2192 ${timeText(r.time_after_s)}` : '';
    });
    document.addEventListener('keydown', (event) => {
      const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== 'range';
      if (typing || event.ctrlKey || event.metaKey || event.altKey || byId('keys').open || !(event.key in actions)) return;
      event.preventDefault();
      actions[event.key]();
    });
    listenToPath();
    toolPath.onDrawn = drawRegionNote;
    charts.onMark = mark;
    charts.onPick = (place) => { if (place) { toolPath.centre = [toolPath.u[place.vertex], toolPath.v[place.vertex]]; mark(place); } };
    const resized = new ResizeObserver(() => {
      toolPath.resize();
      charts.draw();
      runs.drawStrip();
    });
    for (const id of ['canvas', 'charts', 'strip']) resized.observe(byId(id));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => setTheme(event.matches ? 'dark' : 'light'));
    listenToPrinting();
  }

  // On paper: light, sharp, all runs that were asked for.
  function listenToPrinting() {
    let theme = null;
    const redraw = () => {
      drawAll();
      toolPath.drawNow();
      charts.drawNow();
    };
    addEventListener('beforeprint', () => {
      theme = document.documentElement.dataset.theme;
      document.documentElement.dataset.theme = 'light';
      redraw();
    });
    addEventListener('afterprint', () => {
      document.documentElement.dataset.theme = theme;
      redraw();
    });
  }

  byId('key-list').replaceChildren(...KEYS.flatMap(([keys, text]) => [
    element('dt', {}, ...keys.split(' ').map((key) => (key.length === 1 ? element('kbd', {}, key) : `${key} `))), element('dd', {}, text)]));
  for (const control of document.querySelectorAll('#path .head button, #path .head select, #path .head input')) control.disabled = isEmpty;
  const regionButton = document.querySelector('[data-layer=region]');
  regionButton.disabled = !path.region.drawn;
  regionButton.title = ['The region of the tolerance (g).', ...regionNotes(path.region)].join(' ');
  const colourNames = { deviation: 'deviation', speed: 'predicted speed', status: page.statusWords.join(' or ') };
  byId('colour').replaceChildren(...colours.map((name) => element('option', { value: name }, colourNames[name])));
  for (const part of document.querySelectorAll('[data-of-two]')) part.hidden = !page.compared;
  byId('kept').hidden = !page.filters.length;
  byId('runs-title').textContent = page.tableTitle;
  document.querySelector('.maker').textContent = page.maker;
  ['input-name', 'output-name'].forEach((id, i) => {
    byId(id).textContent = (page.names[i] ?? '').split('/').pop();
    byId(id).title = page.names[i] ?? '';
  });
  document.querySelector('.arrow').hidden = page.names[1] === null;
  drawMessages([...(page.messages ?? []), ...report.diagnostics]);
  byId('worst').disabled = isEmpty || !(path.worst >= 0 && path.deviation[path.worst] > 0);

  listen();
  setView(isInSpace(path) ? 'space' : 'plan');
  drawAll();
  // For tests and for the curious: how long it took, and what stands where.
  requestAnimationFrame(() => requestAnimationFrame(() => {
    document.documentElement.dataset.readyMs = String(Math.round(performance.now() - started));
    window.battenReport = { report, page, path, toolPath, charts, runs, settings };
  }));
})();
