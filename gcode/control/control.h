// What one control reads, writes and refuses, as a plain value. The built-in ones are in
// gcode/controls/; a user's profile is a copy of one with other values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/state/source_marks.h"
#include "gcode/text/language.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {

struct CurveFormat;  // gcode/curves/curve_format.h

// Digits after the point in millimetre and in inch programs.
struct DecimalsByUnit {
  int mm = 3;
  int inch = 4;
};

enum class CommentStyle : std::uint8_t {
  kNone,
  kParentheses,  // (text)
  kSemicolon,    // ; text
};

// How an arc says where its centre is.
enum class ArcForm : std::uint8_t {
  kCenters,  // I J K
  kRadius,   // R, for arcs of less than half a turn
  kShorter,  // R for arcs of less than a sixth of a turn, in fewer bytes; else I J K
};

// Which arcs a control refuses (gcode/controls/arc_rules.h). A rule that is named for a control was
// read or measured there.
enum class ArcRule : std::uint8_t {
  kStrictest,  // the control's own check is not known
  kUnchecked,  // firmware without a check of radii
  kGrbl,       // error 33 in 32-bit numbers
  kTinyg,      // radii that differ by 0.1 %
  kLinuxcnc,
  kFanuc,    // a parameter that the builder of the machine has set
  kSiemens,  // the same
  kHeidenhain,
};

// How a control that runs nothing but lines cuts arcs into equal chords, as far as that is coarse
// enough to count: what is wanted of a chord. Their number is rounded down, so they are up to twice
// as long. All 0: not known to count.
struct ArcChords {
  double error = 0;       // mm: that leaves the arc by this much
  double longest = 0;     // mm: of this length
  double shortest = 0;    // mm: where there are this many chords in a circle, but none shorter
  double per_circle = 0;  // than `shortest` and none longer than `longest`
  // Ends are turned on by the first terms of the series of sine and cosine; after so many of them
  // one is computed anew. 0: all are.
  double turned = 0;

  [[nodiscard]] bool any() const { return error > 0 || longest > 0; }
  bool operator==(const ArcChords&) const = default;
};

// How a control computes the sweep of an arc, where it is known to take small full circles for no
// motion, and tiny arcs for a full turn.
enum class SweepNoise : std::uint8_t {
  kNone,             // not known to
  kSinglePrecision,  // grbl: 32-bit numbers, from a centre in machine coordinates
  kDoublePrecision,  // Klipper: what rounding makes of a full circle decides
};

// Which bytes of a line a control has to keep.
enum class LineCount : std::uint8_t {
  kAll,
  kWithoutComments,
  kWithoutBlanksAndComments,
};

// What the number of G4 P is taken for where a time is estimated.
enum class DwellUnit : std::uint8_t {
  kSeconds,       // RS-274: LinuxCNC, grbl
  kMilliseconds,  // FANUC
  kByPoint,       // P.5 is half a second; P500 is taken for milliseconds
};

// The words by which programs say their units.
struct UnitWords {
  std::string_view mm = "G21";
  std::string_view inch = "G20";
};

// A G word that the reader takes for something else.
struct OtherMeaning {
  int g_code = 0;         // in tenths: G38.2 is 382
  std::string_view text;  // what to say instead
};

// As a user says it of a word of his (gcode/state/own_words.h): "G103", "keeps state".
struct ControlWord {
  std::string_view name;
  std::string_view effect;
};

struct Control {
  std::string name;                      // "linuxcnc"
  std::string description;               // one line, for `batten targets`
  Language language = Language::kRs274;  // that it reads, and in which its programs are proved
  std::string machine = "mill";          // built-in machine model when none is given

  // Numbers. Feeds are copied from the source, never computed: as many decimals as any source
  // carries, since a feed that differs in its last digit is a changed feed.
  DecimalsByUnit places;    // vertices of lines
  DecimalsByUnit arc_ends;  // as many as places, or more where a joint would no longer be tangent
  DecimalsByUnit centers;   // I J K R
  int feed_decimals = 6;
  bool decimal_point = false;  // X5. rather than X5
  bool trailing_zeros = false;
  // A parameter of the control may make X5 five least increments, 0.005 mm.
  bool has_increments = false;

  // Lines and their words.
  std::size_t max_line_length = 255;  // bytes, as line_length counts them
  LineCount line_count = LineCount::kAll;
  bool blanks = true;          // between words
  bool repeats_words = false;  // each block names its motion, each arc both axes of its plane
  // Blocks are commands: most builds leave out one without a G, M or T word.
  bool needs_commands = false;
  bool names_blocks = false;  // NAT01 names a block, OPART a program
  UnitWords unit_words;
  CommentStyle comments = CommentStyle::kParentheses;
  std::string_view not_in_comments;  // bytes that the control obeys there too
  bool capital_comments = false;     // in parentheses: older controls have no small letters

