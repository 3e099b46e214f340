// The manual page, made from the table of commands.
#pragma once

#include <string>

namespace batten::postproc {

// batten(1) in the man macros of roff.
[[nodiscard]] std::string man_page();

}  // namespace batten::postproc
