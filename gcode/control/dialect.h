// What one controller family reads and writes. One .cpp per family in dialects/; nothing
// else in the program asks for a dialect's name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <string_view>

#include "gcode/control/block_spelling.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/source_marks.h"
#include "gcode/text/language.h"
#include "gcode/text/number_format.h"
#include "geometry/path/path.h"

namespace batten::gcode {

class CurveFormat;   // gcode/curves/curve_format.h
struct TargetTable;  // gcode/control/target_table.h

// How an arc says where its centre is.
enum class ArcForm : std::uint8_t {
  kCenters,  // I J K
  kRadius,   // R, for arcs of less than half a turn
};

// How a control that runs nothing but lines cuts arcs into chords, as far as that is coarse enough
// to count. All 0: not known to count.
struct ArcChords {
  double error = 0;       // mm: chords that leave the arc by this much
  double longest = 0;     // mm: chords of this length
  double shortest = 0;    // mm: where there are this many chords in a circle, but none shorter
  double per_circle = 0;  // than `shortest` and none longer than `longest`
  bool operator==(const ArcChords&) const = default;
};

// mm: how far such chords leave an arc of this radius at the most.
[[nodiscard]] double chord_error(const ArcChords& chords, double radius);

// What the number of G4 P is taken for where a time is estimated.
enum class DwellUnit {
  kSeconds,       // RS-274: LinuxCNC, grbl
  kMilliseconds,  // FANUC
  kByPoint,       // P.5 is half a second; P500 is taken for milliseconds
};

class Dialect {
 public:
  virtual ~Dialect() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;         // "linuxcnc"
  [[nodiscard]] virtual std::string_view description() const = 0;  // one line, for `batten targets`

  // The language that the control reads, and in which its programs are proved.
  [[nodiscard]] virtual Language language() const { return Language::kRs274; }

  // How coordinates, arc centres and feeds are printed in these units.
  [[nodiscard]] virtual NumberFormat coordinates(Units units) const = 0;
  [[nodiscard]] virtual NumberFormat arc_offsets(Units units) const = 0;
  [[nodiscard]] virtual NumberFormat feeds(Units units) const = 0;

  // Coordinates in a chain that contains arcs: as many decimals as `coordinates`, or more where
  // a rounded joint would no longer be tangent for the control.
  [[nodiscard]] virtual NumberFormat arc_ends(Units units) const { return coordinates(units); }

  // Greatest number of bytes in a line, as line_length counts them.
  [[nodiscard]] virtual std::size_t max_line_length() const = 0;

  // The bytes of a line that the control has to keep: without the line end; whether blanks
  // and comments count is the control's matter.
  [[nodiscard]] virtual std::size_t line_length(std::string_view line) const = 0;

  [[nodiscard]] virtual bool takes_arcs_in(Plane plane) const = 0;
  [[nodiscard]] virtual bool takes_helices() const = 0;
  [[nodiscard]] virtual bool takes_arc_distance_mode() const = 0;  // G90.1, G91.1
  [[nodiscard]] virtual bool blanks_between_words() const = 0;

  [[nodiscard]] virtual ArcForm arc_form() const { return ArcForm::kCenters; }

  // Radians. Longer arcs are written as several, none longer than this; also none across one of
  // the plane's axes as seen from the centre, where the control needs single quadrants.
  [[nodiscard]] virtual double max_arc_sweep() const { return 2 * std::numbers::pi; }
  [[nodiscard]] virtual bool needs_single_quadrants() const { return false; }

  // The control's own chords add to our deviation: an arc that they leave too far is written as
  // chords of ours.
  [[nodiscard]] virtual ArcChords arc_chords() const { return {}; }

  // How blocks are spelt.
  [[nodiscard]] virtual const BlockSpelling& spelling() const { return rs274_spelling(); }

  // Whether every block has to name its motion, and every arc both axes of its plane.
  [[nodiscard]] virtual bool repeats_words() const { return false; }

  // What a G word (in tenths: G38.2 is 382) does on this control that is not what the reader takes
  // it for, with what to say instead; empty where both agree or nothing is known.
  [[nodiscard]] virtual std::string_view other_meaning(int g_code) const {
    (void)g_code;
    return {};
  }

  // By which words a program may tell that it was made for this control or one like it. A program
  // with other marks was made for others.
  [[nodiscard]] virtual SourceMarks known_marks() const { return kAllMarks; }

  // Whether the control refuses a word that most others of the RS-274 family take (M6 on grbl), as
  // far as is known; `number` in tenths. Asked when a program is moved from one control to another.
  [[nodiscard]] virtual bool cannot_say(char letter, int number) const {
    (void)letter;
    (void)number;
    return false;
  }

  // Would the control run this arc? The piece is the arc as its printed numbers say it
  // (end, centre offsets rounded). Returns the control's complaint, empty when it takes it.
  [[nodiscard]] virtual std::string_view arc_complaint(const geometry::Arc& printed,
                                                       Units units) const = 0;

  // Least useful arc: shorter or tighter ones are written as lines (mm).
  [[nodiscard]] virtual double min_arc_radius() const = 0;
  [[nodiscard]] virtual double max_arc_radius() const = 0;

  // The curves that the control reads; nullptr: none.
  [[nodiscard]] virtual const CurveFormat* curves() const { return nullptr; }

  // A comment line with this text, or empty when the text cannot be said.
  [[nodiscard]] virtual std::string comment(std::string_view text) const = 0;

  // Lines that `batten targets --show` puts into a profile as remarks: the control's own smoothing
  // words, and how sure they are.
  [[nodiscard]] virtual std::span<const std::string_view> smoothing_words() const { return {}; }

  // The same control with other values, as a user's profile has them. This dialect must outlive it.
  [[nodiscard]] virtual std::unique_ptr<const Dialect> with_values(const TargetTable& table) const;

  // Whether a parameter of the control may make X5 five least increments, 0.005 mm. Such numbers
  // are written with a point, and read only where the user says what they are.
  [[nodiscard]] virtual bool may_imply_decimals() const { return false; }

  [[nodiscard]] virtual DwellUnit dwell_unit() const { return DwellUnit::kByPoint; }

  // The word by which programs say these units, millimetres or inches.
  [[nodiscard]] virtual std::string_view unit_word(Units units) const {
    return units == Units::kInch ? "G20" : "G21";
  }

  // How a dwell is said so that its time is certain.
  [[nodiscard]] virtual DwellForm dwell_form() const { return DwellForm::kUnknown; }

  // Name of the built-in machine model that runs this target when no machine is given.
  [[nodiscard]] virtual std::string_view default_machine() const = 0;
};

}  // namespace batten::gcode
