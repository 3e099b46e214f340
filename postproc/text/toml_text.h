// Text that is put into TOML files.
#pragma once

#include <string>
#include <string_view>

namespace batten::postproc {

// In quotes, with escapes where TOML needs them.
[[nodiscard]] std::string toml_quoted(std::string_view text);

}  // namespace batten::postproc
