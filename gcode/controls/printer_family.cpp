// Firmware of 3D printers that also runs routers: Marlin, RepRapFirmware, Klipper, Smoothieware.
// Facts: docs/controllers/printer_family.md.
#include "gcode/controls/built_in.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

Control printer(std::string_view name, std::string_view description, ArcChords chords) {
  Control control;
  control.name = name;
  control.description = description;
  control.machine = "router";
  // As grbl: 32-bit numbers (doubles on Klipper and RepRapFirmware's faster boards), steps of a
  // few micrometres, a serial line.
  control.places = control.arc_ends = {3, 4};
  control.centers = {4, 5};
  control.repeats_words = true;
  control.comments = CommentStyle::kSemicolon;
  control.arc_rule = ArcRule::kUnchecked;
  control.chords = chords;
  control.known_marks = mark(SourceMark::kHeaterWords);
  // None has more modes than grbl, nor a word for another feed mode, but where it is said.
  control.lacks = mode::kAll - mode::kUnits - mode::kPlane - mode::kDistance;
  // What an ordinary build refuses or gives another meaning.
  control.refused = "G40 G43 G49 G54 G55 G56 G57 G58 G59 G80 G94 M1 M2 M3 M4 M5 M6 M8 M9 M30 S T H";
  return control;
}

// Of its documentation; a macro of the user's can have the same name only where he renames these.
std::vector<ControlWord> commands_of_klipper() {
  std::vector<ControlWord> words;
  for (const std::string_view name :
       {"SET_VELOCITY_LIMIT", "SET_PIN", "SET_FAN_SPEED", "SET_LED", "SET_SERVO", "RESPOND",
        "SET_PRESSURE_ADVANCE", "SET_INPUT_SHAPER", "SET_HEATER_TEMPERATURE", "TURN_OFF_HEATERS",
        "TEMPERATURE_WAIT", "SET_IDLE_TIMEOUT", "SET_PRINT_STATS_INFO", "EXCLUDE_OBJECT_DEFINE",
        "SAVE_GCODE_STATE"}) {
    words.push_back({name, "keeps state"});
  }
  for (const std::string_view name : {"SET_GCODE_OFFSET", "BED_MESH_CLEAR", "BED_MESH_PROFILE",
                                      "EXCLUDE_OBJECT_START", "EXCLUDE_OBJECT_END"}) {
    words.push_back({name, "position unknown"});
  }
  return words;
}

}  // namespace

std::vector<Control> printer_family() {
  // One command to a line: a plane word would take the arc's place, so arcs in G17 alone.
  Control marlin = printer(
      "marlin", "Marlin: arcs and helices in G17 where its own chords are fine enough; millimetres",
      {.longest = 1, .shortest = 0.1, .per_circle = 72, .turned = 25});
  marlin.planes = {true, false, false};
  marlin.needs_commands = true;  // but with GCODE_MOTION_MODES
  // 96 bytes with terminator; a sender adds up to 14 for N1234567 and *123.
  marlin.max_line_length = 80;
  marlin.other_meanings = {{200,
                            "read only by builds with inch support; others run the numbers as "
                            "millimetres. Post the program in millimetres"}};
  marlin.curves = &chopped_g5();
  // Looks for the bed; a loop begins or ends, into whose blocks more than one way leads.
  marlin.own_words = {{"G29", "moves"}, {"M808", "moves"}};

  Control reprapfirmware = printer("reprapfirmware",
                                   "RepRapFirmware 3: arcs and helices in G17, G18, G19 where its "
                                   "own chords are fine enough",
                                   {.error = 0.005});
  reprapfirmware.machine = "router-unrounded";
  reprapfirmware.lacks -= mode::kRotation + mode::kFeedMode;  // G68; G93
  reprapfirmware.line_count = LineCount::kWithoutComments;
  reprapfirmware.not_in_comments = "{}\"";

  reprapfirmware.own_words = {{"ECHO", "keeps state"}};

  // G18 and G19 came late, and their directions are not those of other controls: G17 alone.
  Control klipper = printer(
      "klipper",
      "Klipper: lines; arcs in G17 where [gcode_arcs] is set up and fine enough; millimetres",
      {.longest = 1});  // [gcode_arcs] resolution
  klipper.sweep_noise = SweepNoise::kDoublePrecision;
  klipper.machine = "klipper-router";
  klipper.own_words = commands_of_klipper();
  klipper.planes = {true, false, false};
  klipper.needs_commands = true;
  klipper.other_meanings = {
      {200, "refused: Klipper runs millimetres only. Post the program in millimetres"}};

  Control smoothieware = printer(
      "smoothieware",
      "Smoothieware: arcs and helices in G17, G18, G19 where its own chords are fine enough",
      {.error = 0.01, .turned = 5});  // mm_max_arc_error, arc_correction
  smoothieware.machine = "router-unrounded";
  smoothieware.lacks -= mode::kFeedMode;  // of later builds
  smoothieware.sweep_noise = SweepNoise::kSinglePrecision;
  smoothieware.comments = CommentStyle::kParentheses;
  smoothieware.max_line_length = 120;  // its buffer was not read; no line of ours needs more

  return {marlin, reprapfirmware, klipper, smoothieware};
}

}  // namespace batten::gcode
