// Lines that say something to people and that no control reads as a command.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace batten::gcode {

// Whether a line of the RS-274 family that is no block of words is one of these, comments aside:
//   fanuc.nc (a title)   the name of a program file: letters, digits, -, _ and a known suffix
//                        (not mpf or spf, whose names may be calls)
//   [ROUGHING]           in brackets as a whole, which WinCNC takes for a comment
// False for all that a control could act on: names with values, macros, statements of other
// languages.
[[nodiscard]] bool is_plain_text(std::string_view line);

// What a line that is no block of words can have changed, wherever it stands, on every control that
// does not refuse it.
enum class TextEffect : std::uint8_t { kNothing, kSpindle, kPlace, kAnything };

//   [ROUGHING]           in brackets as a whole, without # and =: a comment of WinCNC  nothing
//   $X $$ $# $G $I       grbl: unlocks, reports                                        nothing
//   $110=500             grbl: a setting                                               nothing
//   M3 $0 S1000          LinuxCNC, grblHAL: of one of several spindles                 spindle
//   $H $HX               grbl: homes                                                   place
//   M117 Layer 3 of 10   printers: shown to people; the user's own elsewhere           place
//   M291 P"Put in T2"    RepRapFirmware: the same                                      place
//   M0 Put in T2         printers: the same, and waits                                 place
//   M94/1  M26/Z         Centroid: what an M word is for                               place
// Anything for all else, which may be a macro's name or a statement of another language.
[[nodiscard]] TextEffect text_effect(std::string_view line);

// Okuma's name of a block or a program: N or O, a letter, and up to three letters or digits.
[[nodiscard]] bool is_letter_name(std::string_view line, char first);

// "SET_PIN" of `SET_PIN PIN=fan VALUE=1`, "#MSG" of `#MSG["text"]`, in capitals: the name with
// which a line of the RS-274 family begins that is no block of words; empty where there is none.
[[nodiscard]] std::string leading_name(std::string_view line);

// Whether the line is the place of the program's number, for the operator to fill in: N9XXX, as
// FreeCAD's post for Philips controls writes it.
[[nodiscard]] bool is_open_number(std::string_view line);

// Whether the line is a title: two or more words of letters and numbers of which none is a word of
// RS-274 (X10) or begins a command of some control; or such a place, or FANUC's name of a program,
// <PART-1>. At the beginning of a program only: further down it could be a macro's.
[[nodiscard]] bool is_title(std::string_view line);

}  // namespace batten::gcode
