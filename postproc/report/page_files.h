// The files of postproc/report/page/, as embed.cmake puts them into the program.
#pragma once

#include <string>
#include <string_view>

namespace batten::postproc {

// page.html. It holds the marks @TITLE@, @STYLE@, @DATA@ and @SCRIPT@, in this order, once each.
[[nodiscard]] std::string_view page_template();

// page.css
[[nodiscard]] std::string_view page_style();

// All .js files, one after the other.
[[nodiscard]] std::string page_script();

}  // namespace batten::postproc
