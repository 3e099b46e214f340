#!/usr/bin/env python3
"""The page of `batten smooth --report` in a real browser: no complaints on its console, nothing
loaded from anywhere, figures equal to the JSON report, and controls that do what they say.

    check.py BATTEN SOURCE_DIR            all samples' pages are checked
    check.py BATTEN SOURCE_DIR --shots DIR [PROGRAM OPTION ..]    pictures of one page, to look at
    check.py BATTEN SOURCE_DIR --programs PROGRAM .. -- OPTION ..  pages of these, with time and size
    check.py BATTEN SOURCE_DIR --tutorial           the pictures of docs/tutorial.md, in docs/pictures

Exit code 77 (skipped) where Chromium or its driver is not installed.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote, urlparse

sys.path.insert(0, str(Path(__file__).parent))
from browser import Browser, is_installed  # noqa: E402

PAGE_SIZE_AT_MOST = 3_000_000
# CSS pixels: a desk, a tablet, a telephone.
SIZES = ((1280, 900), (800, 1000), (390, 844))


class Failure(Exception):
    pass


def expect(truth, what):
    if not truth:
        raise Failure(what)


def expect_equal(found, expected, what):
    expect(found == expected, f"{what}: {found!r}, expected {expected!r}")


# Of the page's table.
ROWS_AT_ONCE = 50


def is_usual(run):
    return run["status"] == "kept" and run["reason"] in ("plunge", "too-short")


def make_page(batten, program, options, folder):
    """Returns the JSON report and the page's file."""
    page, figures = folder / "page.html", folder / "report.json"
    result = subprocess.run(
        [batten, "smooth", str(program), *options, "--dry-run", "--force", "--progress", "off",
         "--json", str(figures), "--report", str(page)], capture_output=True, text=True)
    expect(figures.exists() and page.exists(), f"no report was written: {result.stderr}")
    return json.loads(figures.read_text()), page


