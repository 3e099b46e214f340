"""Run by freecadcmd: a job with a profile along a B-spline, an adaptive pocket and an engraving, posted
by FreeCAD's own post and by the Batten post into the folder REAL_JOB. FreeCAD 0.20 and 0.21.

Writes old.nc, new.nc, for each [post, target, options] in REAL_JOB_POSTS old/POST.nc, POST.nc and POST.json (or
POST.txt, why there is none), and told.txt with what went wrong; freecadcmd itself hides it."""

import json
import os
import sys
import traceback

OUT = os.environ["REAL_JOB"]
ARGUMENTS = os.environ["REAL_JOB_ARGUMENTS"]


def modules():
    import Path
    try:
        import Path.Main.Job as job
        import Path.Op.Adaptive as adaptive
        import Path.Op.Engrave as engrave
        import Path.Op.Profile as profile
        import Path.Tool.Bit as bit
        import Path.Tool.Controller as controller
        from Path.Post.Processor import PostProcessor
    except ImportError:
        import PathScripts.PathAdaptive as adaptive
        import PathScripts.PathHelix  # these three are there in a window; the post heidenhain needs them
        import PathScripts.PathMillFace
        import PathScripts.PathProfileEdges
        import PathScripts.PathEngrave as engrave
        import PathScripts.PathJob as job
        import PathScripts.PathProfile as profile
        import PathScripts.PathToolBit as bit
        import PathScripts.PathToolController as controller
        from PathScripts.PathPostProcessor import PostProcessor
    return Path, job, adaptive, engrave, profile, bit, controller, PostProcessor


def model(document):
    """A plate with a wavy outline by one closed B-spline, and a round-cornered pocket in it."""
    import FreeCAD
    import Part
    from math import cos, pi, sin
    points = []
    for i in range(24):
        angle = 2 * pi * i / 24
        radius = 32 + 5 * cos(3 * angle) + 2 * sin(5 * angle)
        points.append(FreeCAD.Vector(radius * cos(angle), radius * sin(angle), 0))
    outline = Part.BSplineCurve()
    outline.interpolate(Points=points, PeriodicFlag=True)
    body = Part.Face(Part.Wire([outline.toShape()])).extrude(FreeCAD.Vector(0, 0, 8))
    pocket = Part.makeBox(26, 18, 4, FreeCAD.Vector(-13, -9, 4))
    upright = [e for e in pocket.Edges if abs(e.BoundBox.ZLength - 4) < 1e-6]
    plate = document.addObject("Part::Feature", "Plate")
    plate.Shape = body.cut(pocket.makeFillet(5, upright))
    return plate


def swung_line(document):
    """What is engraved: an open B-spline on the top of the plate."""
    import FreeCAD
    import Part
    curve = Part.BSplineCurve()
    curve.interpolate([FreeCAD.Vector(-20 + 5 * i, (-1) ** i * 3 + 17, 8) for i in range(9)])
    line = document.addObject("Part::Feature", "Engraving")
    line.Shape = Part.Wire([curve.toShape()])
    return line


def set_value(operation, **values):
    for name, value in values.items():
        operation.setExpression(name, None)
        setattr(operation, name, value)


def face_at(shape, height, upright=False):
    for number, face in enumerate(shape.Faces, 1):
        box = face.BoundBox
        if upright and box.ZLength > height - 1e-6:
            return "Face%d" % number
        if not upright and abs(box.ZMin - height) < 1e-6 and abs(box.ZMax - height) < 1e-6:
            return "Face%d" % number
    raise LookupError("no face at %g" % height)


