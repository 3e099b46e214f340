"""post_test.py BATTEN   The FreeCAD post against stand-ins for FreeCAD 0.20, 0.21 and 1.0."""

import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock

import stand_in

sys.path.insert(0, str(stand_in.POSTS))
import wave_program  # noqa: E402
sys.path.pop(0)

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARGUMENTS = "--target linuxcnc --tolerance 0.01"
WAYS_TO_GIVE = ("grbl", "reprapfirmware", "mach4")  # a file, a file and its name, a returned text


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.kept = tempfile.TemporaryDirectory()
        self.addCleanup(self.kept.cleanup)
        self.folder = pathlib.Path(self.kept.name)

    def assert_smoothed(self, old, new):
        """`new` is proved against `old`, and shorter by a quarter at least."""
        (self.folder / "old.nc").write_bytes(old)
        (self.folder / "new.nc").write_bytes(new)
        done = subprocess.run([os.environ["BATTEN"], "verify", self.folder / "old.nc",
                               self.folder / "new.nc", "--tolerance", "0.01"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(len(new), 0.75 * len(old))


class Version10(WithFolder):
    def setUp(self):
        super().setUp()
        self.console = stand_in.version_1_0()

    def post(self, arguments, name="batten", **more):
        job = stand_in.Job(arguments, **more)
        files = stand_in.post_process(job, name, self.folder)
        self.assertEqual(job.PostProcessorArgs, arguments, "the document is as it was")
        return files

    def refused(self, arguments, message):
        before = sorted(self.folder.iterdir())
        self.assertIsNone(self.post(arguments))
        self.assertEqual(sorted(self.folder.iterdir()), before)
        self.assertIn(message, self.console.text("error"))

    def test_the_class_is_found_and_a_script_is_smoothed(self):
        old = self.post("--no-show-editor", "linuxcnc")["allitems"]
        self.assert_smoothed(old, self.post(ARGUMENTS)["allitems"])
        self.assertIn("-> smooth-Job-allitems.nc, for linuxcnc", self.console.text("message"))

    def test_a_class_is_smoothed_with_its_own_arguments(self):
        old = self.post("--precision 4", "classy")["allitems"]
        self.assertIn(b"0.2500", old)
        new = self.post(ARGUMENTS + " --post classy -- --precision 4")["allitems"]
        self.assert_smoothed(old, new)

    def test_chosen_operations_reach_the_other_post(self):
        job = {"job": stand_in.Job(ARGUMENTS + " --post classy"), "operations": ["Profile"]}
        self.assertIn(b"(allitems: Profile)", stand_in.post_process(job, "batten",
                                                                    self.folder)["allitems"])

    def test_every_part_is_smoothed(self):
        old = self.post("", "classy", parts=("G54", "G55"))
        new = self.post(ARGUMENTS + " --post=classy", parts=("G54", "G55"))
        self.assertEqual(list(new), ["G54", "G55"])
        for part in new:
            self.assert_smoothed(old[part], new[part])

    def test_line_ends_stay(self):
        new = self.post(ARGUMENTS + " -- --crlf")["allitems"]
        self.assertIn(b"\r\n", new)
        self.assertNotIn(b"\r\r", new)
        kept = stand_in.PostProcessorFactory.get_post_processor(
            stand_in.Job(ARGUMENTS + " -- --keep-line-ends"), "batten").export()[0][1]
        self.assertTrue(kept.startswith("\n\n("), kept[:20])

    def test_refusals_write_nothing_and_say_why(self):
        self.refused("", "no --target given")
        self.refused("--target linuxcnc --tolerance 0,01", "not a comma")
        self.refused("--target linuxcn --post linuxcnc", "did you mean 'linuxcnc'?")
        self.refused(ARGUMENTS + " -- --no-units", "units-missing")
        self.refused(ARGUMENTS + " -- --no-such-option", "ended with code 2")
        self.refused(ARGUMENTS + " --post nonesuch", "one of: classy, grbl, linuxcnc, mach3")
        self.refused("--target hurco", "--target: there is no post 'hurco'")
        self.refused(ARGUMENTS + " --post batten", "is this post")
        self.refused(ARGUMENTS + " --batten /no/such/program", "/no/such/program")
        self.refused(ARGUMENTS + " --timeout soon", "expected seconds")
        self.refused(ARGUMENTS + " -o /tmp/other.nc", "FreeCAD decides")
        self.refused(ARGUMENTS + ' --machine "x', "No closing quotation")
        self.refused(ARGUMENTS + " --post", "no value given")

    def test_a_slow_batten_is_stopped(self):
        slow = self.folder / "slow"
        slow.write_text("#!/bin/sh\nexec sleep 20\n")
        slow.chmod(0o755)
        self.refused(ARGUMENTS + f" --batten {slow} --timeout 0.2", "not done after 0.2 s")

    def test_unsmoothed_only_when_asked(self):
        old = self.post("--no-show-editor --no-units", "linuxcnc")["allitems"]
        new = self.post(ARGUMENTS + " --or-unsmoothed -- --no-units")["allitems"]
        self.assertEqual(new, old)
        self.assertIn("units-missing", self.console.text("warning"))

    def test_a_part_without_a_program_is_passed_on(self):
        self.assertEqual(self.post(ARGUMENTS + " --post silent"), {})

    def test_every_way_to_give_a_text_is_taken(self):
        here = sorted(os.listdir())
        for target in WAYS_TO_GIVE:
            new = self.post(f"--target {target} --tolerance 0.01 --prefer size")["allitems"]
            self.assert_smoothed(wave_program.gcode().encode(), new)
        self.assertEqual(sorted(os.listdir()), here, "no file named -")

    def test_a_post_has_its_target(self):
        self.post("--post mach3_mach4")
        self.assertIn("for mach3", self.console.text("message"))
        self.post("--post linuxcnc --tolerance 0.02")
        self.assertIn("for linuxcnc", self.console.text("message"))

    def test_a_post_named_as_the_target_goes_first(self):
        post = stand_in.load("batten_post", stand_in.SCRIPT)
        with unittest.mock.patch.object(stand_in, "available", lambda: ["fanuc", "haas"]):
            preferences = types.SimpleNamespace(allAvailablePostProcessors=stand_in.available)
            self.assertEqual(post.post_for(post.Arguments("--target haas"), preferences), "haas")
            self.assertEqual(post.post_for(post.Arguments("--target mazak"), preferences), "fanuc")

    def test_names_of_posts_are_of_targets_that_there_are(self):
        post = stand_in.load("batten_post", stand_in.SCRIPT)
        done = subprocess.run([os.environ["BATTEN"], "targets"], capture_output=True, text=True)
        targets = {line.split()[0] for line in done.stdout.splitlines()[1:] if line}
        self.assertLessEqual(set(post.POST_OF_TARGET), targets)
        self.assertLessEqual(set(post.TARGET_OF_POST.values()), targets)

    def test_help_is_safe_in_the_dialog(self):
        post = stand_in.PostProcessorFactory.get_post_processor(stand_in.Job(None), "batten")
        for text in (post.tooltip, post.tooltipArgs):
            self.assertTrue(text)
            self.assertNotIn("%", text)


class Scripts(WithFolder):
    """0.20 and 0.21: the script writes the file."""

    versions = (stand_in.version_0_20, stand_in.version_0_21)

    def test_writes_the_file_and_returns_the_text(self):
        for version in self.versions:
            post, _ = version()
            old = stand_in.LoadedScript.load("linuxcnc").export(["Job"], "-", "--no-show-editor")
            file = self.folder / "part.nc"
            text = post.export(["Job"], str(file), ARGUMENTS)
            self.assertEqual(file.read_text(), text)
            self.assert_smoothed(old.encode(), text.encode())
            self.assertFalse(hasattr(post, "Batten"))

    def test_every_way_to_give_a_text_is_taken(self):
        for version in self.versions:
            post, _ = version()
            here = sorted(os.listdir())
            for target in WAYS_TO_GIVE:
                file = self.folder / "part.nc"
                post.export(["Job"], str(file),
                            f"--target {target} --tolerance 0.01 --prefer size")
                self.assert_smoothed(wave_program.gcode().encode(), file.read_bytes())
                post.export(["Job"], "-", f"--target {target} --tolerance 0.01")
            self.assertEqual(sorted(os.listdir()), here, "no file named -")

    def test_a_dash_is_no_file(self):
        for version in self.versions:
            post, _ = version()
            here = sorted(os.listdir())
            self.assertIn("G21", post.export(["Job"], "-", ARGUMENTS))
            self.assertEqual(sorted(os.listdir()), here)

    def test_a_refusal_raises_and_leaves_no_file_of_an_earlier_post(self):
        for version in self.versions:
            post, console = version()
            file = self.folder / "part.nc"
            file.write_text("G21\n")
            with self.assertRaisesRegex(RuntimeError, "units-missing"):
                post.export(["Job"], str(file), ARGUMENTS + " -- --no-units")
            self.assertFalse(file.exists())
            self.assertIn("part.nc:", console.text("error"))
            with self.assertRaisesRegex(RuntimeError, "gave no program"):
                post.export(["Job"], "-", ARGUMENTS + " --post silent")


class Installed(WithFolder):
    def test_calls_the_program_that_installed_it(self):
        done = subprocess.run([os.environ["BATTEN"], "freecad", "install", "--folder", self.folder],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        installed = (self.folder / "batten_post.py").read_text()
        source = stand_in.SCRIPT.read_text()
        name = os.path.realpath(os.environ["BATTEN"])
        self.assertEqual(installed, source.replace('\nBATTEN = ""\n', f'\nBATTEN = "{name}"\n'))

    def test_leaves_another_script_of_that_name(self):
        other = self.folder / "batten_post.py"
        other.write_text("# mine\n")
        command = [os.environ["BATTEN"], "freecad", "install", "--folder", self.folder]
        self.assertEqual(subprocess.run(command, capture_output=True).returncode, 4)
        self.assertEqual(other.read_text(), "# mine\n")
        self.assertEqual(subprocess.run(command + ["--force"], capture_output=True).returncode, 0)
        self.assertEqual(subprocess.run(command, capture_output=True).returncode, 0, "ours")

    def test_uninstall_removes_ours_only(self):
        def run(*words):
            done = subprocess.run([os.environ["BATTEN"], "freecad", *words, "--folder", self.folder],
                                  capture_output=True, text=True)
            return done.returncode, done.stderr

        script = self.folder / "batten_post.py"
        self.assertEqual(run("install")[0], 0)
        code, said = run("uninstall")
        self.assertEqual(code, 0)
        self.assertIn("removed", said)
        self.assertFalse(script.exists())
        code, said = run("uninstall")
        self.assertEqual(code, 0)
        self.assertIn("nothing to remove", said)
        script.write_text("# mine\n")
        self.assertEqual(run("uninstall")[0], 4)
        self.assertEqual(script.read_text(), "# mine\n")
        self.assertEqual(run("uninstall", "--force")[0], 0)
        self.assertFalse(script.exists())
        self.assertEqual(run("remove")[0], 1)

    def test_asks_the_freecad_that_is_named(self):
        """A stand-in for FreeCADCmd that runs the question with a FreeCAD of its own."""
        macros = self.folder / "data/Macro"
        (self.folder / "FreeCAD.py").write_text(
            "class Group:\n    def GetString(self, name, default):\n        return default\n"
            "def ParamGet(name):\n    return Group()\n"
            "def Version():\n    return ['1', '0', '2', 'g']\n"
            f"def getUserMacroDir():\n    return {str(macros)!r}\n")
        freecad = self.folder / "FreeCADCmd"
        freecad.write_text(f"#!/bin/sh\nPYTHONPATH={self.folder} exec {sys.executable} \"$@\"\n")
        freecad.chmod(0o755)
        done = subprocess.run([os.environ["BATTEN"], "freecad", "install", "--freecad", freecad],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"FreeCAD 1.0.2 keeps macros and posts in {macros}", done.stderr)
        self.assertTrue((macros / "batten_post.py").exists())
        for silent in ("/bin/true", "/no/such/freecad"):
            failed = subprocess.run([os.environ["BATTEN"], "freecad", "install", "--freecad",
                                     silent], capture_output=True, text=True)
            self.assertEqual(failed.returncode, 4)
            self.assertIn(silent, failed.stderr)


if __name__ == "__main__":
    os.environ["BATTEN"] = str(pathlib.Path(sys.argv.pop(1)).resolve())
    sys.dont_write_bytecode = True
    unittest.main()