class PageCheck:
    def __init__(self, browser, report, page):
        self.browser = browser
        self.report = report
        self.page = page
        self.most_bytes = PAGE_SIZE_AT_MOST

    def all(self):
        expect(self.page.stat().st_size < self.most_bytes, f"{self.page.stat().st_size} bytes")
        self.browser.open(self.page)
        self.browser.wait("window.battenReport")
        self.loads_nothing()
        self.shows_the_figures()
        self.lists_the_runs()
        self.folds_the_notes()
        self.draws_the_path()
        self.fits()
        if self.value("battenReport.path.n") > 0:
            self.controls_work()
            self.refits_after_a_resize()
        self.works_by_keyboard()
        self.browser.paper(self.page.with_suffix(".pdf"))
        expect_equal(self.browser.complaints(), [], "console")

    def value(self, expression):
        return self.browser.run(f"return {expression}")

    def loads_nothing(self):
        expect_equal(self.value("performance.getEntriesByType('resource').length"), 0, "resources")

    # --- figures ------------------------------------------------------------------------------

    def shows_the_figures(self):
        shown = self.value("Object.fromEntries([...document.querySelectorAll('[data-figure]')]"
                           ".map((e) => [e.dataset.figure, Number(e.dataset.value)]))")
        report = self.report
        rewritten = [r for r in report["runs"] if r["status"] == "rewritten"]
        expected = {
            "time_before_s": report["time_before_s"], "time_after_s": report["time_after_s"],
            "deviation_mm": report["deviation_mm"],
            "path_before.distance_mm": report["path_before"]["distance_mm"],
            "path_after.distance_mm": report["path_after"]["distance_mm"],
            "path_before.roughness": report["path_before"]["roughness"],
            "path_after.roughness": report["path_after"]["roughness"],
            "slow_before": 100 * report["slow_share_before"],
            "slow_after": 100 * report["slow_share_after"],
            "input.blocks": report["input"]["blocks"], "output.blocks": report["output"]["blocks"],
            "rewritten": len(rewritten), "kept": len(report["runs"]) - len(rewritten),
        }
        for name, value in shown.items():
            expect_equal(value, expected[name], name)
        wanted = set()
        if report["understood"]:
            wanted = {"input.blocks", "output.blocks", "rewritten", "kept"}
            if report["time_before_s"] > 0:
                wanted |= {"time_before_s", "time_after_s"}
            if report["cutting_before_s"] > 0:
                wanted |= {"slow_before", "slow_after"}
            if report["path_before"]["length_mm"] > 0:
                wanted |= {f"path_{when}.{what}" for when in ("before", "after")
                           for what in ("distance_mm", "roughness")}
            if rewritten:
                wanted |= {"deviation_mm"}
        expect_equal(set(shown), wanted, "figures shown")
        text = self.value("document.body.innerText")
        if rewritten:
            expect(f"{report['deviation_mm']:.4f}" in text or "in" in text, "the deviation is not in the text")
        verdict = self.value("document.getElementById('verdict').className")
        good = report["proved"] and bool(rewritten)
        expect_equal("good" in verdict, good, "verdict")

    def lists_the_runs(self):
        listed = [r for r in self.report["runs"] if not is_usual(r)]
        expect_equal(self.rows(), min(ROWS_AT_ONCE, len(listed)), "rows of runs")
        folded = self.value("document.querySelectorAll('#run-table tr.folded').length")
        expect_equal(folded, int(len(listed) < len(self.report["runs"])), "rows of folded runs")
        first = self.value("battenReport.runs.listed().map((i) => battenReport.page.rows[i].status)")
        expect_equal(first, sorted(first, key="rewritten kept".split().index), "rewritten runs come first")
        reasons = self.value("[...document.querySelectorAll('.reason code')].map((e) => e.textContent)")
        for reason in self.report["reasons"]:
            expect(reason["id"] in reasons, f"{reason['id']} is not explained")

    def rows(self):
        return self.value("document.querySelectorAll('#run-table tbody tr[data-run]').length")

    # Errors are in sight, and the first lines that cost much; all others are one line until it is opened.
    def folds_the_notes(self):
        errors = sum(d["severity"] == "error" for d in self.report["diagnostics"])
        errors += min(3, sum(d["id"] == "modes-unknown" for d in self.report["diagnostics"]))
        others = len(self.report["diagnostics"]) - errors
        shown = "document.querySelectorAll('#messages li').length"
        expect_equal(self.value(shown), min(51, errors), "errors")
        expect_equal(self.value("document.querySelectorAll('#notes').length"), int(others > 0), "lines of notes")
        if others:
            for word in {d["id"] for d in self.report["diagnostics"] if d["severity"] != "error"}:
                expect(word in self.value("document.querySelector('#notes summary').textContent"), f"{word} is not counted")
            self.browser.click("#notes summary")
            self.browser.wait(f"{shown} === {min(51, errors) + min(51, others)}", 5)
            self.browser.click("#notes summary")

    # --- sizes --------------------------------------------------------------------------------

    def fits(self):
        """At each width, light and dark: nothing is wider than the page, figures are in their tiles, the path
        comes first."""
        for dark in (False, True):
            self.browser.dark(dark)
            for width, height in SIZES:
                self.browser.size(width, height)
                self.settle()
                wide = self.value("document.documentElement.scrollWidth")
                expect(wide <= width, f"{wide} pixels wide at {width}")
                out = self.value("[...document.querySelectorAll('.tile .big, .tile .more, h1, #verdict, button')]"
                                 ".filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent)")
                expect_equal(out, [], f"text that does not fit at {width}")
                top = self.value("document.getElementById('canvas').getBoundingClientRect().top + scrollY")
                errors = self.value("document.getElementById('messages').getBoundingClientRect().height")
                expect(top - errors < 0.75 * height, f"the path begins {top} pixels down at {width}")
        self.browser.dark(False)
        self.browser.size(*SIZES[0])
        self.settle()

    def settle(self):
        self.browser.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def refits_after_a_resize(self):
        self.browser.keys("01")
        for width, height in (SIZES[-1], SIZES[0]):
            self.browser.size(width, height)
            self.settle()
            outside = self.value(
                "(({toolPath: t, path, settings}) => { t.drawNow(); let out = 0; for (let i = 1; i < path.n; i++) {"
                " if (path.step[i] < 2) continue; const [x, y] = t.screen(t.u[i], t.v[i]);"
                " out += x < 0 || y < 0 || x > t.width || y > t.height; } return out; })(battenReport)")
            expect_equal(outside, 0, f"places outside the picture at {width}")

    def works_by_keyboard(self):
        """Tab reaches every control, and what has the focus shows it."""
        wanted = self.value("[...document.querySelectorAll('button, select, input, canvas[tabindex], summary, a[href]')]"
                            ".filter((e) => !e.disabled && e.checkVisibility() && !e.closest('dialog')).length")
        # From the first of them: Tab would go on where something was clicked.
        self.browser.run("const first = document.querySelector('.skip'); first.focus(); first.dataset.seen = 1")
        seen = 1
        for _ in range(wanted + 2 * ROWS_AT_ONCE):
            self.browser.tab()
            found = self.value("(e => e === document.body || e.dataset.seen ? '' : (e.dataset.seen = 1,"
                               " e.matches('button, select, input, canvas, summary, a') ? 'control' : 'row') + ' '"
                               " + (getComputedStyle(e).outlineStyle !== 'none'))(document.activeElement)")
            if not found:
                break
            expect(found.endswith("true"), f"the focus cannot be seen: {found}")
            seen += found.startswith("control")
        expect_equal(seen, wanted, "controls that Tab reaches")

    # --- path ---------------------------------------------------------------------------------

    def draws_the_path(self):
        tolerance = self.report["options"]["tolerance_mm"]
        greatest = self.value("battenReport.path.deviation.reduce((a, b) => Math.max(a, b), 0)")
        # The bound of the proof counts the chords of arcs too, 1 % of the tolerance at the most, and
        # is tight to 1 %; places on the page are rounded to 0.1 um.
        rounding = 0.0002
        expect(greatest <= self.report["deviation_mm"] + rounding,
               f"deviation {greatest} on the page, proved {self.report['deviation_mm']}")
        expect(greatest >= self.report["deviation_mm"] - 0.02 * tolerance - rounding,
               f"deviation {greatest} on the page, proved {self.report['deviation_mm']}")
        lines = self.value("battenReport.path.oldLine.reduce(([a, b], line) => [Math.min(a, line), Math.max(b, line)],"
                           " [Infinity, 0])")
        for run in self.report["runs"]:
            if run["reason"] == "position-unknown":
                continue
            expect(lines[0] <= run["last_line"] and run["first_line"] <= lines[1], f"run {run} is not drawn")

    def picture(self, selector):
        return self.browser.run(
            "return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() =>"
            " done(document.querySelector(arguments[0]).toDataURL()))))", selector)

    def changes(self, what, action, selector="#canvas"):
        before = self.picture(selector)
        action()
        expect(self.picture(selector) != before, f"{what} changes nothing on {selector}")

    def pressed(self, selector):
        return self.browser.run("return document.querySelector(arguments[0]).getAttribute('aria-pressed')", selector)

    def says_the_distance_in_its_units(self):
        shown = self.value("[...document.querySelectorAll('[data-figure=\"path_after.distance_mm\"]')].map((e) => e.textContent)")
        for text in shown:
            number, unit = text.split("\u00a0")
            now = self.report["path_after"]["distance_mm"] / (25.4 if unit == "in" else 1)
            expect(abs(float(number) - now) <= (0.6e-5 if unit == "in" else 0.6e-4), f"distance {text}, {now} {unit}")
        return [text.split("\u00a0")[1] for text in shown]

    def controls_work(self):
        browser = self.browser
        self.changes("a view", lambda: (browser.click("[data-view=side]"), browser.click("[data-view=front]")))
        self.changes("3D", lambda: browser.click("[data-view=space]"))
        expect_equal(self.pressed("[data-view=space]"), "true", "3D is pressed")
        self.changes("Plan", lambda: browser.click("[data-view=plan]"))
        self.changes("without the new path", lambda: browser.click("[data-layer=now]"))
        self.changes("with it", lambda: browser.keys("n"))
        self.changes("wheel", lambda: browser.wheel("#canvas", -100))
        self.changes("drag", lambda: browser.point("#canvas", drag=(60, 30)))
        self.changes("All", lambda: browser.click("#fit"))
        self.changes("colour", lambda: browser.keys("c"))
        browser.keys("cc")
        self.changes("arrow key", lambda: browser.keys("\ue012", "#canvas"))
        self.changes("theme", lambda: browser.keys("t"))
        before = self.says_the_distance_in_its_units()
        self.changes("units", lambda: browser.keys("u"), "#chart-deviation")
        after = self.says_the_distance_in_its_units()
        expect(not before or before != after, f"the distance is in {after} in both units")
        browser.keys("ut0")
        if self.report["deviation_mm"] > 0 and any(r["status"] == "rewritten" for r in self.report["runs"]):
            self.changes("greatest deviation", lambda: browser.click("#worst"))
            expect("deviation" in self.value("document.getElementById('readout').textContent"), "nothing is read out")
            self.changes("magnified", lambda: browser.keys("]]]"))
            expect("times" in self.value("document.getElementById('magnify-text').textContent"), "not magnified")
            self.changes("chart wheel", lambda: browser.wheel("#chart-deviation", 300), "#chart-deviation")
            browser.keys("0")
        self.region_works()
        if len(self.report["runs"]) > 1:
            if self.value("!!document.getElementById('unfold')"):
                browser.click("#unfold")
            self.changes("a run", lambda: browser.click("#run-table tbody tr"))
            expect_equal(self.value("battenReport.runs.chosen >= 0"), True, "a run is chosen")
            browser.click("[data-runs=kept]")
            kept = sum(r["status"] == "kept" for r in self.report["runs"])
            expect_equal(self.rows(), min(ROWS_AT_ONCE, kept), "kept rows")
            browser.click("[data-runs=all]")
            browser.click("#run-table th:nth-child(5) button")
            times = self.value("[...document.querySelectorAll('#run-table tbody tr')]"
                               ".map((row) => battenReport.page.rows[row.dataset.run].time_before_s)")
            expect_equal(times, sorted(times, reverse=True), "sorted by time")
            browser.keys("0")
        browser.keys("?")
        expect_equal(self.value("document.getElementById('keys').open"), True, "keys are shown")
        browser.keys("\ue00c")
        expect_equal(self.value("document.getElementById('keys').open"), False, "keys are gone")


    def region_works(self):
        """The region of the tolerance: drawn where it is wide enough, in its true width; else the page says why not."""
        browser = self.browser
        region = self.value("battenReport.path.region")
        note = "document.getElementById('region-note').textContent"
        expect_equal(self.value("document.querySelector('[data-layer=region]').disabled"), region["drawn"] == 0,
                     "a button for the region")
        if region["drawn"] == 0:
            browser.keys("g")
            expect_equal(self.value("battenReport.settings.region"), False, "no region is shown")
            return
        browser.keys("[[[[[[[[[[")
        # A place of the region in the middle of the picture, eight tolerances wide.
        self.value("(({toolPath: t, settings}) => { t.fitted = null; t.centre = [t.regionU[0], t.regionV[0]];"
                   " t.scale = t.width / settings.tolerance / 8; t.draw(); })(battenReport)")
        self.changes("the region", lambda: browser.click("[data-layer=region]"))
        expect_equal(self.value(note), "", "the region is seen")
        browser.keys("]]]]]]]]]]")
        self.settle()
        expect("as it is" in self.value(note), "beside a magnified deviation there is no region")
        browser.keys("[[[[[[[[[[")
        self.value("battenReport.toolPath.zoom(1e-5)")
        self.settle()
        expect("zoom in" in self.value(note), "from afar there is no region")
        browser.keys("g0")
        expect_equal(self.pressed("[data-layer=region]"), "false", "the region is gone")


