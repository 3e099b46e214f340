'use strict';
// The data of the page: columns of numbers as postproc/report/page_path.h writes them.

function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

// Numbers may be as great as 2^53, so no bit operations on the whole.
function unpacked(text) {
  const bytes = bytesOf(text);
  const numbers = new Float64Array(bytes.length);  // a number has a byte at least
  let count = 0;
  for (let i = 0; i < bytes.length; count++) {
    let byte = bytes[i++];
    let value = byte & 127;
    for (let scale = 128; byte & 128; scale *= 128) {
      byte = bytes[i++];
      value += (byte & 127) * scale;
    }
    numbers[count] = value % 2 ? -(value + 1) / 2 : value / 2;
  }
  return numbers.subarray(0, count);
}

// In place.
function summed(numbers) {
  for (let i = 1; i < numbers.length; i++) numbers[i] += numbers[i - 1];
  return numbers;
}

function unpackedRuns(text, count) {
  const runs = unpacked(text);
  const numbers = new Float64Array(count);
  let at = 0;
  for (let i = 0; i + 1 < runs.length; i += 2) {
    numbers.fill(runs[i], at, at + runs[i + 1]);
    at += runs[i + 1];
  }
  return numbers;
}

const STEP = { none: 0, rapid: 1, copied: 2, rewritten: 3 };

// Typed columns, and what follows from them: the deviation of each vertex (mm) and its way along
// the cut (mm; rapids do not count).
function readPath(columns) {
  const n = columns.count;
  const scaled = (numbers, unit) => {
    for (let i = 0; i < numbers.length; i++) numbers[i] *= unit;
    return numbers;
  };
  const curvature = (text) => {
    const steps = summed(unpacked(text));
    for (let i = 0; i < steps.length; i++) {
      steps[i] = steps[i] === 0 ? 0 : columns.curvature_least * 2 ** (steps[i] / columns.curvature_steps);
    }
    return steps;
  };
  const path = {
    n,
    x: scaled(summed(unpacked(columns.x)), columns.unit_mm),
    y: scaled(summed(unpacked(columns.y)), columns.unit_mm),
    z: scaled(summed(unpacked(columns.z)), columns.unit_mm),
    dx: new Float32Array(n), dy: new Float32Array(n), dz: new Float32Array(n),
    deviation: new Float32Array(n),
    step: new Uint8Array(unpackedRuns(columns.step, n)),
    oldLine: new Uint32Array(summed(unpackedRuns(columns.old_line, n))),
    newLine: new Uint32Array(summed(unpackedRuns(columns.new_line, n))),
    run: new Int32Array(unpackedRuns(columns.run, n)),
    feed: scaled(unpackedRuns(columns.feed, n), columns.feed_unit),
    bendBefore: curvature(columns.curvature_before),
    bendAfter: curvature(columns.curvature_after),
    speedBefore: scaled(summed(unpacked(columns.speed_before)), columns.speed_unit),
    speedAfter: scaled(summed(unpacked(columns.speed_after)), columns.speed_unit),
    way: new Float64Array(n),
    length: 0, worst: -1, fastest: 0, region: readRegion(columns),
  };
  const has = unpackedRuns(columns.has_offset, n);
  const offsets = [columns.dx, columns.dy, columns.dz].map(unpacked);
  for (let i = 0, k = 0; i < n; i++) {
    if (has[i]) {
      path.dx[i] = offsets[0][k] * columns.unit_mm;
      path.dy[i] = offsets[1][k] * columns.unit_mm;
      path.dz[i] = offsets[2][k] * columns.unit_mm;
      k++;
    }
    path.deviation[i] = Math.sqrt(path.dx[i] ** 2 + path.dy[i] ** 2 + path.dz[i] ** 2);
    if (path.worst < 0 || path.deviation[i] > path.deviation[path.worst]) path.worst = i;
    path.fastest = Math.max(path.fastest, path.speedBefore[i], path.speedAfter[i]);
    if (path.step[i] >= STEP.copied) {
      path.length += Math.sqrt((path.x[i] - path.x[i - 1]) ** 2 + (path.y[i] - path.y[i - 1]) ** 2 + (path.z[i] - path.z[i - 1]) ** 2);
    }
    path.way[i] = path.length;
  }
  return path;
}

// The polygons of the region of the tolerance: corners one after the other, and how many each has.
function readRegion({ region, unit_mm: unit }) {
  const place = (text) => summed(unpacked(text)).map((steps) => steps * unit);
  return {
    drawn: region.drawn, inSpace: region.in_space, leftOut: region.left_out, mostEdges: region.most_edges,
    sizes: unpacked(region.sizes), x: place(region.x), y: place(region.y), z: place(region.z),
  };
}

// The first and the last vertex of each run, in the order of the report.
function verticesOfRuns(path, count) {
  const ranges = Array.from({ length: count }, () => null);
  for (let i = 0; i < path.n; i++) {
    const run = path.run[i];
    if (run < 0 || path.step[i] === STEP.rapid) continue;
    if (ranges[run]) ranges[run][1] = i;
    else ranges[run] = [Math.max(0, path.step[i] === STEP.none ? i : i - 1), i];
  }
  return ranges;
}

// Whether much of the cut goes up and down: such a path says little from above.
function isInSpace(path) {
  let sloped = 0;
  for (let i = 1; i < path.n; i++) {
    const rise = Math.abs(path.z[i] - path.z[i - 1]);
    const way = path.way[i] - path.way[i - 1];
    if (path.step[i] >= STEP.copied && rise > 0.02 * way && rise < 0.98 * way) sloped += way;
  }
  return sloped > 0.4 * path.length;
}
