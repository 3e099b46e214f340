// Deviation, bend radius and predicted speed over the way along the cut. Where several points fall
// into one column of pixels, the least and the greatest of them are drawn.

const MARGIN = { left: 62, right: 14, top: 8, bottom: 8, axis: 24 };

class Charts {
  constructor(canvases, path, settings) {
    Object.assign(this, { canvases, path, settings });
    this.range = [0, path.length];
    this.marked = null;
    this.asked = 0;
    canvases.forEach((canvas) => this.listen(canvas));
  }

  show(from, to) {
    const all = this.path.length;
    const width = Math.min(all, Math.max(1e-3, to - from));
    from = Math.min(Math.max(0, from), all - width);
    this.range = [from, from + width];
    this.draw();
  }

  zoom(factor, at = (this.range[0] + this.range[1]) / 2) {
    const [from, to] = this.range;
    this.show(at - (at - from) / factor, at + (to - at) / factor);
  }

  draw() {
    if (!this.asked) this.asked = requestAnimationFrame(() => { this.asked = 0; this.drawNow(); });
  }

  listen(canvas) {
    let held = null;
    let dragged = false;
    const wayAt = (event) => {
      const box = canvas.getBoundingClientRect();
      const share = (event.clientX - box.left - MARGIN.left) / (box.width - MARGIN.left - MARGIN.right);
      return this.range[0] + Math.min(1, Math.max(0, share)) * (this.range[1] - this.range[0]);
    };
    canvas.addEventListener('pointerdown', (event) => {
      held = { x: event.clientX, range: this.range };
      dragged = false;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointerup', () => { held = null; });
    canvas.addEventListener('pointercancel', () => { held = null; });
    canvas.addEventListener('pointermove', (event) => {
      if (held && (dragged || Math.abs(event.clientX - held.x) > 3)) {
        dragged = true;
        const px = canvas.getBoundingClientRect().width - MARGIN.left - MARGIN.right;
        const by = (held.x - event.clientX) / px * (held.range[1] - held.range[0]);
        this.show(held.range[0] + by, held.range[1] + by);
      }
      this.onMark?.(this.placeAt(wayAt(event)));
    });
    canvas.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && Math.abs(event.deltaX) > Math.abs(event.deltaY)) return;
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.002), wayAt(event));
    }, { passive: false });
    canvas.addEventListener('dblclick', () => this.show(0, this.path.length));
    canvas.addEventListener('click', (event) => { if (!dragged) this.onPick?.(this.placeAt(wayAt(event))); });
    canvas.addEventListener('keydown', (event) => {
      const width = this.range[1] - this.range[0];
      const steps = { ArrowLeft: -0.2, ArrowRight: 0.2 };
      if (event.key in steps) this.show(this.range[0] + steps[event.key] * width, this.range[1] + steps[event.key] * width);
      else if (event.key === '+' || event.key === '=') this.zoom(1.5);
      else if (event.key === '-') this.zoom(1 / 1.5);
      else if (event.key === '0') this.show(0, this.path.length);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  // The first vertex at or behind a way, where a cutting move leads to it.
  firstAt(way) {
    let low = 0;
    let high = this.path.n;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.path.way[middle] < way) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  placeAt(way) {
    const { path } = this;
    let i = Math.min(path.n - 1, this.firstAt(way));
    while (i + 1 < path.n && path.step[i] < STEP.copied) i++;
    if (i < 1 || path.step[i] < STEP.copied) return null;
    const whole = path.way[i] - path.way[i - 1];
    return { vertex: i, share: whole > 0 ? Math.min(1, Math.max(0, (way - path.way[i - 1]) / whole)) : 1 };
  }

  drawNow() {
    if (!(this.path.length > 0)) return;
    const [deviation, radius, speed] = this.canvases;
    this.colours = themeColours();
    if (this.settings.compared) this.drawDeviation(deviation);
    this.drawRadius(radius);
    this.drawSpeed(speed);
  }

  begin(canvas, toShare, ticks, withAxis = false) {
    const { context, width, height } = sharpContext(canvas);
    const bottom = height - (withAxis ? MARGIN.axis : MARGIN.bottom);
    const [from, to] = this.range;
    const area = {
      context, width, height, bottom,
      left: MARGIN.left, right: width - MARGIN.right, top: MARGIN.top,
      x: (way) => MARGIN.left + (way - from) / (to - from) * (width - MARGIN.left - MARGIN.right),
      y: (value) => bottom - Math.min(1, Math.max(0, toShare(value))) * (bottom - MARGIN.top),
    };
    if (this.settings.compared) this.drawKept(area);
    context.font = '11.5px system-ui, sans-serif';
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    context.lineWidth = 1;
    for (const [value, text] of ticks) {
      const y = Math.round(area.y(value)) + 0.5;
      context.strokeStyle = this.colours.line;
      context.beginPath();
      context.moveTo(area.left, y);
      context.lineTo(area.right, y);
      context.stroke();
      context.fillStyle = this.colours.soft;
      context.fillText(text, area.left - 8, y);
    }
    this.drawWays(area, withAxis);
    return area;
  }

  // Where nothing was rewritten the ground is darker.
  drawKept({ context, x, top, bottom, left, right }) {
    const { path } = this;
    context.fillStyle = this.colours.fill;
    let start = null;
    const last = Math.min(path.n - 1, this.firstAt(this.range[1]) + 1);
    for (let i = Math.max(1, this.firstAt(this.range[0])); i <= last; i++) {
      const kept = path.step[i] !== STEP.rewritten;
      if (kept && start === null) start = path.way[i - 1];
      const ends = start !== null && (!kept || i === last);
      if (!ends) continue;
      const from = Math.max(left, x(start));
      const to = Math.min(right, x(path.way[kept ? i : i - 1]));
      if (to - from > 0.5) context.fillRect(from, top, to - from, bottom - top);
      start = null;
    }
  }

  drawWays({ context, x, top, bottom, left, right }, withText) {
    const [from, to] = this.range.map((mm) => units.of(mm));
    if (!(to > from)) return;
    const step = roundStep((to - from) / Math.max(2, (right - left) / 110));
    context.textAlign = 'center';
    context.textBaseline = 'top';
    for (let value = Math.ceil(from / step) * step; value <= to * (1 + 1e-12); value += step) {
      const px = Math.round(x(value * (units.inch ? MM_PER_INCH : 1))) + 0.5;
      context.strokeStyle = this.colours.line;
      context.beginPath();
      context.moveTo(px, top);
      context.lineTo(px, bottom);
      context.stroke();
      context.fillStyle = this.colours.soft;
      if (withText) context.fillText(tickText(value, step), px, bottom + 6);
    }
    if (withText) {
      context.textAlign = 'right';
      context.fillText(units.length, left - 8, bottom + 6);
    }
  }

  // One line over the way; `fill`: down to the ground.
  plot(area, value, style, { lineWidth = 1.4, dash = [], fill = null } = {}) {
    const { path } = this;
    const { context, x, y, left, right, top, bottom } = area;
    const first = Math.max(0, this.firstAt(this.range[0]) - 1);
    const last = Math.min(path.n - 1, this.firstAt(this.range[1]) + 1);
    context.save();
    context.beginPath();
    context.rect(left, top - 2, right - left, bottom - top + 4);
    context.clip();
    context.beginPath();
    if (last - first > 3 * (right - left)) this.traceColumns(area, value, first, last);
    else this.trace(area, value, first, last);
    context.strokeStyle = style;
    context.lineWidth = lineWidth;
    context.lineJoin = 'round';
    context.setLineDash(dash);
    context.stroke();
    if (fill) {
      context.lineTo(Math.min(right, x(path.way[last])), bottom);
      context.lineTo(Math.max(left, x(path.way[first])), bottom);
      context.fillStyle = fill;
      context.globalAlpha = 0.22;
      context.fill();
    }
    context.restore();
  }

  trace({ context, x, y }, value, first, last) {
    let open = false;
    for (let i = first; i <= last; i++) {
      const leads = this.path.step[i] >= STEP.copied;
      if (!leads && this.path.step[i] !== STEP.none) continue;
      if (open && leads) context.lineTo(x(this.path.way[i]), y(value(i)));
      else context[open ? 'lineTo' : 'moveTo'](x(this.path.way[i]), y(value(i)));
      open = true;
    }
  }

  traceColumns({ context, x, y }, value, first, last) {
    let column = null;
    let low = 0;
    let high = 0;
    let open = false;
    const flush = () => {
      if (column === null) return;
      context[open ? 'lineTo' : 'moveTo'](column, y(low));
      context.lineTo(column, y(high));
      open = true;
    };
    for (let i = first; i <= last; i++) {
      if (this.path.step[i] < STEP.copied) continue;
      const at = Math.round(x(this.path.way[i]));
      const v = value(i);
      if (at !== column) {
        flush();
        column = at;
        low = high = v;
      } else {
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
    }
    flush();
  }

  drawMark(area, values) {
    if (!this.marked) return;
    const { vertex, share } = this.marked;
    const { way } = this.path;
    const at = way[vertex - 1] + share * (way[vertex] - way[vertex - 1]);
    if (at < this.range[0] || at > this.range[1]) return;
    const { context } = area;
    const px = area.x(at);
    context.strokeStyle = this.colours.soft;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(px, area.top);
    context.lineTo(px, area.bottom);
    context.stroke();
    for (const [column, style] of values) {
      const mixed = column[vertex - 1] + share * (column[vertex] - column[vertex - 1]);
      context.fillStyle = style;
      context.beginPath();
      context.arc(px, area.y(mixed), 3.5, 0, 2 * Math.PI);
      context.fill();
    }
  }

  drawDeviation(canvas) {
    const { path, settings, colours } = this;
    const allowed = settings.tolerance;
    const most = Math.max(allowed, path.worst >= 0 ? path.deviation[path.worst] : 0) * 1.15;
    const step = roundStep(units.of(most) / 2.5);
    const ticks = [];
    for (let v = 0; v <= units.of(most); v += step) ticks.push([v * (units.inch ? MM_PER_INCH : 1), tickText(v, step)]);
    const area = this.begin(canvas, (v) => v / most, ticks);
    this.plot(area, (i) => path.deviation[i], colours.now, { lineWidth: 1.3 });
    const { context } = area;
    context.strokeStyle = colours.bad;
    context.setLineDash([6, 4]);
    context.beginPath();
    context.moveTo(area.left, area.y(allowed));
    context.lineTo(area.right, area.y(allowed));
    context.stroke();
    context.setLineDash([]);
    context.fillStyle = colours.bad;
    context.textAlign = 'right';
    context.textBaseline = 'bottom';
    context.fillText('allowed', area.right - 4, area.y(allowed) - 2);
    this.drawMark(area, [[path.deviation, colours.now]]);
  }

  drawRadius(canvas) {
    const { path, settings, colours } = this;
    let most = 0.1;
    for (let i = 0; i < path.n; i++) most = Math.max(most, path.bendBefore[i], path.bendAfter[i]);
    const unit = units.inch ? MM_PER_INCH : 1;
    // In doublings of the curvature; a radius of 1000 lies on the ground.
    const low = Math.log(1 / (1000 * unit));
    const high = Math.log(most * 1.5);
    const ticks = [[1 / (1000 * unit), 'straight']];
    for (let radius = 100; radius > 1e-4; radius /= 10) {
      if (Math.log(1 / (radius * unit)) < high) ticks.push([1 / (radius * unit), `R ${tickText(radius, radius)}`]);
    }
    const area = this.begin(canvas, (k) => (Math.log(Math.max(k, 1e-9)) - low) / (high - low), ticks);
    if (settings.compared) this.plot(area, (i) => path.bendBefore[i], colours.old, { lineWidth: 1.1 });
    this.plot(area, (i) => path.bendAfter[i], colours.now);
    this.drawMark(area, [[path.bendBefore, colours.old], [path.bendAfter, colours.now]]);
  }

  drawSpeed(canvas) {
    const { path, settings, colours } = this;
    let feed = 0;
    for (let i = 0; i < path.n; i++) feed = Math.max(feed, path.feed[i]);
    const most = (path.fastest > 0 ? Math.max(path.fastest, Math.min(feed, 2 * path.fastest)) : Math.max(feed, 1e-9)) * 1.1;
    const step = roundStep(units.of(most) / 2.5);
    const ticks = [];
    for (let v = 0; v <= units.of(most); v += step) ticks.push([v * (units.inch ? MM_PER_INCH : 1), tickText(v, step)]);
    const area = this.begin(canvas, (v) => v / most, ticks, true);
    if (feed > 0) this.plot(area, (i) => path.feed[i], colours.soft, { lineWidth: 1, dash: [2, 4] });
    if (!(path.fastest > 0)) return;
    if (settings.compared) this.plot(area, (i) => path.speedBefore[i], colours.old, { lineWidth: 1.1 });
    this.plot(area, (i) => path.speedAfter[i], colours.now);
    this.drawMark(area, [[path.speedBefore, colours.old], [path.speedAfter, colours.now]]);
  }
}