class IslandCheck(PageCheck):
    """Around an island 1 mm wide with 0.1 mm: its region is drawn, with a hole."""

    def all(self):
        self.browser.open(self.page)
        self.browser.wait("window.battenReport")
        self.browser.keys("ng")
        self.settle()
        places = {(0.5, 0.07): True, (0.5, -0.04): True, (0.5, 0.13): False, (0.5, 0.5): False}
        shown = self.browser.run(
            "const {toolPath: t} = battenReport; t.drawNow(); const { width, height } = t.canvas;"
            " const pixels = t.context.getImageData(0, 0, width, height).data; return arguments[0].map(([x, y]) => {"
            " const [right, down] = t.screen(x - t.middle[0], y - t.middle[1]).map((px) => Math.round(px * width / t.width));"
            " return [...pixels.slice(4 * (down * width + right), 4 * (down * width + right) + 3)]; });", list(places))
        region = self.value("getComputedStyle(document.documentElement).getPropertyValue('--region')").strip()
        filled = [int(region[i:i + 2], 16) for i in (1, 3, 5)]
        expect_equal(dict(zip(places, (colour == filled for colour in shown))), places, "places in the region")
        expect_equal(self.browser.complaints(), [], "console")


def island(scratch):
    program = scratch / "island.ngc"
    program.write_text("G21 G90 G17\nG0 X0 Y0 Z0\nG1 X0.5 F600\nX1\nY0.5\nY1\nX0.5\nX0\nY0.5\nY0\nM2\n")
    new = scratch / "island_new.ngc"
    new.write_text("G21 G90 G17\nG0 X0 Y0 Z0\nG1 X1 F600\nY1\nX0\nY0.02\nY0\nM2\n")
    return program, new


