// The tool path on its canvas: flat or in space, decimated by screen so that 200,000 points stay
// quick. Of points that share a pixel the one with the most to say decides the colour.

const VIEWS = {
  plan: { turn: 0, tilt: Math.PI / 2, axes: ['X', 'Y'] },
  front: { turn: 0, tilt: 0, axes: ['X', 'Z'] },
  side: { turn: Math.PI / 2, tilt: 0, axes: ['Y', 'Z'] },
  space: { turn: -0.6, tilt: 0.6, axes: null },
};
const LEVELS = 16;
const FINE = 0.6;    // px between points that are drawn
const COARSE = 2.5;  // px while the path moves under the hand
const LEAST_WIDTH = 4;  // px of the tolerance band from which its region is to be seen

class ToolPath {
  constructor(canvas, path, settings) {
    Object.assign(this, { canvas, path, settings });
    this.view = 'plan';
    this.turn = 0;
    this.tilt = Math.PI / 2;
    this.centre = [0, 0];
    this.scale = 1;  // px per mm
    this.u = new Float64Array(path.n);  // across and up in the view, mm
    this.v = new Float64Array(path.n);
    this.du = new Float32Array(path.n);
    this.dv = new Float32Array(path.n);
    this.regionU = new Float64Array(path.region.x.length);  // the same of its corners
    this.regionV = new Float64Array(path.region.x.length);
    this.segments = new Float32Array(4 * (path.n + 1));
    this.levels = new Uint8Array(path.n + 1);
    this.next = new Int32Array(path.n + 1);
    this.fitted = [0, path.n - 1];  // vertices that fill the picture; null: moved by hand
    this.marked = null;  // {vertex, share} under the mouse or on the charts
    this.chosen = null;  // [first, last] vertex of a run
    this.asked = 0;
    this.box = this.boxOf(0, path.n - 1);
    this.middle = this.box.map(([low, high]) => (low + high) / 2);
    this.project();
  }

  boxOf(first, last) {
    const { x, y, z } = this.path;
    return [x, y, z].map((axis) => {
      let low = Infinity;
      let high = -Infinity;
      for (let i = first; i <= last; i++) {
        if (this.path.step[i] === STEP.rapid && !this.settings.rapids) continue;
        low = Math.min(low, axis[i]);
        high = Math.max(high, axis[i]);
      }
      return low <= high ? [low, high] : [0, 0];
    });
  }

  project() {
    const { x, y, z, dx, dy, dz, n } = this.path;
    const [mx, my, mz] = this.middle;
    const c = Math.cos(this.turn);
    const s = Math.sin(this.turn);
    const up = Math.cos(this.tilt);
    const away = Math.sin(this.tilt);
    for (let i = 0; i < n; i++) {
      const px = x[i] - mx;
      const py = y[i] - my;
      this.u[i] = c * px + s * py;
      this.v[i] = (-s * px + c * py) * away + (z[i] - mz) * up;
      this.du[i] = c * dx[i] + s * dy[i];
      this.dv[i] = (-s * dx[i] + c * dy[i]) * away + dz[i] * up;
    }
    const { region } = this.path;
    for (let i = 0; i < region.x.length; i++) {
      const px = region.x[i] - mx;
      const py = region.y[i] - my;
      this.regionU[i] = c * px + s * py;
      this.regionV[i] = (-s * px + c * py) * away + (region.z[i] - mz) * up;
    }
  }

  show(view) {
    this.view = view;
    this.turn = VIEWS[view].turn;
    this.tilt = VIEWS[view].tilt;
    this.project();
    this.fit();
  }

