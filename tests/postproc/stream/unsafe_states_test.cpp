// States in which the text is not the path, or in which each point was meant: nothing is rewritten
// there, with the state as the reason; in front of them and behind them smoothing goes on.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/constructs.h"

namespace batten::postproc {
namespace {

constexpr const char* kLinuxCnc = "linuxcnc";
constexpr const char* kFanuc = "fanuc";
constexpr const char* kSiemens = "siemens";
constexpr const char* kHeidenhain = "heidenhain";

class UnsafeTable : public testing::TestWithParam<Construct> {};

TEST_P(UnsafeTable, KeepsEveryByteForItsReason) { expect_kept_construct(GetParam()); }

// A state that `on` begins and `off` ends.
Construct between(const char* name, const char* target, std::string on, std::string reason,
                  std::string state, std::string off) {
  return {name, target, std::move(on), std::move(reason), false, std::move(state), std::move(off)};
}

INSTANTIATE_TEST_SUITE_P(
    CutterCompensation, UnsafeTable,
    testing::Values(
        between("Left", kFanuc, "G41 D1", "cutter-compensation", "cutter-compensation", "G40"),
        between("Right", kLinuxCnc, "G42 D1", "cutter-compensation", "cutter-compensation", "G40"),
        between("Dynamic", kLinuxCnc, "G41.1 D3", "cutter-compensation", "cutter-compensation",
                "G40"),
        between("Left", kSiemens, "G41 D1", "tool-change", "cutter-compensation", "G40"),
        between("Left", kHeidenhain, "L X+31 Y+0 RL", "cutter-compensation", "cutter-compensation",
                "L X+60 Y+0 R0"),
        between("Right", kHeidenhain, "L X+31 Y+0 RR", "cutter-compensation", "cutter-compensation",
                "L X+60 Y+0 R0")),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    KinematicFrames, UnsafeTable,
    testing::Values(
        between("ToolCentre", kFanuc, "G43.4 H1", "tool-change", "tool-center-point", "G49"),
        between("ToolVector", kFanuc, "G43.5 H1", "tool-change", "tool-center-point", "G49"),
        between("Tilted", kFanuc, "G68.2 X0 Y0 Z0 I0 J30. K0", "tilted-plane", "tilted-plane",
                "G69"),
        between("ToolCentre", kSiemens, "TRAORI", "tool-center-point", "tool-center-point",
                "TRAFOOF"),
        between("Tilted", kSiemens, "CYCLE800(1,\"TC1\",0,57,0,0,0,0,30,0,0,0,0,-1)",
                "tilted-plane", "tilted-plane", "CYCLE800()"),
        between("TiltedByTool", kSiemens, "TOROT", "tilted-plane", "tilted-plane", "TOROTOF"),
        between("ToolCentre", kHeidenhain, "M128", "misc-function", "tool-center-point", "M129"),
        between("Tilted", kHeidenhain, "PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY", "tilted-plane",
                "tilted-plane", "PLANE RESET STAY")),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    Axes, UnsafeTable,
    testing::Values(Construct{"Rotary", kFanuc, "G1 A30.", "other-axis"},
                    Construct{"RotaryBesideX", kFanuc, "G1 X31. C30.", "other-axis"},
                    Construct{"Parallel", kLinuxCnc, "G1 U1.", "other-axis"},
                    Construct{"Rotary", kSiemens, "G1 A=30", "other-axis"},
                    Construct{"Vector", kSiemens, "G1 X31 A3=0 B3=0 C3=1", "other-axis"},
                    Construct{"Numbered", kSiemens, "G1 X1=31", "other-axis"},
                    Construct{"Rotary", kHeidenhain, "L X+31 C+30", "other-axis"},
                    Construct{"Vector", kHeidenhain, "LN X+31 Y+0 Z-1 NX+0 NY+0 NZ+1",
                              "foreign-words"},
                    Construct{"Extruder", "marlin", "G1 X31. E1.", "extruder"}),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    DistancesAndFeeds, UnsafeTable,
    testing::Values(
        between("Incremental", kFanuc, "G91", "state-change", "incremental-distance", "G90"),
        between("Incremental", kSiemens, "G91", "state-change", "incremental-distance", "G90"),
        Construct{"Increment", kHeidenhain, "L IX+1", "foreign-words"},
        between("InverseTime", kFanuc, "G93", "state-change", "inverse-time-feed", "G94"),
        between("InverseTime", kSiemens, "G93", "state-change", "inverse-time-feed", "G94"),
        between("PerRevolution", kFanuc, "G95", "state-change", "feed-per-revolution", "G94"),
        between("PerRevolution", kSiemens, "G95", "state-change", "feed-per-revolution", "G94"),
        between("PerRevolution", kHeidenhain, "M136", "misc-function", "feed-per-revolution",
                "M137"),
        between("SurfaceSpeed", kFanuc, "G96 S100", "spindle", "constant-surface-speed", "G97"),
        between("SurfaceSpeed", kSiemens, "G96 S100", "spindle", "constant-surface-speed", "G97"),
        between("SurfaceSpeedLinearFeed", kSiemens, "G961 S100", "spindle",
                "constant-surface-speed", "G971\nG94"),
        Construct{"Thread", kFanuc, "G33 Z-2. F1.5", "threading"},
        Construct{"Thread", kSiemens, "G33 Z-2 K1.5", "threading"},
        Construct{"Tapping", kSiemens, "G331 Z-2 K1.5", "threading"},
        Construct{"ThreadCycle", kFanuc, "G76 P10060 Q100 R0.1", "threading"}),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    Coordinates, UnsafeTable,
    testing::Values(
        between("PolarInterpolation", kFanuc, "G12.1", "polar-coordinates", "polar-coordinates",
                "G13.1"),
        between("PolarCoordinates", kFanuc, "G16", "polar-coordinates", "polar-coordinates", "G15"),
        between("Cylinder", kFanuc, "G07.1 C20.", "cylindrical", "cylindrical", "G07.1 C0"),
        between("PolarInterpolation", kSiemens, "TRANSMIT", "polar-coordinates",
                "polar-coordinates", "TRAFOOF"),
        between("Cylinder", kSiemens, "TRACYL(40)", "cylindrical", "cylindrical", "TRAFOOF"),
        Construct{"PolarEnd", kSiemens, "G111 X0 Y0\nG1 AP=45 RP=10", "state-change"},
        between("Scaling", kFanuc, "G51 X0 Y0 Z0 P2000", "scaling", "scaling", "G50"),
        between("Rotation", kFanuc, "G68 X0 Y0 R30.", "rotation", "rotation", "G69"),
        between("Mirror", kFanuc, "G51.1 X0", "mirror", "mirror", "G50.1 X0"),
        between("MirrorPerhaps", kFanuc, "M21", "misc-function", "state-unknown", "M23"),
        between("Scaling", kSiemens, "SCALE X2 Y2", "scaling", "scaling", "SCALE"),
        between("Rotation", kSiemens, "ROT Z30", "rotation", "rotation", "TRANS"),
        between("AddedRotation", kSiemens, "AROT Z30", "rotation", "rotation", "ROT"),
        between("Mirror", kSiemens, "MIRROR X0", "mirror", "mirror", "MIRROR"),
        Construct{"Shift", kSiemens, "TRANS X5", "coordinate-change"},
        between("Diameter", kLinuxCnc, "G7", "state-change", "lathe-diameter", "G8"),
        between("Diameter", kSiemens, "DIAMON", "lathe-diameter", "lathe-diameter", "DIAMOF"),
        between("Mirror", kHeidenhain, "CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X", "mirror", "mirror",
                "CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1"),
        between("Rotation", kHeidenhain, "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+30", "rotation",
                "rotation", "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0"),
        between("Scaling", kHeidenhain, "CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.5", "scaling",
                "scaling", "CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 1")),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    Cycles, UnsafeTable,
    testing::Values(
        // G1 ends it there.
        Construct{"Drilling", kFanuc, "G81 X31. Y0 Z-5. R2. F100.", "canned-cycle"},
        Construct{"ModalMacro", kFanuc, "G66 P9010", "modal-macro", false, "state-unknown"},
        Construct{"Drilling", kSiemens, "CYCLE81(5,0,2,-5)", "canned-cycle"},
        between("DrillingAtEachPlace", kSiemens, "MCALL CYCLE81(5,0,2,-5)", "canned-cycle",
                "modal-macro", "MCALL"),
        Construct{"Pocket", kSiemens, "POCKET3(5,0,1,-5,40,30,8,60,15,0,3,0,0,1000,100,0,11)",
                  "canned-cycle"},
        Construct{"CalledOnce", kHeidenhain,
                  "CYCL DEF 200 DRILLING Q200=2 Q201=-5\nL X+31 Y+0 FMAX M99", "canned-cycle"}),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    Stops, UnsafeTable,
    testing::Values(between("ExactPath", kLinuxCnc, "G61", "state-change", "exact-stop", "G64"),
                    between("ExactStop", kLinuxCnc, "G61.1", "state-change", "exact-stop", "G64"),
                    between("ExactStop", kSiemens, "G60", "state-change", "exact-stop", "G642"),
                    Construct{"OneStop", kFanuc, "G9 G1 X31.", "exact-stop"},
                    Construct{"OneStop", kSiemens, "G9 G1 X31", "exact-stop"},
                    Construct{"Dwell", kFanuc, "G4 P500", "dwell"},
                    Construct{"Dwell", kSiemens, "G4 F0.5", "dwell"},
                    Construct{"Dwell", kHeidenhain,
                              "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 0.5", "dwell"},
                    Construct{"Rapid", kFanuc, "G0 Z5.\nG0 X31. Y0\nG1 Z-1.", "rapid"},
                    Construct{"Probe", kLinuxCnc, "G38.2 Z-5.", "probe"},
                    Construct{"Probe", kFanuc, "G31 Z-5.", "probe"},
                    Construct{"Stop", kFanuc, "M0", "program-end"},
                    Construct{"Stop", kSiemens, "M0", "program-end"},
                    Construct{"Stop", kHeidenhain, "STOP M0", "program-end"}),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    SmoothingByTheControl, UnsafeTable,
    testing::Values(between("Fit", kFanuc, "G05.1 Q2 X0 Y0 Z0", "control-smoothing",
                            "control-smoothing", "G05.1 Q0"),
                    between("HighSpeed", kFanuc, "G05 P10000", "control-smoothing",
                            "control-smoothing", "G05 P0"),
                    between("SuperNurbs", "okuma", "G131 F5000 J1 E0.01", "control-smoothing",
                            "control-smoothing", "G130"),
                    between("Compressor", kSiemens, "COMPCAD", "control-smoothing",
                            "control-smoothing", "COMPOF"),
                    between("CompressorOfCurves", kSiemens, "G642 COMPCURV", "state-change",
                            "control-smoothing", "COMPOF"),
                    Construct{"CompressorThatIsAllowed",
                              kSiemens,
                              "COMPCAD",
                              "control-smoothing",
                              true,
                              {},
                              {},
                              "control-smoothing"},
                    Construct{"FitThatIsAllowed",
                              kFanuc,
                              "G05.1 Q2 X0 Y0 Z0",
                              "control-smoothing",
                              true,
                              {},
                              {},
                              "control-smoothing"},
                    Construct{"Spline", kSiemens, "BSPLINE X31 Y0\nX32 Y1\nG1 X33 Y0", "spline"},
                    Construct{"Tolerance", kHeidenhain,
                              "CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.02", "control-smoothing"},
                    Construct{"HighSpeedCycle", kSiemens, "CYCLE832(0.02,1,1)",
                              "control-smoothing"},
                    Construct{"ContourTolerance", kSiemens, "CTOL=0.02", "control-smoothing"},
                    Construct{"AxisTolerance", kSiemens, "ATOL[X]=0.02", "control-smoothing"}),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    Origins, UnsafeTable,
    testing::Values(Construct{"MachinePlace", kFanuc, "G53 G0 Z0", "coordinate-change"},
                    Construct{"Home", kFanuc, "G28 Z0", "coordinate-change"},
                    Construct{"SecondHome", kFanuc, "G30 Z0", "coordinate-change"},
                    Construct{"Set", kFanuc, "G92 X0 Y0", "coordinate-change"},
                    Construct{"LocalOffset", kFanuc, "G52 X5. Y5.", "coordinate-change"},
                    Construct{"Data", kFanuc, "G10 L2 P1 X5.", "coordinate-change"},
                    Construct{"WorkOffset", kFanuc, "G55", "coordinate-change"},
                    Construct{"WorkOffset", kSiemens, "G505", "coordinate-change"},
                    Construct{"MachinePlace", kSiemens, "G0 SUPA Z0 D0", "not-understood"},
                    Construct{"Home", kSiemens, "G74 Z1=0", "coordinate-change"},
                    Construct{"Preset", kHeidenhain, "CYCL DEF 247 PRESET ~\n  Q339=+2",
                              "coordinate-change"},
                    Construct{"Shift", kHeidenhain, "CYCL DEF 7.0 DATUM\nCYCL DEF 7.1 X+5",
                              "coordinate-change"},
                    Construct{"MachinePlace", kHeidenhain, "L Z+0 R0 FMAX M91", "foreign-words"}),
    &construct_name);

INSTANTIATE_TEST_SUITE_P(
    Words, UnsafeTable,
    testing::Values(Construct{"Plane", kFanuc, "G18", "state-change"},
                    Construct{"Plane", kSiemens, "G18", "state-change"},
                    Construct{"Units", kFanuc, "G20\nG21", "state-change"},
                    Construct{"Units", kSiemens, "G70\nG71", "state-change"},
                    Construct{"Speed", kFanuc, "S9000", "spindle"},
                    Construct{"Speed", kSiemens, "S2=9000", "spindle"},
                    Construct{"Tool", kFanuc, "T2 M6", "tool-change"},
                    Construct{"Tool", kSiemens, "T2 D1", "tool-change"},
                    Construct{"Tool", kHeidenhain, "TOOL CALL 4 Z S9000", "tool-change"},
                    Construct{"Length", kFanuc, "G43 H2", "tool-change"},
                    Construct{"Coolant", kFanuc, "M8", "coolant"},
                    Construct{"Coolant", kHeidenhain, "M8", "coolant"},
                    Construct{"Override", kLinuxCnc, "M48", "misc-function"},
                    Construct{"Output", kLinuxCnc, "M62 P1", "misc-function"},
                    Construct{"Output", kSiemens, "M62", "misc-function"},
                    Construct{"LaserBesideAMove", kLinuxCnc, "G1 X31. S500", "spindle"}),
    &construct_name);

// A program that others call begins in a state that nobody knows.
TEST(UnsafePrograms, ThatOthersCallAreKept) {
  const std::pair<const char*, const char*> ends[] = {
      {"fanuc", "M99"}, {"siemens", "M17"}, {"siemens", "RET"}};
  for (const auto& [target, end] : ends) {
    SCOPED_TRACE(end);
    const auto language = options_for(target).target->language;
    std::string before = head_of(language) + wave_part(language, 0) + end + "\n";
    const SmoothResult result = smoothed(before, options_for(target));
    EXPECT_EQ(result.text, before);
    EXPECT_EQ(reason_at(inspected(before, options_for(target)), 20), "loop-body");
  }
}

// The first motion of a file leads from nowhere.
TEST(UnsafePrograms, HaveAFirstMotionFromNowhere) {
  const std::string before =
      "G21 G90 G17 F2000.\nG1 X0. Y0.\n" + wave_part(gcode::Language::kRs274, 0) + "M30\n";
  const SmoothResult result = smoothed(before, options_for("fanuc"));
  EXPECT_EQ(reason_at(inspected(before, options_for("fanuc")), 2), "position-unknown");
  EXPECT_TRUE(is_rewritten_within(result, 3, 200));
}

}  // namespace
}  // namespace batten::postproc
