// SHA-256 (FIPS 180-4): whether two files are the same, without keeping one of them.
#pragma once

#include <string>
#include <string_view>

namespace batten::postproc {

// 64 digits, lower case.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace batten::postproc
