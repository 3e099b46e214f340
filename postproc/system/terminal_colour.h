// How messages reach their readers: in colour on a terminal, unless the user does not want it, with
// rates and times in words, in well-formed UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace batten::postproc {

enum class Ink { kError, kWarning, kNote, kGood };

// Whether standard error is a terminal that shows colours, and NO_COLOR (https://no-color.org) is
// empty or not set.
[[nodiscard]] bool shows_colour();

// The text in a colour, as terminals take it (ECMA-48); as it is when `colour` is false.
[[nodiscard]] std::string inked(std::string_view text, Ink ink, bool colour);

// What lines that show progress say besides how far the work is.

// "850 kB/s", "1.2 MB/s"
[[nodiscard]] std::string rate_text(double bytes_per_second);

// "40 s", "2 min", "3 h 20 min": rounded up, since it is a guess.
[[nodiscard]] std::string rough_time(double seconds);

// Text for readers that take nothing but UTF-8, such as the Python programs that show Batten's
// messages to the user. Names of files and words of programs may hold any bytes.

// The same text, with U+FFFD for each byte that is no part of well-formed UTF-8 (RFC 3629:
// nothing overlong, no surrogates, nothing above U+10FFFF).
[[nodiscard]] std::string as_valid_utf8(std::string_view bytes);

}  // namespace batten::postproc