def cases(source, scratch):
    """(name, program, options)"""
    for folder in sorted((source / "samples").iterdir()):
        if (folder / "command").exists():
            words = (folder / "command").read_text().split()
            yield folder.name, folder / "program.ngc", words[3:]
    plain = ["--target", "linuxcnc", "--tolerance", "0.01"]
    hostile = scratch / "</script><img src=x onerror=alert(1)>.ngc".replace("/", "\u2044")
    hostile.write_text("G21\n(</script><b>)\nG0 X0 Y0\nG1 X1 F100\nX2 Y1\nX3\nM2\n")
    yield "a name that is markup", hostile, plain
    for name, text in (("no units", "G0 X0\nG1 X1 F100\n"), ("empty", ""), ("no motion", "G21\nM3 S1000\nM2\n")):
        file = scratch / f"{name}.ngc"
        file.write_text(text)
        yield name, file, plain


class OtherPageCheck(PageCheck):
    """Of `verify`, `inspect` and `time`: their figures are those of --json, and nothing is shown that they have not."""

    def all(self):
        self.browser.open(self.page)
        self.browser.wait("window.battenReport")
        self.loads_nothing()
        kind = self.value("JSON.parse(document.getElementById('data').textContent).kind")
        expect_equal(self.value("JSON.parse(document.getElementById('data').textContent).report"), self.report, "report")
        for name, shown in self.value("[...document.querySelectorAll('[data-figure]')].map((e) => [e.dataset.figure,"
                                      " Number(e.dataset.value)])"):
            if name in self.report and isinstance(self.report[name], (int, float)):
                expect_equal(shown, self.report[name], name)
        two = kind == "verify"
        expect_equal(self.value("document.getElementById('worst').checkVisibility()"), two, "a button for the deviation")
        expect_equal(self.value("document.getElementById('chart-deviation').checkVisibility()"), two, "a chart of the deviation")
        self.rows_are_drawn()
        self.fits()
        self.refits_after_a_resize()
        self.works_by_keyboard()
        self.browser.keys("1234onrcu0?")
        self.browser.keys("\ue00c")
        expect_equal(self.browser.complaints(), [], "console")

    # Each row of the table leads to its place on the path.
    def rows_are_drawn(self):
        rows = self.value("battenReport.page.rows.length")
        expect_equal(self.value("new Set([...battenReport.path.run].filter((run) => run >= 0)).size"), rows, "rows on the path")
        if rows:
            self.browser.click("#run-table tbody tr")
            expect_equal(self.value("battenReport.toolPath.chosen.length"), 2, "a chosen row is shown")


