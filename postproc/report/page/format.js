// Numbers as a machinist reads them, in millimetres or inches.

const MM_PER_INCH = 25.4;

const units = {
  inch: false,
  get length() { return this.inch ? 'in' : 'mm'; },
  get feed() { return this.inch ? 'in/min' : 'mm/min'; },
  of(mm) { return this.inch ? mm / MM_PER_INCH : mm; },
};

const thousands = (n) => n.toLocaleString('en-US').replace(/,/g, '\u202f');

function lengthDigits(mm, digits = 4) {
  return units.of(mm).toFixed(units.inch ? digits + 1 : digits);
}

function lengthText(mm, digits = 4) {
  return `${lengthDigits(mm, digits)}\u00a0${units.length}`;
}

function feedText(mmPerMin) {
  const value = units.of(mmPerMin);
  return `${value < 100 ? value.toFixed(1) : thousands(Math.round(value))}\u00a0${units.feed}`;
}

// Of a curvature in 1/mm.
function radiusText(curvature) {
  if (!(curvature > 1e-4)) return 'straight';
  const radius = units.of(1 / curvature);
  return `R\u00a0${radius < 0.1 ? radius.toFixed(3) : radius < 10 ? radius.toFixed(2) : radius.toFixed(radius < 100 ? 1 : 0)}\u00a0${units.length}`;
}

function timeText(seconds) {
  if (seconds < 120) return `${seconds.toFixed(2)}\u00a0s`;
  const whole = Math.round(seconds);
  const two = (n) => String(n).padStart(2, '0');
  if (whole < 3600) return `${Math.floor(whole / 60)}\u00a0min\u00a0${two(whole % 60)}\u00a0s`;
  return `${Math.floor(whole / 3600)}\u00a0h\u00a0${two(Math.floor(whole % 3600 / 60))}\u00a0min`;
}

// How much less or more: "-34.2 %"; empty where it is not worth a word.
function changeText(before, after, digits = 0) {
  if (!(before > 0)) return '';
  const percent = 100 * (after / before - 1);
  const text = Math.abs(percent).toFixed(digits);
  if (Number(text) === 0) return '';
  return `${percent < 0 ? '\u2212' : '+'}${text}\u00a0%`;
}

function linesText(first, last) {
  return first === last ? String(first) : `${first}\u2013${last}`;
}

// A round number of 1, 2 or 5 that is at most `most`.
function roundStep(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  for (const digit of [5, 2, 1]) if (digit * power <= most) return digit * power;
  return power;
}

// Without trailing zeros, and as many digits as steps of `step` need.
function tickText(value, step) {
  const digits = Math.max(0, Math.min(8, -Math.floor(Math.log10(step) + 1e-9)));
  return value.toFixed(digits);
}

// element('p', {className: 'note'}, 'text', child ..)
function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const byId = (id) => document.getElementById(id);

// A canvas as sharp as the screen. Returns its context and its size in CSS pixels.
function sharpContext(canvas) {
  const ratio = Math.min(3, window.devicePixelRatio || 1);
  const { width, height } = canvas.getBoundingClientRect();
  const w = Math.max(1, Math.round(width * ratio));
  const h = Math.max(1, Math.round(height * ratio));
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// The colours of the theme, read once per drawing.
function themeColours() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const names = ['card', 'ink', 'soft', 'line', 'fill', 'accent', 'old', 'now', 'kept', 'rapid', 'mark', 'bad', 'region', 'region-edge'];
  return Object.fromEntries(names.map((name) => [name, colour(name)]));
}

const isDark = () => document.documentElement.dataset.theme === 'dark';

// From little to much; each differs from its neighbours in lightness too, for eyes that see less
// colour and for paper.
function scaleStops() {
  return isDark()
    ? [[58, 84, 112], [58, 132, 196], [84, 190, 186], [240, 200, 92], [255, 122, 92]]
    : [[168, 190, 212], [74, 144, 206], [40, 110, 150], [190, 110, 20], [176, 24, 40]];
}

function scaleColour(share) {
  const stops = scaleStops();
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const k = Math.min(stops.length - 2, Math.floor(at));
  const mixed = stops[k].map((value, i) => Math.round(value + (at - k) * (stops[k + 1][i] - value)));
  return `rgb(${mixed.join(',')})`;
}
