// For which control a program was written: as the user says, or as its text shows.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gcode/state/source_marks.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/language.h"
#include "gcode/text/program.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

struct Control;

enum class SourceKind : std::uint8_t {
  kAuto,
  kNgc,
  kFanuc,
  kHaas,
  kGrbl,
  kSiemens,
  kHeidenhain,
};

// What a kind of source is read in, and which marks such programs may have.
struct SourceFamily {
  SourceKind kind = SourceKind::kAuto;
  std::string_view name;      // "ngc"
  std::string_view controls;  // for people: "LinuxCNC"
  std::string_view control;   // the built-in control's name: "linuxcnc"
  Language language = Language::kRs274;
  SourceMarks marks = 0;
  bool may_imply_decimals = false;  // X5 may be five least increments
  DwellForm dwells = DwellForm::kUnknown;
};

// The name of the built-in control that programs of this kind are for; empty for kAuto.
[[nodiscard]] std::string_view control_of(SourceKind kind);

// All kinds but kAuto.
[[nodiscard]] std::span<const SourceFamily> source_families();

// The language in which to read this text. With kAuto: that of its certain marks, which only one
// language has; without any, Klartext where the target reads that and the text does
// not begin with plain words (gcode/rs274/plain_words.h), that of Siemens where the target reads
// that and a line has one of its names (has_siemens_name), else RS-274. Nothing, and an
// error in `found`, when
//   not-a-program: the file is of another kind (gcode/reading/foreign_file.h);
//   source-ambiguous: the text has certain marks of two languages;
//   source-contradicted: a kind was given, and the text has a certain mark of another language.
// Linear in the text.
[[nodiscard]] std::optional<Language> source_language(const SourceText& source, SourceKind kind,
                                                      std::optional<Language> target,
                                                      Diagnostics& found);

// What numbers without a point mean in a program: what the user says, where it is said; else
// kUndeclared for controls that may take them for increments. Which control it is says the kind,
// with kAuto the target. Other languages than the RS-274 family have no such controls.
[[nodiscard]] Decimals decimals_read(SourceKind kind, const Control* target, Language language,
                                     const std::optional<Decimals>& declared);

// What G4 means in programs of this kind; not known for kAuto, whatever the target.
[[nodiscard]] DwellForm dwells_of(SourceKind kind);

// Why these controls do not take a number without a point for increments, for a user who says that
// they do: empty where they may.
[[nodiscard]] std::string_view why_not_implied(SourceKind kind, const Control* target);

// Adds an error source-contradicted for each kind of mark (gcode/state/source_marks.h) that
// programs of the given kind do not have. None for kAuto.
void tell_of_contradictions(const Program& program, SourceKind kind, Diagnostics& found);

// Marks by which the language of a program is known for certain: no other language has them.

struct LanguageEvidence {
  Language language = Language::kRs274;
  std::string_view evidence;  // what was found: "BEGIN PGM"
};

// What the line says, when it is one that only such a language has: `0 BEGIN PGM NAME MM`,
// `%_N_NAME_MPF`, `;$PATH=..`, `DEF REAL ..`. RS-274 has no such lines.
[[nodiscard]] std::optional<LanguageEvidence> language_of_line(std::string_view line);

struct LanguageMark {
  Language language = Language::kRs274;
  std::string_view evidence;
  SourceSpan where;  // its line
};

// The first mark of each language that has any, in the order of the text. Linear in the text.
[[nodiscard]] std::vector<LanguageMark> language_marks(const SourceText& source);

}  // namespace batten::gcode
