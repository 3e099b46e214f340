// The rows of the table: as two bars of time, as a table, and the kept ones by reason.

const RUNS_AT_ONCE = 50;
const LINES_AT_ONCE = 24;

class Runs {
  constructor(page, parts) {
    Object.assign(this, { page, ...parts });
    this.runs = page.rows;
    this.filter = 'all';
    this.sort = null;  // what matters first
    this.unfolded = false;
    this.shown = RUNS_AT_ONCE;
    this.chosen = -1;
    this.drawHead();
  }

  choose(index, scroll = false) {
    this.chosen = index;
    if (index >= 0 && isUsual(this.runs[index])) this.unfolded = true;
    if (scroll) {
      const at = this.listed().indexOf(index);
      if (at >= this.shown) this.shown = at + RUNS_AT_ONCE;
    }
    this.draw();
    if (scroll) this.body.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: 'nearest' });
  }

  wanted(r) {
    return this.filter === 'all' || r.status === this.filter;
  }

  listed() {
    const key = this.sort ? this.page.columns[this.sort.column][1] : this.page.interest;
    const down = this.sort ? this.sort.down : true;
    const indices = this.runs.map((_, i) => i)
      .filter((i) => this.wanted(this.runs[i]) && (this.unfolded || !isUsual(this.runs[i])));
    return indices.sort((a, b) => {
      const [x, y] = [key(this.runs[a]), key(this.runs[b])];
      return (x < y ? -1 : x > y ? 1 : 0) * (down ? -1 : 1) || a - b;
    });
  }

  // Up, down, and what matters first again.
  sortBy(column) {
    const first = column >= 2;
    if (this.sort?.column !== column) this.sort = { column, down: first };
    else this.sort = this.sort.down === first ? { column, down: !first } : null;
    this.drawHead();
    this.draw();
    this.head.children[column].querySelector('button').focus();
  }

  drawHead() {
    this.head.replaceChildren(...this.page.columns.map(([title, , kind], column) => {
      const button = element('button', { type: 'button', title: 'Sort' }, title);
      button.addEventListener('click', () => this.sortBy(column));
      const cell = element('th', { className: kind, scope: 'col' }, button);
      if (this.sort?.column === column) {
        cell.setAttribute('aria-sort', this.sort.down ? 'descending' : 'ascending');
        button.append(this.sort.down ? ' \u2193' : ' \u2191');
      }
      return cell;
    }));
  }

  row(index) {
    const r = this.runs[index];
    const row = element('tr', { tabIndex: 0 }, ...this.page.columns.map(([, , className, cell]) =>
      element('td', { className }, ...[cell(r)].flat())));
    row.setAttribute('aria-selected', String(index === this.chosen));
    row.dataset.run = index;
    return row;
  }

  // Plunges and the like, in one row.
  foldedRow(folded) {
    const reasons = new Map();
    for (const r of folded) reasons.set(r.reason, (reasons.get(r.reason) ?? 0) + 1);
    const each = [...reasons].map(([reason, n]) => `${thousands(n)} ${reason}`).join(', ');
    const button = element('button', { type: 'button', id: 'unfold' }, 'Show them');
    button.addEventListener('click', () => { this.unfolded = true; this.draw(); });
    return element('tr', { className: 'folded' },
      element('td', { colSpan: this.page.columns.length }, `Kept by their nature: ${each} `, button));
  }

  draw() {
    const listed = this.listed();
    const folded = this.unfolded ? [] : this.runs.filter((r) => this.wanted(r) && isUsual(r));
    this.body.replaceChildren(...listed.slice(0, this.shown).map((i) => this.row(i)), ...(folded.length ? [this.foldedRow(folded)] : []));
    const left = listed.length - this.shown;
    this.more.hidden = left <= 0;
    this.more.textContent = `Show ${thousands(Math.min(left, RUNS_AT_ONCE))} more of ${thousands(listed.length)}`;
    this.empty.hidden = listed.length + folded.length > 0;
    this.empty.textContent = this.runs.length ? 'No such runs.' : 'There is nothing to list.';
    this.drawStrip();
  }

  // Two bars, before above and after below, each as long as the time and in the order of the program.
  drawStrip() {
    const total = this.runs.reduce((sum, r) => sum + (r.time_before_s ?? 0), 0);
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

  // Reasons, each with what to do and the places; those that are usual last.
  drawReasons(place, onLines) {
    const usual = (reason) => isUsual({ status: 'kept', reason: reason.id });
    const reasons = [...this.page.reasons].sort((a, b) => usual(a) - usual(b));
    place.replaceChildren(...(reasons.length ? reasons.map((reason) => this.reason(reason, onLines))
      : [element('p', { className: 'empty' }, this.runs.length ? 'Nothing was kept: every run was rewritten.' : 'There was nothing to keep.')]));
  }

  reason(reason, onLines) {
    const runs = this.runs.map((_, i) => i).filter((i) => this.runs[i].status === 'kept' && this.runs[i].reason === reason.id);
    const advice = !reason.advice || /^Nothing\b/.test(reason.advice) ? '' : reason.advice;
    const where = element('details', { className: 'where' }, element('summary', {}, count(runs.length, 'place', 'places')));
    where.addEventListener('toggle', () => { if (where.open && !where.querySelector('.lines')) where.append(this.lineButtons(runs, onLines)); });
    return element('article', { className: 'reason' },
      element('span', { className: 'count' }, `${count(reason.runs, 'run', 'runs')}, ${count(reason.blocks, 'block', 'blocks')}`),
      element('h3', {}, reason.text || reason.id, element('code', {}, reason.id)),
      advice ? element('p', {}, advice) : '',
      reason.can_be_allowed ? element('p', {}, element('code', {}, `--allow ${reason.id}`), ' lifts this rule.') : '',
      runs.length ? where : '');
  }

  lineButtons(runs, onLines) {
    const place = element('div', { className: 'lines' });
    const add = (from, to) => runs.slice(from, to).forEach((i) => {
      const button = element('button', { type: 'button', title: 'Show this place' }, lines(this.runs[i]));
      button.addEventListener('click', () => onLines(i));
      place.append(button);
    });
    add(0, LINES_AT_ONCE);
    if (runs.length > LINES_AT_ONCE) {
      const all = element('button', { type: 'button' }, `${thousands(runs.length - LINES_AT_ONCE)} more`);
      all.addEventListener('click', () => { all.remove(); add(LINES_AT_ONCE, runs.length); });
      place.append(all);
    }
    return place;
  }
}
