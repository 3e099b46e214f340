# SPDX-License-Identifier: GPL-3.0-or-later
"""A FreeCAD post-processor: runs one of FreeCAD's own posts, then Batten on what it wrote.

FreeCAD 0.20 and 0.21 call `export`, FreeCAD 1.0 and later the class `Batten` at the end.
`batten freecad install` puts this file where FreeCAD looks. Guide: docs/freecad.md."""

import os
import shlex
import shutil
import subprocess
import tempfile

import FreeCAD

# Set by `batten freecad install` to the full path of the program that installed this file: programs
# that start from a menu often have another PATH than a shell.
BATTEN = ""

TOOLTIP = """Runs another post-processor, then Batten, which makes the chains of short moves of
its program smooth and proves that the new program stays within the tolerance of the old one."""

# Targets of Batten and the post of FreeCAD that writes for them, where the names differ.
POST_OF_TARGET = {
    "brother": "fanuc", "fluidnc": "grbl", "g2core": "grbl", "grblhal": "grbl", "haas": "fanuc",
    "itnc530": "heidenhain", "klipper": "marlin", "mach3": "mach3_mach4", "mach4": "mach3_mach4",
    "mazak": "fanuc", "mitsubishi": "fanuc", "planetcnc": "linuxcnc", "reprapfirmware": "rrf",
    "smoothieware": "smoothie", "syntec": "fanuc"}
# The target of a post whose name is none; without a row it is the one with the post's name.
TARGET_OF_POST = {"mach3_mach4": "mach3", "rrf": "reprapfirmware", "smoothie": "smoothieware"}

TOOLTIP_ARGS = """Arguments: --target CONTROL [--tolerance 0.01] [more options of batten smooth] [-- arguments of the other post]

--target CONTROL   what the program is for, such as linuxcnc or grbl (batten targets)
--post NAME        the post that runs first; without it the one for the target
--tolerance 0.01   greatest distance of the new path from the old one; 0.01, 0.01mm, 0.0005in
--or-unsmoothed    when Batten refuses, write what the other post wrote; without it nothing is written
--batten FILE      the program, when it is not where it was installed
--timeout 600      seconds after which Batten is stopped

All other options before -- go to batten smooth (batten smooth --help), all after it to the other post."""

UNITS = "G21"

DEFAULT_TIMEOUT = 600  # s; a program of some megabytes takes one or two minutes
OWN_OPTIONS = ("--post", "--batten", "--timeout")
OWN_FLAG = "--or-unsmoothed"
# Where files go is decided here.
NOT_FOR_USERS = ("-o", "--out", "--in-place", "--dry-run", "--print-config")


class Refusal(Exception):
    """No program can be written; the text is for the user."""


# --- arguments ---------------------------------------------------------------------------------


class Arguments:
    """The job's line of arguments: ours, those of batten smooth, those of the other post."""

    def __init__(self, line):
        try:
            words = shlex.split(line or "")
        except ValueError as error:
            raise Refusal("arguments: %s: %s" % (error, line))
        cut = words.index("--") if "--" in words else len(words)
        self.stock = words[cut + 1:]
        self.smooth = []
        self.own = {}
        self.or_unsmoothed = False
        self._sort(words[:cut])
        target = self._value_of("--target")
        self.post = self.own.get("--post")
        if not target and not self.post:
            raise Refusal("arguments: no --target given, such as: --target linuxcnc --tolerance 0.01")
        if not target:
            self.smooth += ["--target", TARGET_OF_POST.get(self.post, self.post)]
        # A post with the name of the target itself goes first: a user's own, or one of later versions.
        self.possible_posts = [self.post] if self.post else [target, POST_OF_TARGET.get(target, target)]
        self.timeout = self._seconds(self.own.get("--timeout", str(DEFAULT_TIMEOUT)))

    def _sort(self, words):
        words = list(words)
        while words:
            word = words.pop(0)
            name, equals, value = word.partition("=")
            if name in NOT_FOR_USERS:
                raise Refusal("arguments: %s: FreeCAD decides where the program goes" % name)
            if name in OWN_OPTIONS:
                if not equals and not words:
                    raise Refusal("arguments: %s: no value given" % name)
                self.own[name] = value if equals else words.pop(0)
            elif word == OWN_FLAG:
                self.or_unsmoothed = True
            else:
                self.smooth.append(word)

    def _value_of(self, option):
        for index, word in enumerate(self.smooth):
            if word.startswith(option + "="):
                return word[len(option) + 1:]
            if word == option and index + 1 < len(self.smooth):
                return self.smooth[index + 1]
        return None

    @staticmethod
    def _seconds(text):
        try:
            seconds = float(text)
        except ValueError:
            seconds = 0
        if seconds <= 0:
            raise Refusal("arguments: --timeout: '%s', expected seconds" % text)
        return seconds


