#!/usr/bin/env python3
"""Draws a program before and after it is smoothed, its predicted speed as colour.

    samples/speed_picture.py BATTEN PROGRAM OUT.svg OPTION ..

The options are those of `batten smooth`; --machine is needed, since the speed is its. The picture of
the README:

    samples/speed_picture.py build/release/batten samples/butterfly/program.ngc \\
      docs/pictures/before_after.svg --target linuxcnc --machine mill

Speeds are what `batten time --profile` says for each millisecond. The picture is seen from above.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

WIDTH, HEIGHT, MARGIN, HEAD, FOOT = 460, 380, 14, 52, 46
EVERY = 4  # ms between places that are drawn
LEVELS = 16
# From slow to fast; each is lighter or darker than its neighbours, for eyes that see less colour.
STOPS = ((176, 24, 40), (214, 120, 30), (60, 140, 160), (40, 110, 190), (150, 180, 215))


def colour(share):
    at = min(1.0, max(0.0, share)) * (len(STOPS) - 1)
    k = min(len(STOPS) - 2, int(at))
    mixed = (round(a + (at - k) * (b - a)) for a, b in zip(STOPS[k], STOPS[k + 1]))
    return "#%02x%02x%02x" % tuple(mixed)


def run(*words):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\n{result.stderr}")


def speeds(batten, program, machine, folder):
    """[(x, y, mm/min)], the tool's places while it cuts, and breaks (None) where it does not."""
    profile, figures = folder / "profile.csv", folder / "time.json"
    run(batten, "time", program, "--machine", machine, "--profile", profile, "--json", figures, "--force", "--quiet")
    rapids = rapid_lines(program)
    places = []
    with open(profile, newline="") as file:
        for i, row in enumerate(csv.DictReader(file)):
            if int(row["line"]) in rapids:
                if places and places[-1] is not None:
                    places.append(None)
            elif i % EVERY == 0:
                places.append((float(row["x_mm"]), float(row["y_mm"]), float(row["feed_mm_per_min"])))
    return places, json.loads(figures.read_text())


def rapid_lines(program):
    """Lines that rapids, M and plunges are on: all that changes Z or is no cutting move in the plane."""
    lines, motion = set(), "G0"
    for number, text in enumerate(Path(program).read_text().splitlines(), 1):
        words = text.split("(")[0].split()
        for word in words:
            if word in ("G0", "G1", "G2", "G3"):
                motion = word
        if motion == "G0" or any(word[0] in "ZM" for word in words):
            lines.add(number)
    return lines


def drawn(places, to_picture, fastest):
    """Polylines, one for each stretch of one colour."""
    parts, line, level = [], [], None
    for before, now in zip(places, places[1:]):
        if before is None or now is None:
            line, level = [], None
            continue
        share = round((before[2] + now[2]) / 2 / fastest * (LEVELS - 1))
        if share != level:
            line = [to_picture(before)]
            parts.append((share, line))
            level = share
        line.append(to_picture(now))
    return "\n".join(
        f'<polyline stroke="{colour(share / (LEVELS - 1))}" points="{" ".join(points)}"/>' for share, points in parts)


def seconds(time):
    return f"{time:.2f} s" if time < 120 else f"{time / 60:.1f} min"


def main(batten, program, out, *options):
    machine = options[options.index("--machine") + 1]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        new = folder / "new.ngc"
        run(batten, "smooth", program, "-o", new, "--json", folder / "smooth.json", "--quiet", *options)
        report = json.loads((folder / "smooth.json").read_text())
        sides = [speeds(batten, file, machine, folder) for file in (program, new)]
    cuts = [place for places, _ in sides for place in places if place]
    low = [min(place[axis] for place in cuts) for axis in (0, 1)]
    high = [max(place[axis] for place in cuts) for axis in (0, 1)]
    fastest = max(place[2] for place in cuts)
    scale = min((WIDTH - 2 * MARGIN) / (high[0] - low[0]), (HEIGHT - 2 * MARGIN) / (high[1] - low[1]))
    text = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * WIDTH} {HEAD + HEIGHT + FOOT}" '
            'font-family="sans-serif" font-size="15" fill="#18202b">',
            f'<rect width="{2 * WIDTH}" height="{HEAD + HEIGHT + FOOT}" rx="10" fill="#ffffff"/>']
    for side, (places, _) in enumerate(sides):
        when = ("before", "after")[side]
        blocks = report[("input", "output")[side]]["blocks"]
        head = f"{when}: {seconds(report[f'time_{when}_s'])}, {blocks} blocks"
        slow = f"{100 * report[f'slow_share_{when}']:.0f} % of the cutting time below half of the programmed feed"
        text.append(f'<text x="{side * WIDTH + MARGIN}" y="24" font-weight="600">{head}</text>'
                    f'<text x="{side * WIDTH + MARGIN}" y="44" font-size="12.5" fill="#576474">{slow}</text>')

        def to_picture(place, left=side * WIDTH + (WIDTH - scale * (high[0] - low[0])) / 2,
                       top=HEAD + (HEIGHT - scale * (high[1] - low[1])) / 2):
            return f"{left + scale * (place[0] - low[0]):.1f},{top + scale * (high[1] - place[1]):.1f}"

        text.append('<g fill="none" stroke-width="2.6" stroke-linejoin="round" stroke-linecap="round">\n'
                    + drawn(places, to_picture, fastest) + "\n</g>")
    y = HEAD + HEIGHT + 12
    stops = "".join(f'<stop offset="{k / 8}" stop-color="{colour(k / 8)}"/>' for k in range(9))
    text.append(f'<defs><linearGradient id="speed">{stops}</linearGradient></defs>'
                f'<rect x="{MARGIN}" y="{y}" width="220" height="9" rx="3" fill="url(#speed)"/>'
                f'<text x="{MARGIN}" y="{y + 24}" font-size="12.5" fill="#576474">0</text>'
                f'<text x="{MARGIN + 220}" y="{y + 24}" font-size="12.5" fill="#576474" text-anchor="end">'
                f'{fastest:.0f} mm/min</text>'
                f'<text x="{MARGIN + 236}" y="{y + 9}" font-size="12.5" fill="#576474">'
                f'speed, predicted for machine {machine}</text></svg>')
    Path(out).write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    if len(sys.argv) < 4 or "--machine" not in sys.argv:
        sys.exit(__doc__)
    main(*sys.argv[1:])