def make_job(document):
    import FreeCAD
    Path, Job, Adaptive, Engrave, Profile, Bit, Controller, _ = modules()
    plate, line = model(document), swung_line(document)
    document.recompute()
    job = Job.Create("Job", [plate], None)
    job.GeometryTolerance = 0.001
    tool = job.Tools.Group[0]
    tool.Tool.Diameter = 6
    tool.HorizFeed, tool.VertFeed = "1500 mm/min", "300 mm/min"
    tool.HorizRapid, tool.VertRapid = "3000 mm/min", "1500 mm/min"
    tool.SpindleSpeed = 8000
    document.recompute()

    clone = job.Model.Group[0]
    profile = Profile.Create("Profile", parentJob=job)
    profile.Base = [(clone, face_at(clone.Shape, 8, upright=True))]
    set_value(profile, StartDepth=8, FinalDepth=4, StepDown=4)
    pocket = Adaptive.Create("Adaptive", parentJob=job)
    pocket.Base = [(clone, face_at(clone.Shape, 4))]
    set_value(pocket, StartDepth=8, FinalDepth=4, StepDown=4)
    engraving = Engrave.Create("Engrave", parentJob=job)
    engraving.BaseShapes = [line]
    set_value(engraving, StartDepth=8, FinalDepth=7.8, StepDown=1)
    operations = [profile, pocket, engraving]
    for operation in operations:
        operation.ToolController = tool
    document.recompute()
    for operation in operations:
        if len(operation.Path.Commands) < 5:
            raise RuntimeError("%s has no path" % operation.Label)
    print("commands:", [len(o.Path.Commands) for o in operations])
    return job, tool, operations


def posted(job, tool, operations):
    """What the command of the menu gives to a post: fixture, tool controller, operations."""
    import FreeCAD
    Path = modules()[0]

    class Fixture:
        Name = Label = "Fixture"
        Proxy = None  # read by the post heidenhain
        InList = []  # read by the post KineticNCBeamicon2

    fixture = Fixture()
    fixture.Path = Path.Path([Path.Command("G54"), Path.Command("G0 Z20")])
    objects = [fixture, tool] + operations
    loader = modules()[7]
    loader.load("linuxcnc").export(objects, os.path.join(OUT, "old.nc"),
                                   "--no-header --no-show-editor")
    loader.load("batten").export(objects, os.path.join(OUT, "new.nc"),
                                 ARGUMENTS + " -- --no-header")
    try:
        loader.load("batten").export(objects, os.path.join(OUT, "refused.nc"),
                                     "--target nonesuch --post linuxcnc")
    except RuntimeError as refusal:
        with open(os.path.join(OUT, "refusal.txt"), "w") as file:
            file.write(str(refusal))
    tool.HorizFeed = "6000 mm/min"
    if not hasattr(tool.Tool, "ToolType"):  # read by the post fanuc
        tool.Tool.addProperty("App::PropertyString", "ToolType")
        tool.Tool.ToolType = "EndMill"
    FreeCAD.ActiveDocument.recompute()
    post_each(loader, objects[:2] + [operations[0], operations[2]])


def post_each(loader, objects):
    """Without the adaptive pocket, whose path is another one in each run. old/POST.nc is what the other
    post wrote."""
    try:
        from Path.Preferences import allAvailablePostProcessors
    except ImportError:
        from PathScripts.PathPreferences import allAvailablePostProcessors
    with open(os.path.join(OUT, "posts.txt"), "w") as file:
        file.write(" ".join(allAvailablePostProcessors()))
    for post, target, options in json.loads(os.environ["REAL_JOB_POSTS"]):
        place = os.path.join(OUT, post)
        try:
            loader.load("batten").export(
                objects, place + ".nc",
                "--post %s --target %s --json %s.json %s" % (post, target, place, options))
            loader.load("batten").export(objects, os.path.join(OUT, "old", post + ".nc"),
                                         "--post %s --target nonesuch "
                                         "--or-unsmoothed" % post)
        except BaseException as error:
            with open(place + ".txt", "w") as file:
                file.write("%s: %s" % (type(error).__name__, error))


def main():
    import FreeCAD
    document = FreeCAD.newDocument("Plate")
    with open(os.path.join(OUT, "version.txt"), "w") as file:
        file.write(".".join(FreeCAD.Version()[:3]).replace(" ", ""))
    posted(*make_job(document))


try:
    main()
except BaseException:
    with open(os.path.join(OUT, "told.txt"), "w") as told:
        traceback.print_exc(file=told)
sys.stdout.flush()
os._exit(0)  # freecadcmd would run the script a second time after a failure, or open a console