# --- Batten ------------------------------------------------------------------------------------


def find_batten(named):
    """The program: as the arguments say, else as installed, else as the environment says."""
    if named:
        found = shutil.which(os.path.expanduser(named))
        if not found:
            raise Refusal("--batten: there is no program %s" % named)
        return found
    for place in (BATTEN, os.environ.get("BATTEN", ""), "batten"):
        found = shutil.which(place) if place else None
        if found:
            return found
    raise Refusal("the program batten was not found; run `batten freecad install` again, or say "
                  "--batten with its full path")


def smoothed(gcode, arguments, name):
    """The text that Batten makes of `gcode`; `name` stands for the file in its messages."""
    # FreeCAD 1.0 takes two line ends at the start for "write line ends as they are".
    mark = "\n\n" if gcode.startswith("\n\n") else ""
    with tempfile.TemporaryDirectory(prefix="batten-freecad-") as folder:
        new_name = "smooth-" + name
        with open(os.path.join(folder, name), "w", encoding="utf-8", errors="surrogateescape",
                  newline="") as file:
            file.write(gcode[len(mark):])
        run_batten([find_batten(arguments.own.get("--batten")), "smooth", name, "-o", new_name,
                    "--progress", "off"] + arguments.smooth, folder, arguments.timeout)
        with open(os.path.join(folder, new_name), encoding="utf-8", errors="surrogateescape",
                  newline="") as file:
            return mark + file.read()


def run_batten(command, folder, timeout):
    try:
        done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, timeout=timeout,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    except OSError as error:
        raise Refusal("%s: %s" % (command[0], error))
    except subprocess.TimeoutExpired:
        raise Refusal("not done after %g s; --timeout allows more" % timeout)
    said = done.stderr.decode("utf-8", "replace")
    if done.returncode != 0:
        raise Refusal(said.strip() or "%s ended with code %d" % (command[0], done.returncode))
    FreeCAD.Console.PrintMessage(said)


def smoothed_or_told(gcode, arguments, name, units=None):
    if not gcode:
        return gcode  # nothing was posted
    if units and not any(word.partition("=")[0] == "--units" for word in arguments.smooth):
        arguments.smooth += ["--units", units]
    try:
        return smoothed(gcode, arguments, name)
    except Refusal as refusal:
        if not arguments.or_unsmoothed:
            raise
        FreeCAD.Console.PrintWarning("Batten: %s\nBatten: written as it was, not smoothed\n" % refusal)
        return gcode


def file_name(text):
    """A name without anything that a folder or a shell could misread."""
    name = os.path.basename(text or "")
    kept = "".join(c if c.isalnum() or c in "._-" else "_" for c in name).lstrip(".-")
    return kept or "part.nc"


def tell(refusal):
    FreeCAD.Console.PrintError("Batten: nothing was written.\n%s\n" % refusal)
    if FreeCAD.GuiUp:
        from PySide import QtGui  # FreeCAD's own, the same for every version of Qt
        QtGui.QMessageBox.critical(None, "Batten: nothing was written", str(refusal))