def other_pages(batten, source, scratch):
    """(name, JSON report, page)"""
    old, new = source / "samples/butterfly/program.ngc", scratch / "new.ngc"
    subprocess.run([batten, "smooth", old, "--target", "linuxcnc", "--tolerance", "0.015", "-o", new, "--quiet"], check=True)
    wrong = scratch / "wrong.ngc"
    wrong.write_text(new.read_text().replace("M3", "M4", 1))
    for name, words in {
            "verify": ["verify", old, new, "--tolerance", "0.015"],
            "verify, with a violation": ["verify", old, wrong, "--tolerance", "0.015"],
            "verify, the same bytes": ["verify", old, old],
            "inspect": ["inspect", source / "samples/tool_changes/program.ngc"],
            "time": ["time", old, "--machine", "linuxcnc"],
            "time of two tools": ["time", source / "samples/tool_changes/program.ngc", "--machine", "router"]}.items():
        page, figures = scratch / "other.html", scratch / "other.json"
        subprocess.run([batten, *words, "--force", "--json", figures, "--report", page], capture_output=True, check=False)
        report = json.loads(figures.read_text())
        # How the command has ended is not known yet when the page is written.
        del report["exit_code"], report["messages"]
        yield name, report, page


def check_index(browser, batten, scratch):
    """The page of a batch: fits everywhere, and each link leads to a file."""
    tree = scratch / "smooth"
    subprocess.run([batten, "batch", scratch / "in", tree, "--target", "linuxcnc", "--pages"], capture_output=True, check=False)
    index = tree / "batten-batch/index.html"
    browser.open(index)
    for dark in (False, True):
        browser.dark(dark)
        for width, height in SIZES:
            browser.size(width, height)
            wide = browser.run("return document.documentElement.scrollWidth")
            expect(wide <= width, f"{wide} pixels wide at {width}")
    expect_equal(browser.run("return document.querySelectorAll('li').length"), 3, "programs")
    expect_equal(browser.run("return document.querySelectorAll('li svg path').length") > 0, True, "pictures")
    expect_equal(browser.run("return document.querySelector('li').className"), "bad", "what was not written comes first")
    for link in browser.run("return [...document.links].map((a) => a.href)"):
        expect(Path(unquote(urlparse(link).path)).exists(), f"{link} leads nowhere")
    expect_equal(browser.run("return [...document.querySelectorAll('h2 a')].length"), 3, "pages")
    expect_equal(browser.complaints(), [], "console")