  rotate(turn, tilt) {
    if (this.view !== 'space') return;
    this.turn += turn;
    this.tilt = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.tilt + tilt));
    this.project();
    this.draw(true);
  }

  // Shows these vertices with some room around them.
  fit(first = 0, last = this.path.n - 1) {
    const { width, height } = this.canvas.getBoundingClientRect();
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = first; i <= last; i++) {
      if (this.path.step[i] === STEP.rapid && !this.settings.rapids) continue;
      left = Math.min(left, this.u[i]);
      right = Math.max(right, this.u[i]);
      low = Math.min(low, this.v[i]);
      high = Math.max(high, this.v[i]);
    }
    if (left > right) [left, right, low, high] = [-1, 1, -1, 1];
    this.centre = [(left + right) / 2, (low + high) / 2];
    this.scale = Math.min((width - 70) / Math.max(right - left, 1e-3), (height - 70) / Math.max(high - low, 1e-3));
    this.scale = Math.max(1e-3, this.scale);
    this.fitted = [first, last];
    this.draw();
  }

  // Into a canvas of another size: what was fitted is fitted again, what was looked at closer keeps
  // its middle and fills the same part of the width.
  resize() {
    const { width } = this.canvas.getBoundingClientRect();
    if (this.fitted) this.fit(...this.fitted);
    else if (this.width > 0) this.scale *= width / this.width;
    this.draw();
  }

  goTo(vertex, widthMm) {
    this.fitted = null;
    const { width } = this.canvas.getBoundingClientRect();
    this.centre = [this.u[vertex], this.v[vertex]];
    this.scale = width / widthMm;
    this.marked = { vertex, share: 1 };
    this.draw();
  }

  move(pxRight, pxDown) {
    this.fitted = null;
    this.centre[0] -= pxRight / this.scale;
    this.centre[1] += pxDown / this.scale;
    this.draw(true);
  }

  // The place under (px, py) stays where it is.
  zoom(factor, px, py) {
    this.fitted = null;
    const { width, height } = this.canvas.getBoundingClientRect();
    const right = (px ?? width / 2) - width / 2;
    const down = (py ?? height / 2) - height / 2;
    const scale = Math.min(1e6, Math.max(1e-3, this.scale * factor));
    this.centre[0] += right / this.scale - right / scale;
    this.centre[1] -= down / this.scale - down / scale;
    this.scale = scale;
    this.draw(true);
  }

  // Soon, and again in full when nothing has changed for a while.
  draw(moving = false) {
    this.moving = moving;
    if (!this.asked) this.asked = requestAnimationFrame(() => { this.asked = 0; this.drawNow(); });
    clearTimeout(this.settle);
    if (moving) this.settle = setTimeout(() => this.draw(), 160);
  }

  // --- one picture ------------------------------------------------------------------------------

  drawNow() {
    const sharp = sharpContext(this.canvas);
    this.context = sharp.context;
    this.width = sharp.width;
    this.height = sharp.height;
    this.colours = themeColours();
    this.fine = this.moving && this.path.n > 20000 ? COARSE : FINE;
    if (this.settings.region && !this.whyNoRegion()) this.drawRegion();
    if (this.settings.rapids) this.drawRapids();
    if (this.settings.old) this.drawOld();
    if (this.settings.now) this.drawNew();
    if (this.chosen) this.drawChosen();
    this.drawScaleBar();
    this.drawAxes();
    if (this.marked) this.drawMark();
    this.onDrawn?.();
  }

  screen(u, v) {
    return [this.width / 2 + (u - this.centre[0]) * this.scale, this.height / 2 - (v - this.centre[1]) * this.scale];
  }

  // Calls line(x0, y0, x1, y1, most) for what can be seen of the vertices from..to whose step is
  // wanted. `most`: the greatest value(i) of the points that the line stands for.
  walk({ from = 0, to = this.path.n - 1, wanted, magnify = 0, value = null, fine = this.fine }, line) {
    const { step } = this.path;
    const { scale } = this;
    const ox = this.width / 2 - this.centre[0] * scale;
    const oy = this.height / 2 + this.centre[1] * scale;
    const place = (i) => [ox + (this.u[i] + magnify * this.du[i]) * scale, oy - (this.v[i] + magnify * this.dv[i]) * scale];
    let x0 = 0;
    let y0 = 0;
    let most = 0;
    let last = -2;
    for (let i = Math.max(1, from); i <= to; i++) {
      if (!wanted[step[i]]) continue;
      if (last !== i - 1) {
        [x0, y0] = place(i - 1);
        most = value ? value(i - 1) : 0;
      }
      last = i;
      const x1 = ox + (this.u[i] + magnify * this.du[i]) * scale;
      const y1 = oy - (this.v[i] + magnify * this.dv[i]) * scale;
      if (value) most = Math.max(most, value(i));
      const goesOn = i < to && wanted[step[i + 1]];
      if (goesOn && Math.abs(x1 - x0) + Math.abs(y1 - y0) < fine) continue;
      const outside = (x0 < 0 && x1 < 0) || (y0 < 0 && y1 < 0) ||
        (x0 > this.width && x1 > this.width) || (y0 > this.height && y1 > this.height);
      if (!outside) line(x0, y0, x1, y1, most);
      x0 = x1;
      y0 = y1;
      most = value ? value(i) : 0;
    }
  }

  stroke(options, style, lineWidth, dash = []) {
    const { context } = this;
    context.beginPath();
    let [ex, ey] = [NaN, NaN];
    this.walk(options, (x0, y0, x1, y1) => {
      if (x0 !== ex || y0 !== ey) context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      [ex, ey] = [x1, y1];
    });
    context.strokeStyle = style;
    context.lineWidth = lineWidth;
    context.setLineDash(dash);
    context.lineJoin = 'round';
    context.stroke();
    context.setLineDash([]);
  }

  // The region has its true width, so it says nothing beside a deviation that is drawn larger.
  whyNoRegion() {
    if (this.settings.magnify > 1.05) return 'only beside a deviation that is drawn as it is';
    if (2 * this.settings.tolerance * this.scale < LEAST_WIDTH) return 'zoom in to see it';
    return '';
  }

  // Of regions that lie over each other, such as those before and after a change of feed, the holes
  // are what is in none of them: outer polygons turn to the one side, holes to the other.
  drawRegion() {
    const { context, path: { region } } = this;
    context.beginPath();
    let end = 0;
    for (const size of region.sizes) {
      const start = end;
      end += size;
      if (!this.isSeen(start, end)) continue;
      let [x0, y0] = this.screen(this.regionU[start], this.regionV[start]);
      context.moveTo(x0, y0);
      for (let i = start + 1; i < end; i++) {
        const [x, y] = this.screen(this.regionU[i], this.regionV[i]);
        if (Math.abs(x - x0) + Math.abs(y - y0) < this.fine) continue;
        context.lineTo(x, y);
        [x0, y0] = [x, y];
      }
      context.closePath();
    }
    context.fillStyle = this.colours.region;
    context.fill('nonzero');
    context.strokeStyle = this.colours['region-edge'];
    context.lineWidth = 1;
    context.stroke();
  }

  // Whether the box of these corners of the region meets the picture.
  isSeen(start, end) {
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = start; i < end; i++) {
      left = Math.min(left, this.regionU[i]);
      right = Math.max(right, this.regionU[i]);
      low = Math.min(low, this.regionV[i]);
      high = Math.max(high, this.regionV[i]);
    }
    const [x0, y0] = this.screen(left, high);
    const [x1, y1] = this.screen(right, low);
    return x1 >= 0 && y1 >= 0 && x0 <= this.width && y0 <= this.height;
  }

  drawRapids() {
    this.stroke({ wanted: [false, true, false, false] }, this.colours.rapid, 1, [4, 4]);
  }

  drawOld() {
    this.stroke({ wanted: [false, false, !this.settings.now, true] }, this.colours.old, this.settings.now ? 1 : 1.4);
  }

  levelOf() {
    const { path, settings } = this;
    if (settings.colour === 'deviation') {
      const per = (LEVELS - 1) / settings.tolerance;
      return (i) => Math.min(LEVELS - 1, path.deviation[i] * per);
    }
    if (settings.colour === 'speed') {
      // Slow places are what one looks for: they win.
      const per = path.fastest > 0 ? (LEVELS - 1) / path.fastest : 0;
      return (i) => LEVELS - 1 - path.speedAfter[i] * per;
    }
    return (i) => (settings.isRewritten(i) ? 0 : 1);
  }

  colourOf(level) {
    if (this.settings.colour === 'status') return level ? this.colours.kept : this.colours.now;
    return scaleColour(level / (LEVELS - 1));
  }

  drawNew() {
    const { context, segments, levels, next } = this;
    const heads = new Int32Array(LEVELS).fill(-1);
    const tails = new Int32Array(LEVELS).fill(-1);
    let count = 0;
    const options = { wanted: [false, false, true, true], magnify: this.settings.magnify, value: this.levelOf() };
    this.walk(options, (x0, y0, x1, y1, most) => {
      const level = Math.round(most);
      segments.set([x0, y0, x1, y1], 4 * count);
      levels[count] = level;
      next[count] = -1;
      if (heads[level] < 0) heads[level] = count;
      else next[tails[level]] = count;
      tails[level] = count++;
    });
    context.lineWidth = this.settings.magnify > 1 ? 1.5 : 1.8;
    context.lineCap = 'round';
    for (let level = 0; level < LEVELS; level++) {
      if (heads[level] < 0) continue;
      context.beginPath();
      let [ex, ey] = [NaN, NaN];
      for (let k = heads[level]; k >= 0; k = next[k]) {
        if (segments[4 * k] !== ex || segments[4 * k + 1] !== ey) context.moveTo(segments[4 * k], segments[4 * k + 1]);
        ex = segments[4 * k + 2];
        ey = segments[4 * k + 3];
        context.lineTo(ex, ey);
      }
      context.strokeStyle = this.colourOf(level);
      context.stroke();
    }
    this.drawn = count;
  }

  drawChosen() {
    const [from, to] = this.chosen;
    this.context.globalAlpha = 0.28;
    this.stroke({ from, to, wanted: [false, false, true, true] }, this.colours.accent, 9);
    this.context.globalAlpha = 1;
  }

  // A place between the vertex before and this one.
  placeOf({ vertex, share }) {
    const before = this.path.step[vertex] === STEP.none ? vertex : Math.max(0, vertex - 1);
    const mix = (column) => column[before] + share * (column[vertex] - column[before]);
    return { u: mix(this.u), v: mix(this.v), du: mix(this.du), dv: mix(this.dv) };
  }

  drawMark() {
    const { context } = this;
    const { u, v, du, dv } = this.placeOf(this.marked);
    const magnify = this.settings.now ? this.settings.magnify : 0;
    const [x, y] = this.screen(u, v);
    const [nx, ny] = this.screen(u + magnify * du, v + magnify * dv);
    context.strokeStyle = this.colours.mark;
    context.lineWidth = 1.5;
    context.beginPath();
    context.arc(x, y, 6, 0, 2 * Math.PI);
    if (Math.hypot(nx - x, ny - y) > 8) {
      context.moveTo(x, y);
      context.lineTo(nx, ny);
      context.moveTo(nx + 3, ny);
      context.arc(nx, ny, 3, 0, 2 * Math.PI);
    }
    context.stroke();
  }

  drawScaleBar() {
    const { context, colours, height } = this;
    const step = roundStep(units.of(130 / this.scale));
    const px = step * (units.inch ? MM_PER_INCH : 1) * this.scale;
    context.strokeStyle = colours.soft;
    context.fillStyle = colours.soft;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(14.5, height - 18);
    context.lineTo(14.5, height - 12.5);
    context.lineTo(14.5 + px, height - 12.5);
    context.lineTo(14.5 + px, height - 18);
    context.stroke();
    context.font = '12px system-ui, sans-serif';
    context.textAlign = 'left';
    context.textBaseline = 'bottom';
    context.fillText(`${tickText(step, step)} ${units.length}`, 20, height - 15);
  }

  drawAxes() {
    const { context, colours } = this;
    const c = Math.cos(this.turn);
    const s = Math.sin(this.turn);
    const axes = [
      ['X', c, -s * Math.sin(this.tilt)],
      ['Y', s, c * Math.sin(this.tilt)],
      ['Z', 0, Math.cos(this.tilt)],
    ];
    const [x, y] = [34, this.height - 62];
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.lineWidth = 1.5;
    context.strokeStyle = colours.soft;
    context.fillStyle = colours.soft;
    for (const [name, right, up] of axes) {
      if (Math.hypot(right, up) < 0.05) continue;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 22 * right, y - 22 * up);
      context.stroke();
      context.fillText(name, x + 30 * right, y - 30 * up);
    }
  }

  // The place of the path that is nearest to a place on the screen, at most 40 px off.
  nearest(px, py) {
    const { step, n } = this.path;
    const { width, height } = this.canvas.getBoundingClientRect();
    const wu = (px - width / 2) / this.scale + this.centre[0];
    const wv = (height / 2 - py) / this.scale + this.centre[1];
    let least = (40 / this.scale) ** 2;
    let found = null;
    for (let i = 1; i < n; i++) {
      if (step[i] === STEP.none || (step[i] === STEP.rapid && !this.settings.rapids)) continue;
      const ax = this.u[i - 1];
      const ay = this.v[i - 1];
      const bx = this.u[i] - ax;
      const by = this.v[i] - ay;
      const square = bx * bx + by * by;
      let share = square > 0 ? ((wu - ax) * bx + (wv - ay) * by) / square : 1;
      share = share < 0 ? 0 : share > 1 ? 1 : share;
      const ex = ax + share * bx - wu;
      const ey = ay + share * by - wv;
      const distance = ex * ex + ey * ey;
      if (distance < least) {
        least = distance;
        found = { vertex: i, share };
      }
    }
    return found;
  }
}