# --- the other post ----------------------------------------------------------------------------


def with_quiet_editor(stock, knows_option):
    """Stock posts show their text in a window of their own, where it would not be smooth yet."""
    if not knows_option or any(word in ("--show-editor", "--no-show-editor") for word in stock):
        return stock
    return stock + ["--no-show-editor"]


def line_of(words):
    return " ".join(shlex.quote(word) for word in words)


def source_of(name, folders):
    """The text of the file NAME_post.py that FreeCAD would load; None when there is none."""
    for folder in folders:
        place = os.path.join(str(folder), name + "_post.py")
        if os.path.isfile(place):
            with open(place, encoding="utf-8", errors="replace") as file:
                return file.read()
    return None


def post_for(arguments, preferences):
    """The name of the post that runs first; says what there is when there is no such post."""
    if arguments.post == "batten":
        raise Refusal("--post: batten is this post; name the one that runs before it")
    there = [post for post in preferences.allAvailablePostProcessors() if post != "batten"]
    for name in arguments.possible_posts:
        if name in there:
            return name
    raise Refusal("%s: there is no post '%s'; --post names one of: %s" % (
        "--post" if arguments.post else "--target", arguments.possible_posts[-1], ", ".join(there)))


def called(name, post):
    """What the other post returns; its own way to fail becomes a refusal."""
    try:
        return post()
    except SystemExit as end:  # argparse did not understand its arguments
        raise Refusal("the post '%s' ended with code %s; see the report view for what it said, and "
                      "what stands behind -- in the arguments" % (name, end.code))


def program_of(name, export, objects, file_named, line):
    """The text of a script, None when it gave none. Some return it; some only write it to the file
    they are given, even where that is "-" (grbl, rrf and marlin of 0.20); jtech can only return it."""
    with tempfile.TemporaryDirectory(prefix="batten-freecad-") as folder:
        file = os.path.join(folder, file_named)
        try:
            text = called(name, lambda: export(objects, file, line))
        except Exception as trouble:
            try:
                text = called(name, lambda: export(objects, "-", line))
            except Exception:
                raise trouble from None
        if isinstance(text, str) and "\n" in text:  # nccad returns the name of its file
            return text
        if not os.path.isfile(file):
            return text if text == "" else None
        with open(file, encoding="utf-8", errors="surrogateescape", newline="") as written:
            return written.read()


def without_editor(module, stock):
    """philips and comparams know no option for it, or do not read it."""
    if getattr(module, "SHOW_EDITOR", False) and "--show-editor" not in stock:
        module.SHOW_EDITOR = False


def units_of(module):
    """What the post wrote in, as it says itself: uccnc writes neither G20 nor G21."""
    return {"G20": "inch", "G21": "mm"}.get(getattr(module, "UNITS", None))


class Script:
    """A script as FreeCAD 1.0 holds it, whose `export` returns the text whichever way it gives it."""

    def __init__(self, name, module, file_named):
        self._name, self._module, self._file_named = name, module, file_named

    def __getattr__(self, name):
        return getattr(self.__dict__["_module"], name)

    def export(self, objects, _, line):
        return program_of(self._name, self._module.export, objects, self._file_named, line)


# --- FreeCAD 0.20 and 0.21 ---------------------------------------------------------------------


def loader_and_preferences():
    try:
        from Path.Post.Processor import PostProcessor
        import Path.Preferences as preferences
    except ImportError:
        from PathScripts.PathPostProcessor import PostProcessor
        import PathScripts.PathPreferences as preferences
    return PostProcessor, preferences