  // Arcs.
  std::array<bool, 3> planes = {true, true, true};  // arcs in G17, G18, G19
  bool helices = true;
  bool arc_distance_mode = false;  // G90.1, G91.1
  ArcForm arc_form = ArcForm::kCenters;
  bool centers_follow_distance = false;  // I J K are places under G90, offsets under G91
  ArcRule arc_rule = ArcRule::kStrictest;
  double max_sweep_deg = 180;     // longer arcs are written as several
  bool single_quadrants = false;  // no arc across an axis of its plane, seen from the centre
  double min_radius = 0.1;        // mm: tighter arcs are written as lines
  double max_radius = 1000;       // mm: flatter ones too
  // The control's own chords add to our deviation: an arc that they leave too far is written as
  // chords of ours.
  ArcChords chords;
  SweepNoise sweep_noise = SweepNoise::kNone;

  // The word that ends smoothing by the control, whichever word began it; empty: not read.
  std::string_view smoothing_off = "G5.1 Q0";

  // Modes that nothing can turn on there: no word for them is known to it. Only what is certain: a
  // mode that may exist under another word is not among them.
  ModeSet lacks = 0;

  const CurveFormat* curves = nullptr;  // that the control reads; nullptr: none
  // They are tried under --output auto, too: every such control has them and runs them as they are
  // meant, or the user says that his has the option.
  bool curves_in_auto = false;

  DwellUnit dwell_unit = DwellUnit::kByPoint;
  DwellForm dwell_form = DwellForm::kUnknown;  // how a dwell is said so that its time is certain

  // By which words a program may tell that it was made for this control or one like it. A program
  // with other marks was made for others.
  SourceMarks known_marks = 0;
  std::vector<OtherMeaning> other_meanings;
  // Words that it has for itself, or for something else than most: what is known behind them.
  std::vector<ControlWord> own_words;
  // Words that most others of the RS-274 family take and this one refuses, as far as is known: "M6
  // G43 T", a letter alone for any number behind it.
  std::string_view refused;
  // Lines that `batten targets --show` puts into a profile as remarks: the control's own smoothing
  // words, and how sure they are.
  std::vector<std::string_view> smoothing_words;
};

// How coordinates, ends of arcs, arc centres and feeds are printed. Coordinates in a chain that
// contains arcs are printed as ends of arcs.
[[nodiscard]] NumberFormat place_format(const Control& control, Units units);
[[nodiscard]] NumberFormat arc_end_format(const Control& control, Units units);
[[nodiscard]] NumberFormat center_format(const Control& control, Units units);
[[nodiscard]] NumberFormat feed_format(const Control& control);

// The bytes of a line, without the line end, that the control has to keep. An unclosed parenthesis
// is a comment to the end of the line.
[[nodiscard]] std::size_t line_length(const Control& control, std::string_view line);

[[nodiscard]] bool takes_arcs_in(const Control& control, Plane plane);
[[nodiscard]] double max_arc_sweep(const Control& control);  // radians

// Whether X5 may be five least increments: such numbers are written with a point, and read only
// where the user says what they are. A control whose numbers have no point says that X5 is 5 mm.
[[nodiscard]] bool may_imply_decimals(const Control& control);

[[nodiscard]] std::string_view unit_word(const Control& control, Units units);

// What a G word (in tenths) does on this control that is not what the reader takes it for, with
// what to say instead; empty where both agree or nothing is known.
[[nodiscard]] std::string_view other_meaning(const Control& control, int g_code);

// The words of all modes but those that the control lacks, for a program in which nothing is known;
// "G20 or G21" where there is a choice. Each once. Words with another meaning there are left out.
[[nodiscard]] std::vector<std::string_view> words_of_modes(const Control& control);

// Whether the control refuses this word (`number` in tenths), as far as is known. Asked when a
// program is moved from one control to another.
[[nodiscard]] bool refuses_word(const Control& control, char letter, int number);

// A comment line with this text. Empty where it cannot be said: text with brackets, control
// characters or bytes outside ASCII, text that a control of the RS-274 family would act on ("MSG,",
// "DEBUG,", ..), and a line that is too long.
[[nodiscard]] std::string comment_line(const Control& control, std::string_view text);

}  // namespace batten::gcode
