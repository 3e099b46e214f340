"""Stand-ins for the parts of FreeCAD that a post meets, after the interfaces of its versions:

  version_0_20()  modules PathScripts.PathPostProcessor and PathScripts.PathPreferences
  version_0_21()  modules Path.Post.Processor (with a PostProcessor that loads) and Path.Preferences
  version_1_0()   modules Path.Post.Processor (factory, base class, wrapper) and Path.Preferences

Each returns the loaded batten_post module (0.20, 0.21) or nothing (1.0, whose factory loads it).
`Job` and `post_process` stand for a job and the command of the menu."""

import importlib.util
import os
import pathlib
import sys
import types

POSTS = pathlib.Path(__file__).parent / "posts"
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "integrations/freecad/batten_post.py"


class Console:
    def __init__(self):
        self.said = []

    def PrintError(self, text):
        self.said.append(("error", text))

    def PrintWarning(self, text):
        self.said.append(("warning", text))

    def PrintMessage(self, text):
        self.said.append(("message", text))

    def text(self, kind):
        return "".join(text for each, text in self.said if each == kind)


def search_paths():
    return [str(SCRIPT.parent), str(POSTS)]


def available():
    return sorted(f.name[:-len("_post.py")] for folder in search_paths()
                  for f in pathlib.Path(folder).glob("*_post.py"))


def load(name, file):
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def module(name, **contents):
    made = types.ModuleType(name)
    vars(made).update(contents)
    sys.modules[name] = made
    parent, _, last = name.rpartition(".")
    if parent:
        setattr(sys.modules[parent], last, made)
    return made


def clean():
    for name in list(sys.modules):
        if name.partition(".")[0] in ("FreeCAD", "Path", "PathScripts"):
            del sys.modules[name]
    console = Console()
    module("FreeCAD", Console=console, GuiUp=False)
    return console


def preferences():
    return {"searchPathsPost": search_paths, "allAvailablePostProcessors": available}


class LoadedScript:
    """What PostProcessor.load of 0.20 and 0.21 gives."""

    @staticmethod
    def load(name):
        loaded = LoadedScript()
        folder = next(f for f in search_paths() if os.path.exists(f"{f}/{name}_post.py"))
        loaded.script = load(f"{name}_post", f"{folder}/{name}_post.py")
        return loaded

    def export(self, objects, filename, arguments):
        return self.script.export(objects, filename, arguments)


def version_0_20():
    console = clean()
    module("PathScripts")
    module("PathScripts.PathPostProcessor", PostProcessor=LoadedScript)
    module("PathScripts.PathPreferences", **preferences())
    return load("batten_post", SCRIPT), console


def version_0_21():
    console = clean()
    module("Path")
    module("Path.Preferences", **preferences())
    module("Path.Post")
    module("Path.Post.Processor", PostProcessor=LoadedScript)
    return load("batten_post", SCRIPT), console


class Job:
    def __init__(self, arguments, parts=("allitems",), label="Job"):
        self.PostProcessorArgs = arguments
        self.parts = parts
        self.Label = label


class PostProcessor:
    """Base class of 1.0 and later."""

    def __init__(self, job, tooltip, tooltipargs, units, *args, **kwargs):
        self._tooltip, self._tooltipargs, self._units = tooltip, tooltipargs, units
        self._job = job["job"] if isinstance(job, dict) else job
        self._operations = job["operations"] if isinstance(job, dict) else None

    @property
    def tooltip(self):
        raise NotImplementedError

    @property
    def tooltipArgs(self):
        raise NotImplementedError

    def _buildPostList(self):
        return [(part, [part]) for part in self._job.parts]

    def export(self):
        raise NotImplementedError


class WrapperPost(PostProcessor):
    """A post that is a script."""

    def __init__(self, job, script, name):
        super().__init__(job, "", "", None)
        self.script_module = load(name, script)

    @property
    def tooltip(self):
        return getattr(self.script_module, "TOOLTIP", "")

    def export(self):
        return [(part, self.script_module.export(objects, "-", self._job.PostProcessorArgs))
                for part, objects in self._buildPostList()]


class PostProcessorFactory:
    @staticmethod
    def get_post_processor(job, name):
        for folder in search_paths():
            script = os.path.join(folder, f"{name}_post.py")
            try:
                loaded = load(f"{name}_post", script)
            except (FileNotFoundError, ImportError):
                continue
            try:
                return getattr(loaded, name.title())(job)
            except AttributeError:
                return WrapperPost(job, script, f"{name}_post")
        return None


def version_1_0():
    console = clean()
    module("Path")
    module("Path.Preferences", **preferences())
    module("Path.Post")
    module("Path.Post.Processor", PostProcessor=PostProcessor, WrapperPost=WrapperPost,
           PostProcessorFactory=PostProcessorFactory)
    return console


def post_process(job, name, folder):
    """The files that the command of 1.0 would write, by their names; None: it was given up."""
    post = PostProcessorFactory.get_post_processor(job, name)
    data = post.export()
    if not data:
        return None
    written = {}
    for part, gcode in data:
        if gcode is None:
            continue
        newline = None
        if gcode[:2] == "\n\n":
            newline, gcode = "", gcode[2:]
        elif "\r" in gcode:
            newline = ""
        file = folder / f"{part}.nc"
        with open(file, "w", encoding="utf-8", newline=newline) as out:
            out.write(gcode)
        written[part] = file.read_bytes()
    return written
