// Comments that act when they are reached.
#pragma once

#include <string_view>

namespace batten::gcode {

// (MSG,..) (DEBUG,..) (PRINT,..) (LOG,..) (LOGOPEN,..) (LOGAPPEND,..) (LOGCLOSE)
// (PROBEOPEN ..) (PROBECLOSE) (PY,..) (ABORT,..), in either case and with blanks anywhere;
// also behind a semicolon. `comment` starts with its bracket or semicolon.
[[nodiscard]] bool is_active_comment(std::string_view comment);

}  // namespace batten::gcode
