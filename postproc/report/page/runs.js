// The runs: as two bars of time, as a table, and the kept ones by reason.

const RUNS_AT_ONCE = 100;
const LINES_AT_ONCE = 24;

// [title, key to sort by, class]
const RUN_COLUMNS = [
  ['Lines', (r) => r.first_line, ''],
  ['What became of it', (r) => r.status + (r.method || r.reason), ''],
  ['Blocks', (r) => r.blocks_in, 'number'],
  ['Deviation', (r) => r.deviation_mm, 'number'],
  ['Time', (r) => r.time_before_s, 'number'],
  ['Before and after', (r) => r.time_before_s - r.time_after_s, ''],
];

class Runs {
  constructor(report, parts) {
    Object.assign(this, { report, ...parts });
    this.runs = report.runs;
    this.filter = 'all';
    this.sort = { column: 0, down: false };
    this.shown = RUNS_AT_ONCE;
    this.chosen = -1;
    this.slowest = this.runs.reduce((most, r) => Math.max(most, r.time_before_s, r.time_after_s), 1e-9);
    this.drawHead();
  }

  choose(index, scroll = false) {
    this.chosen = index;
    if (scroll) {
      const at = this.listed().indexOf(index);
      if (at >= this.shown) this.shown = at + RUNS_AT_ONCE;
    }
    this.draw();
    if (scroll) this.body.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: 'nearest' });
  }

  listed() {
    const key = RUN_COLUMNS[this.sort.column][1];
    const indices = this.runs.map((_, i) => i)
      .filter((i) => this.filter === 'all' || this.runs[i].status === this.filter);
    return indices.sort((a, b) => {
      const [x, y] = [key(this.runs[a]), key(this.runs[b])];
      const order = x < y ? -1 : x > y ? 1 : a - b;
      return this.sort.down ? -order : order;
    });
  }

  drawHead() {
    this.head.replaceChildren(...RUN_COLUMNS.map(([title, , kind], column) => {
      const button = element('button', { type: 'button', title: 'Sort' }, title);
      button.addEventListener('click', () => {
        const again = this.sort.column === column;
        this.sort = { column, down: again ? !this.sort.down : column >= 2 };
        this.drawHead();
        this.draw();
      });
      const cell = element('th', { className: kind, scope: 'col' }, button);
      if (this.sort.column === column) {
        cell.setAttribute('aria-sort', this.sort.down ? 'descending' : 'ascending');
        button.append(this.sort.down ? ' \u2193' : ' \u2191');
      }
      return cell;
    }));
  }

  row(index) {
    const r = this.runs[index];
    const rewritten = r.status === 'rewritten';
    const gauge = element('span', { className: 'mini', ariaHidden: 'true' }, element('i'));
    gauge.firstChild.style.width = `${Math.min(100, 100 * r.deviation_mm / this.report.options.tolerance_mm)}%`;
    const bars = element('span', { className: rewritten ? 'bars' : 'bars kept', ariaHidden: 'true' }, element('i'), element('i'));
    bars.children[0].style.width = `${100 * r.time_before_s / this.slowest}%`;
    bars.children[1].style.width = `${100 * r.time_after_s / this.slowest}%`;
    const what = element('span', { className: 'what' }, element('i', { className: rewritten ? 'dot' : 'dot kept' }),
      rewritten ? `rewritten, ${r.form} (${r.method})` : `kept: ${r.reason}`);
    const row = element('tr', { tabIndex: 0 },
      element('td', {}, linesText(r.first_line, r.last_line)),
      element('td', {}, what),
      element('td', { className: 'number' }, r.blocks_in === r.blocks_out ? thousands(r.blocks_in)
        : `${thousands(r.blocks_in)} \u2192 ${thousands(r.blocks_out)}`),
      element('td', { className: 'number' }, rewritten ? lengthText(r.deviation_mm) : 'none', rewritten ? gauge : ''),
      element('td', { className: 'number' }, r.time_before_s > 0
        ? (r.time_before_s === r.time_after_s ? timeText(r.time_before_s) : `${timeText(r.time_before_s)} \u2192 ${timeText(r.time_after_s)}`)
        : '\u2013'),
      element('td', {}, bars));
    row.setAttribute('aria-selected', String(index === this.chosen));
    row.dataset.run = index;
    return row;
  }

  draw() {
    const listed = this.listed();
    this.body.replaceChildren(...listed.slice(0, this.shown).map((i) => this.row(i)));
    const left = listed.length - this.shown;
    this.more.hidden = left <= 0;
    this.more.textContent = `Show ${thousands(Math.min(left, RUNS_AT_ONCE))} more of ${thousands(listed.length)}`;
    this.empty.hidden = listed.length > 0;
    this.empty.textContent = this.runs.length ? 'No such runs.' : 'This program has no chains of cutting moves.';
    this.drawStrip();
  }

  // Two bars, before above and after below, each as long as the time and in the order of the program.
  drawStrip() {
    const total = this.runs.reduce((sum, r) => sum + r.time_before_s, 0);
    this.strip.hidden = !(total > 0);
    if (this.strip.hidden) return;
    const { context, width, height } = sharpContext(this.strip);
    const colours = themeColours();
    const left = 52;
    const per = (width - left - 2) / Math.max(total, this.runs.reduce((sum, r) => sum + r.time_after_s, 0));
    context.font = '12px system-ui, sans-serif';
    context.textBaseline = 'middle';
    this.stripParts = [];
    for (const [row, key, name] of [[0, 'time_before_s', 'before'], [1, 'time_after_s', 'after']]) {
      const top = 4 + row * (height / 2);
      const tall = height / 2 - 8;
      context.fillStyle = colours.soft;
      context.fillText(name, 0, top + tall / 2);
      let x = left;
      this.runs.forEach((r, i) => {
        const wide = r[key] * per;
        context.fillStyle = row === 0 ? colours.old : r.status === 'rewritten' ? colours.now : colours.kept;
        context.globalAlpha = this.chosen < 0 || this.chosen === i ? 1 : 0.45;
        context.fillRect(x, top, Math.max(0.3, wide - (wide > 3 ? 1 : 0)), tall);
        this.stripParts.push({ from: x, to: x + wide, top, bottom: top + tall, run: i });
        x += wide;
      });
      context.globalAlpha = 1;
    }
  }

  runAtStrip(x, y) {
    return this.stripParts?.find((p) => x >= p.from && x < p.to && y >= p.top - 4 && y <= p.bottom + 4)?.run ?? -1;
  }

  // Reasons, each with what to do and the places.
  drawReasons(place, onLines) {
    const kept = this.report.reasons.map((reason) => {
      const runs = this.runs.map((_, i) => i).filter((i) => this.runs[i].status === 'kept' && this.runs[i].reason === reason.id);
      const lines = element('div', { className: 'lines' });
      const add = (from, to) => runs.slice(from, to).forEach((i) => {
        const button = element('button', { type: 'button', title: 'Show this place' }, linesText(this.runs[i].first_line, this.runs[i].last_line));
        button.addEventListener('click', () => onLines(i));
        lines.append(button);
      });
      add(0, LINES_AT_ONCE);
      if (runs.length > LINES_AT_ONCE) {
        const all = element('button', { type: 'button' }, `${thousands(runs.length - LINES_AT_ONCE)} more`);
        all.addEventListener('click', () => { all.remove(); add(LINES_AT_ONCE, runs.length); });
        lines.append(all);
      }
      const advice = /^Nothing\b/.test(reason.advice) ? '' : reason.advice;
      return element('article', { className: 'reason' },
        element('span', { className: 'count' }, `${thousands(reason.runs)} ${reason.runs === 1 ? 'run' : 'runs'}, ${thousands(reason.blocks)} ${reason.blocks === 1 ? 'block' : 'blocks'}`),
        element('h3', {}, reason.text || reason.id, element('code', {}, reason.id)),
        advice ? element('p', {}, advice) : '',
        reason.can_be_allowed ? element('p', {}, element('code', {}, `--allow ${reason.id}`), ' lifts this rule.') : '',
        lines);
    });
    place.replaceChildren(...(kept.length ? kept
      : [element('p', { className: 'empty' }, this.runs.length ? 'Nothing was kept: every run was rewritten.' : 'There was nothing to keep.')]));
  }
}
