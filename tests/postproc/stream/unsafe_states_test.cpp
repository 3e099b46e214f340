// States in which the text is not the path, or in which each point was meant: nothing is rewritten
// there, with the state as the reason; in front of them and behind them smoothing goes on.
#include <gtest/gtest.h>

#include "tests/support/constructs.h"

namespace batten::postproc {
namespace {

class UnsafeTable : public testing::TestWithParam<Construct> {};

TEST_P(UnsafeTable, KeepsEveryByteForItsReason) { expect_kept_construct(GetParam()); }

// Group and name | target | lines | why their first one is kept | why the wave after it is kept
// ("=": for the same reason) | lines after which smoothing goes on | --allow.
constexpr const char* kUnsafe = R"(
CutterCompensation_Left|fanuc|G41 D1|cutter-compensation|=|G40
CutterCompensation_Right|linuxcnc|G42 D1|cutter-compensation|=|G40
CutterCompensation_Dynamic|linuxcnc|G41.1 D3|cutter-compensation|=|G40
CutterCompensation_Left|siemens|G41 D1|tool-change|cutter-compensation|G40
CutterCompensation_Left|heidenhain|L X+31 Y+0 RL|cutter-compensation|=|L X+60 Y+0 R0
CutterCompensation_Right|heidenhain|L X+31 Y+0 RR|cutter-compensation|=|L X+60 Y+0 R0
KinematicFrames_ToolCentre|fanuc|G43.4 H1|tool-change|tool-center-point|G49
KinematicFrames_ToolVector|fanuc|G43.5 H1|tool-change|tool-center-point|G49
KinematicFrames_Tilted|fanuc|G68.2 X0 Y0 Z0 I0 J30. K0|tilted-plane|=|G69
KinematicFrames_ToolCentre|siemens|TRAORI|tool-center-point|=|TRAFOOF
KinematicFrames_Tilted|siemens|CYCLE800(1,"TC1",0,57,0,0,0,0,30,0,0,0,0,-1)|tilted-plane|=|CYCLE800()
KinematicFrames_TiltedByTool|siemens|TOROT|tilted-plane|=|TOROTOF
KinematicFrames_ToolCentre|heidenhain|M128|misc-function|tool-center-point|M129
KinematicFrames_ToolCentreIsNotEndedByReset|heidenhain|M128\nFUNCTION RESET TCPM|misc-function|tool-center-point|M129
KinematicFrames_FunctionIsNotEndedByM129|heidenhain|FUNCTION TCPM F TCP AXIS POS\nM129|tool-center-point|=|FUNCTION RESET TCPM
KinematicFrames_Tilted|heidenhain|PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY|tilted-plane|=|PLANE RESET STAY
Axes_Rotary|fanuc|G1 A30.|other-axis
Axes_RotaryBesideX|fanuc|G1 X31. C30.|other-axis
Axes_Parallel|linuxcnc|G1 U1.|other-axis
Axes_Rotary|siemens|G1 A=30|other-axis
Axes_Vector|siemens|G1 X31 A3=0 B3=0 C3=1|other-axis
Axes_Numbered|siemens|G1 X1=31|other-axis
Axes_Rotary|heidenhain|L X+31 C+30|other-axis
Axes_Vector|heidenhain|LN X+31 Y+0 Z-1 NX+0 NY+0 NZ+1|foreign-words
Axes_Extruder|reprapfirmware|G1 X31. E1.|extruder
DistancesAndFeeds_Incremental|fanuc|G91|state-change|incremental-distance|G90
DistancesAndFeeds_Incremental|siemens|G91|state-change|incremental-distance|G90
DistancesAndFeeds_Increment|heidenhain|L IX+1|foreign-words
DistancesAndFeeds_InverseTime|fanuc|G93|state-change|inverse-time-feed|G94
DistancesAndFeeds_InverseTime|siemens|G93|state-change|inverse-time-feed|G94
DistancesAndFeeds_PerRevolution|fanuc|G95|state-change|feed-per-revolution|G94
DistancesAndFeeds_PerRevolution|siemens|G95|state-change|feed-per-revolution|G94
DistancesAndFeeds_PerRevolution|heidenhain|M136|misc-function|feed-per-revolution|M137
DistancesAndFeeds_SurfaceSpeed|fanuc|G96 S100|spindle|constant-surface-speed|G97
DistancesAndFeeds_SurfaceSpeed|siemens|G96 S100|spindle|constant-surface-speed|G97
DistancesAndFeeds_SurfaceSpeedLinearFeed|siemens|G961 S100|spindle|constant-surface-speed|G971\nG94
DistancesAndFeeds_Thread|fanuc|G33 Z-2. F1.5|threading
DistancesAndFeeds_Thread|siemens|G33 Z-2 K1.5|threading
DistancesAndFeeds_Tapping|siemens|G331 Z-2 K1.5|threading
DistancesAndFeeds_ThreadCycle|fanuc|G76 P10060 Q100 R0.1|threading
Coordinates_PolarInterpolation|fanuc|G12.1|polar-coordinates|=|G13.1
Coordinates_PolarInterpolationIsNotEndedByG15|fanuc|G12.1\nG15|polar-coordinates|=|G13.1
Coordinates_PolarCoordinatesAreNotEndedByG131|fanuc|G16\nG13.1|polar-coordinates|=|G15
Coordinates_PolarCoordinates|fanuc|G16|polar-coordinates|=|G15
Coordinates_Cylinder|fanuc|G07.1 C20.|cylindrical|=|G07.1 C0
Coordinates_PolarInterpolation|siemens|TRANSMIT|polar-coordinates|=|TRAFOOF
Coordinates_Cylinder|siemens|TRACYL(40)|cylindrical|=|TRAFOOF
Coordinates_PolarEnd|siemens|G111 X0 Y0\nG1 AP=45 RP=10|state-change
Coordinates_Scaling|fanuc|G51 X0 Y0 Z0 P2000|scaling|=|G50
Coordinates_Rotation|fanuc|G68 X0 Y0 R30.|rotation|=|G69
Coordinates_Mirror|fanuc|G51.1 X0|mirror|=|G50.1 X0
Coordinates_MirrorPerhaps|fanuc|M21|misc-function|state-unknown|M23
Coordinates_Scaling|siemens|SCALE X2 Y2|scaling|=|SCALE
Coordinates_Rotation|siemens|ROT Z30|rotation|=|TRANS
Coordinates_AddedRotation|siemens|AROT Z30|rotation|=|ROT
Coordinates_Mirror|siemens|MIRROR X0|mirror|=|MIRROR
Coordinates_Shift|siemens|TRANS X5|coordinate-change
Coordinates_Diameter|linuxcnc|G7|state-change|lathe-diameter|G8
Coordinates_Diameter|siemens|DIAMON|lathe-diameter|=|DIAMOF
Coordinates_Mirror|heidenhain|CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X|mirror|=|CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1
Coordinates_Rotation|heidenhain|CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+30|rotation|=|CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0
Coordinates_Scaling|heidenhain|CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.5|scaling|=|CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 1
Cycles_Drilling|fanuc|G81 X31. Y0 Z-5. R2. F100.|canned-cycle
Cycles_ModalMacro|fanuc|G66 P9010|modal-macro|state-unknown
Cycles_Drilling|siemens|CYCLE81(5,0,2,-5)|canned-cycle
Cycles_DrillingAtEachPlace|siemens|MCALL CYCLE81(5,0,2,-5)|canned-cycle|modal-macro|MCALL
Cycles_Pocket|siemens|POCKET3(5,0,1,-5,40,30,8,60,15,0,3,0,0,1000,100,0,11)|canned-cycle
Cycles_CalledOnce|heidenhain|CYCL DEF 200 DRILLING Q200=2 Q201=-5\nL X+31 Y+0 FMAX M99|canned-cycle
Stops_ExactPath|linuxcnc|G61|state-change|exact-stop|G64
Stops_ExactStop|linuxcnc|G61.1|state-change|exact-stop|G64
Stops_ExactStop|siemens|G60|state-change|exact-stop|G642
Stops_OneStop|fanuc|G9 G1 X31.|exact-stop
Stops_OneStop|siemens|G9 G1 X31|exact-stop
Stops_Dwell|fanuc|G4 P500|dwell
Stops_Dwell|siemens|G4 F0.5|dwell
Stops_Dwell|heidenhain|CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 0.5|dwell
Stops_Rapid|fanuc|G0 Z5.\nG0 X31. Y0\nG1 Z-1.|rapid
Stops_Probe|linuxcnc|G38.2 Z-5.|probe
Stops_Probe|fanuc|G31 Z-5.|probe
Stops_Stop|fanuc|M0|program-end
Stops_Stop|siemens|M0|program-end
Stops_Stop|heidenhain|STOP M0|program-end
SmoothingByTheControl_Fit|fanuc|G05.1 Q2 X0 Y0 Z0|control-smoothing|=|G05.1 Q0
SmoothingByTheControl_HighSpeed|fanuc|G05 P10000|control-smoothing|=|G05 P0
SmoothingByTheControl_SuperNurbs|okuma|G131 F5000 J1 E0.01|control-smoothing|=|G130
SmoothingByTheControl_Compressor|siemens|COMPCAD|control-smoothing|=|COMPOF
SmoothingByTheControl_CompressorOfCurves|siemens|G642 COMPCURV|state-change|control-smoothing|COMPOF
SmoothingByTheControl_CompressorThatIsAllowed|siemens|COMPCAD|control-smoothing|||control-smoothing
SmoothingByTheControl_FitThatIsAllowed|fanuc|G05.1 Q2 X0 Y0 Z0|control-smoothing|||control-smoothing
SmoothingByTheControl_Spline|siemens|BSPLINE X31 Y0\nX32 Y1\nG1 X33 Y0|spline
SmoothingByTheControl_Tolerance|heidenhain|CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.02|control-smoothing
SmoothingByTheControl_HighSpeedCycle|siemens|CYCLE832(0.02,1,1)|control-smoothing
SmoothingByTheControl_ContourTolerance|siemens|CTOL=0.02|control-smoothing
SmoothingByTheControl_AxisTolerance|siemens|ATOL[X]=0.02|control-smoothing
Origins_MachinePlace|fanuc|G53 G0 Z0|coordinate-change
Origins_Home|fanuc|G28 Z0|coordinate-change
Origins_SecondHome|fanuc|G30 Z0|coordinate-change
Origins_Set|fanuc|G92 X0 Y0|coordinate-change
Origins_LocalOffset|fanuc|G52 X5. Y5.|coordinate-change
Origins_Data|fanuc|G10 L2 P1 X5.|coordinate-change
Origins_WorkOffset|fanuc|G55|coordinate-change
Origins_WorkOffset|siemens|G505|coordinate-change
Origins_MachinePlace|siemens|G0 SUPA Z0 D0|not-understood
Origins_Home|siemens|G74 Z1=0|coordinate-change
Origins_Preset|heidenhain|CYCL DEF 247 PRESET ~\n  Q339=+2|coordinate-change
Origins_Shift|heidenhain|CYCL DEF 7.0 DATUM\nCYCL DEF 7.1 X+5|coordinate-change
Origins_MachinePlace|heidenhain|L Z+0 R0 FMAX M91|foreign-words
Words_Plane|fanuc|G18|state-change
Words_Plane|siemens|G18|state-change
Words_Units|fanuc|G20\nG21|state-change
Words_Units|siemens|G70\nG71|state-change
Words_Speed|fanuc|S9000|spindle
Words_Speed|siemens|S2=9000|spindle
Words_Tool|fanuc|T2 M6|tool-change
Words_Tool|siemens|T2 D1|tool-change
Words_Tool|heidenhain|TOOL CALL 4 Z S9000|tool-change
Words_Length|fanuc|G43 H2|tool-change
Words_Coolant|fanuc|M8|coolant
Words_Coolant|heidenhain|M8|coolant
Words_Override|linuxcnc|M48|misc-function
Words_Output|linuxcnc|M62 P1|misc-function
Words_Output|siemens|M62|misc-function
Words_LaserBesideAMove|linuxcnc|G1 X31. S500|spindle
)";

INSTANTIATE_TEST_SUITE_P(UnsafeStates, UnsafeTable, testing::ValuesIn(constructs_in(kUnsafe)),
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
    EXPECT_EQ(reason_at(inspected(before, options_for(target)), 20), "caller-modes");
    SmoothOptions allowed = options_for(target);
    allowed.allowed = {"caller-modes"};
    EXPECT_NE(smoothed(before, allowed).text, before);
  }
}

// The first motion of a file leads from nowhere.
TEST(UnsafePrograms, HaveAFirstMotionFromNowhere) {
  const std::string before =
      "G21 G90 G17\nG1 X0. Y0. F2000.\n" + wave_part(gcode::Language::kRs274, 0) + "M30\n";
  const SmoothResult result = smoothed(before, options_for("fanuc"));
  EXPECT_EQ(reason_at(inspected(before, options_for("fanuc")), 2), "position-unknown");
  EXPECT_TRUE(is_rewritten_within(result, 3, 200));
}

}  // namespace
}  // namespace batten::postproc