def check_all(batten, source):
    failed = 0

    def run(case, check):
        nonlocal failed
        try:
            check()
            print(f"ok      {case}", flush=True)
        except (Failure, RuntimeError) as problem:
            failed += 1
            print(f"FAILED  {case}: {problem}", flush=True)

    with tempfile.TemporaryDirectory() as name, Browser() as browser:
        scratch = Path(name)
        for case, program, options in cases(source, scratch):
            run(case, lambda: PageCheck(browser, *make_page(batten, program, options, scratch)).all())
        for case, report, page in other_pages(batten, source, scratch):
            run(case, lambda: OtherPageCheck(browser, report, page).all())
        page, figures = scratch / "island.html", scratch / "island.json"
        subprocess.run([batten, "verify", *island(scratch), "--tolerance", "0.1", "--force", "--json", figures, "--report", page],
                       capture_output=True, check=True)
        run("the region about an island", lambda: IslandCheck(browser, json.loads(figures.read_text()), page).all())
        (scratch / "in").mkdir()
        for name in ("butterfly", "kept_by_rule"):
            shutil.copy(source / "samples" / name / "program.ngc", scratch / "in" / f"{name} #1.ngc")
        (scratch / "in/no units.ngc").write_text("G0 X0\nG1 X1 F100\n")
        run("the page of a batch", lambda: check_index(browser, batten, scratch))
    return 1 if failed else 0


