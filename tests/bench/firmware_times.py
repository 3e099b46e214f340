#!/usr/bin/env python3
"""Times that Batten predicts beside those that real firmware took.

    tests/bench/firmware_times.py BATTEN [--data FOLDER] [--worst N] [--only FIRMWARE[/SETTING]] [--within PERCENT]

FOLDER (BATTEN_FIRMWARE, else ../shared/firmware) has programs/*.nc and times.tsv: a row per program,
firmware and setting, with the measured seconds (time_s). Each row is timed by `batten time` on a machine
with exactly the settings of its firmware. Printed are the mean and the greatest difference of each
firmware and setting, then the worst rows. With --within the exit code is 1 when a row differs by more.
"""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor


def grbl(base, junction_deviation, steps, velocities, accelerations, look_ahead):
    """A machine file. Velocities in mm/min: X and Y, Z."""
    lines = [f'based-on = "{base}"', "stream-rate = inf", "block-period = 0.00002"]
    lines += [f"junction-deviation = {junction_deviation}", "arc-tolerance = 0.002", f"look-ahead = {look_ahead}"]
    for axis, which in (("x", 0), ("y", 0), ("z", 1)):
        lines += [f"[axis.{axis}]", f"steps = {steps}", f"acceleration = {accelerations[which]}"]
        lines += [f'{key} = "{velocities[which]} mm/min"' for key in ("velocity", "rapid-velocity")]
    return "\n".join(lines) + "\n"


def klipper(velocity, acceleration, corner, ratio, resolution):
    return (
        'based-on = "klipper-router"\nblock-period = 0.000001\n'
        f"max-velocity = {velocity}\nrapid-velocity = {velocity}\nmax-acceleration = {acceleration}\n"
        f"path-feed = {velocity}\npath-acceleration = {acceleration}\n"
        f"square-corner-velocity = {corner}\nminimum-cruise-ratio = {ratio}\narc-resolution = {resolution}\n"
    )


A = (0.01, 250, (5000, 5000), (400, 400))
MACHINES = {
    ("grbl", "A"): grbl("router", *A, 15),
    ("grbl", "B"): grbl("router", 0.02, 800, (3000, 800), (150, 60), 15),
    ("grblHAL", "A"): grbl("grblhal-router", *A, 100),
    ("grblHAL", "A30"): grbl("grblhal-router", *A, 30),
}
for name, values in {"S": (300, 3000, 5, 0.5), "T": (83.33, 400, 5, 0.5), "M": (83.33, 400, 3.1075, 0)}.items():
    for resolution in ("1.0", "0.1"):
        MACHINES["Klipper", f"{name}-r{resolution}"] = klipper(*values, resolution)
    MACHINES["Klipper", name] = klipper(*values, "1.0")


def predicted(batten, program, machine, folder):
    file = folder / ("_".join(machine) + ".toml")
    command = [batten, "time", program, "--machine", file, "--from", "0,0,0", "--json", "-", "--quiet"]
    answer = subprocess.run(command, capture_output=True, text=True)
    if answer.returncode != 0:
        sys.exit(f"{program.name}, {'/'.join(machine)}: {answer.stderr}")
    return json.loads(answer.stdout)["time_s"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten")
    default = pathlib.Path(__file__).resolve().parents[3] / "shared" / "firmware"
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path(os.environ.get("BATTEN_FIRMWARE", default)))
    parser.add_argument("--worst", type=int, default=10)
    parser.add_argument("--only", default="")
    parser.add_argument("--within", type=float)
    options = parser.parse_args()

    with open(options.data / "times.tsv", newline="") as file:
        rows = [r for r in csv.DictReader(file, delimiter="\t") if f"{r['firmware']}/{r['setting']}".startswith(options.only)]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for machine, text in MACHINES.items():
            (folder / ("_".join(machine) + ".toml")).write_text(text)

        def difference(row):
            program = options.data / "programs" / (row["program"] + ".nc")
            seconds = predicted(options.batten, program, (row["firmware"], row["setting"]), folder)
            return 100 * (seconds / float(row["time_s"]) - 1), seconds, row

        with ThreadPoolExecutor(2) as pool:
            results = list(pool.map(difference, rows))

    groups = {}
    for result in results:
        groups.setdefault((result[2]["firmware"], result[2]["setting"]), []).append(result)
    print("| firmware | setting | programs | mean difference % | greatest % | program |\n|---|---|---|---|---|---|")
    for (firmware, setting), group in groups.items():
        mean = sum(abs(d) for d, _, _ in group) / len(group)
        worst = max(group, key=lambda r: abs(r[0]))
        print(f"| {firmware} | {setting} | {len(group)} | {mean:.2f} | {worst[0]:+.2f} | {worst[2]['program']} |")
    print()
    results.sort(key=lambda r: -abs(r[0]))
    for d, seconds, row in results[: options.worst]:
        print(f"{d:+7.2f} %  {seconds:9.4f} s, {float(row['time_s']):9.4f} measured: {row['program']}, {row['firmware']} {row['setting']}")
    if options.within is not None and abs(results[0][0]) > options.within:
        sys.exit(1)


if __name__ == "__main__":
    main()