def export(objectslist, filename, argstring):
    """Called by FreeCAD 0.20 and 0.21: writes the file, unless it is "-", and returns the text."""
    try:
        arguments = Arguments(argstring)
        loader, preferences = loader_and_preferences()
        name = post_for(arguments, preferences)
        source = source_of(name, preferences.searchPathsPost()) or ""
        stock = with_quiet_editor(arguments.stock, "--no-show-editor" in source)
        post = loader.load(name)
        without_editor(post.script, stock)
        file_named = file_name("" if filename == "-" else filename)
        gcode = program_of(name, post.export, objectslist, file_named, line_of(stock))
        if not gcode:
            raise Refusal("the post '%s' gave no program" % name)
        text = smoothed_or_told(gcode, arguments, file_named, units_of(post.script))
    except Refusal as refusal:
        remove_stale(filename)
        tell(refusal)
        # FreeCAD takes a returned None for success.
        raise RuntimeError("Batten: nothing was written: %s" % refusal) from None
    if filename != "-":
        # Line ends that the other post chose stay; plain ones become the system's, as ever.
        with open(filename, "w", encoding="utf-8", errors="surrogateescape",
                  newline="" if "\r" in text else None) as file:
            file.write(text)
    return text


def remove_stale(filename):
    """FreeCAD had the user's word to replace this file: left behind, it would pass for the new one."""
    if filename != "-" and os.path.isfile(filename):
        os.remove(filename)


# --- FreeCAD 1.0 and later ---------------------------------------------------------------------

try:
    from Path.Post.Processor import PostProcessor, PostProcessorFactory
except ImportError:
    PostProcessorFactory = None


class JobWithArguments:
    """The job as it is, but for the arguments that the other post shall see. The document is not
    touched."""

    def __init__(self, job, line):
        self._job = job
        self.PostProcessorArgs = line

    def __getattr__(self, name):
        return getattr(self.__dict__["_job"], name)


def the_job_in(chosen):
    """FreeCAD gives a job, a list with one job, or a dictionary with the job and operations."""
    if isinstance(chosen, dict):
        return chosen["job"]
    return chosen[0] if isinstance(chosen, list) else chosen


def with_job(chosen, job):
    if isinstance(chosen, dict):
        return dict(chosen, job=job)
    return [job] if isinstance(chosen, list) else job


def knows_editor_option(post, source):
    parser = getattr(post, "parser", None)
    if parser is not None and hasattr(parser, "format_help"):
        return "--no-show-editor" in parser.format_help()
    return "--no-show-editor" in source


if PostProcessorFactory is not None:

    class Batten(PostProcessor):
        """FreeCAD asks for a class with the title of the file's name."""

        def __init__(self, job):
            self._chosen = job
            super().__init__(job, tooltip=TOOLTIP, tooltipargs=TOOLTIP_ARGS, units=UNITS)

        @property
        def tooltip(self):
            return TOOLTIP

        @property
        def tooltipArgs(self):
            return TOOLTIP_ARGS

        @property
        def units(self):
            return UNITS

        def export(self):
            """[(part, text)] for FreeCAD to write; None, and a message, when one part is refused."""
            try:
                return self._export()
            except Refusal as refusal:
                tell(refusal)
                return None

        def _export(self):
            import Path.Preferences as preferences
            job = the_job_in(self._chosen)
            arguments = Arguments(job.PostProcessorArgs)
            name = post_for(arguments, preferences)
            quiet_job = JobWithArguments(job, "")
            post = PostProcessorFactory.get_post_processor(with_job(self._chosen, quiet_job), name)
            if post is None:
                raise Refusal("the post '%s' could not be loaded" % name)
            source = source_of(name, preferences.searchPathsPost()) or ""
            quiet_job.PostProcessorArgs = line_of(
                with_quiet_editor(arguments.stock, knows_editor_option(post, source)))
            label = getattr(job, "Label", "") or "part"
            module = getattr(post, "script_module", None)
            if module:
                without_editor(module, arguments.stock)
                post.script_module = Script(name, module, file_name(label + ".nc"))
            sections = called(name, post.export)
            if not sections:
                raise Refusal("the post '%s' gave no program" % name)
            return [(part, smoothed_or_told(gcode, arguments, file_name("%s-%s.nc" % (label, part)),
                                            units_of(module)))
                    for part, gcode in sections]
