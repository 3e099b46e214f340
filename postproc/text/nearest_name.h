// Names that a user may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace batten::postproc {

// The name nearest to `text` when it is likely a slip of the finger; else empty.
[[nodiscard]] std::string_view nearest_name(std::string_view text,
                                            std::span<const std::string_view> names);

// ", did you mean 'grbl'?", or nothing.
[[nodiscard]] std::string suggestion(std::string_view text,
                                     std::span<const std::string_view> names);

}  // namespace batten::postproc
