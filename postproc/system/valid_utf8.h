// Text for readers that take nothing but UTF-8, such as the Python programs that show Batten's
// messages to the user. Names of files and words of programs may hold any bytes.
#pragma once

#include <string>
#include <string_view>

namespace batten::postproc {

// The same text, with U+FFFD for each byte that is no part of well-formed UTF-8 (RFC 3629:
// nothing overlong, no surrogates, nothing above U+10FFFF).
[[nodiscard]] std::string as_valid_utf8(std::string_view bytes);

}  // namespace batten::postproc