def check_programs(batten, programs, options):
    """Real programs, as large as they may be: a page opens within 3 s and stays below 20 MB."""
    failed = 0
    for program in programs:
        with tempfile.TemporaryDirectory() as name, Browser() as browser:
            try:
                report, page = make_page(batten, program, options, Path(name))
                check = PageCheck(browser, report, page)
                check.most_bytes = 20_000_000
                check.all()
                opened = browser.run("return performance.timing.loadEventEnd - performance.timing.navigationStart")
                ready = opened + int(browser.run("return document.documentElement.dataset.readyMs"))
                expect(ready < 3000, f"usable after {ready} ms")
                print(f"ok      {program}: {report['input']['blocks']} blocks, page of {page.stat().st_size} bytes, "
                      f"usable after {ready} ms", flush=True)
            except (Failure, RuntimeError) as problem:
                failed += 1
                print(f"FAILED  {program}: {problem}", flush=True)
    return 1 if failed else 0


def shots(batten, folder, program, options):
    folder.mkdir(parents=True, exist_ok=True)
    _, page = make_page(batten, program, options, folder)
    print(f"{page.stat().st_size} bytes")
    for theme in ("light", "dark"):
        with Browser() as browser:
            browser.dark(theme == "dark")
            browser.open(page)
            browser.wait("window.battenReport", 60)
            ready = browser.run("return [Number(document.documentElement.dataset.readyMs),"
                                " performance.timing.loadEventEnd - performance.timing.navigationStart,"
                                " battenReport.path.n]")
            print(f"{theme}: usable after {ready[0]} ms of script, page loaded after {ready[1]} ms, {ready[2]} vertices")
            browser.picture(folder / f"{theme}-page.png")
            browser.keys("4")
            browser.picture(folder / f"{theme}-space.png", whole=False)
            browser.keys("1w]]]")
            browser.picture(folder / f"{theme}-worst.png", whole=False)
            for complaint in browser.complaints():
                print(complaint)
            if theme == "light":
                browser.paper(folder / "page.pdf")


def tutorial(batten, source):
    """The page that the command of the tutorial writes: from its head to the charts, and at the greatest deviation."""
    pictures = source / "docs/pictures"
    with tempfile.TemporaryDirectory() as name, Browser() as browser:
        scratch = Path(name)
        (scratch / "samples").symlink_to((source / "samples").resolve())
        subprocess.run([Path(batten).resolve(), "smooth", "samples/butterfly/program.ngc", "--target", "linuxcnc",
                        "--tolerance", "0.015", "-o", "butterfly.ngc", "--report", "butterfly.html", "--quiet"],
                       cwd=scratch, check=True)
        browser.size(1100, 1440)
        browser.open(scratch / "butterfly.html")
        browser.wait("window.battenReport", 60)
        browser.picture(pictures / "report.png", whole=False)
        browser.size(1100, 720)
        browser.keys("w]]]")
        browser.picture(pictures / "report_worst.png", whole=False)


def main(arguments):
    if not is_installed():
        print("skipped: needs chromium and chromedriver (apt-get install chromium chromium-driver)")
        return 77
    batten, source = arguments[0], Path(arguments[1])
    if "--programs" in arguments:
        words = arguments[arguments.index("--programs") + 1:]
        return check_programs(batten, words[:words.index("--")], words[words.index("--") + 1:])
    if "--tutorial" in arguments:
        tutorial(batten, source)
        return 0
    if "--shots" in arguments:
        folder, program, *options = arguments[arguments.index("--shots") + 1:]
        shots(batten, Path(folder), program, options)
        return 0
    return check_all(batten, source)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
