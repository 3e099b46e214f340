// What killed runs left half written (postproc/system/output_file.h).
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace batten::postproc {

// The name that a half-written file would have got: "part.nc" of ".part.nc.4711.batten-part".
[[nodiscard]] std::optional<std::string> intended_name(std::string_view half_written);

// Removes below `root` the half-written files of these targets, links to folders not followed.
// Requires that nobody writes the targets now. Returns how many there were.
std::size_t remove_half_written(const std::filesystem::path& root,
                                const std::set<std::filesystem::path>& targets);

}  // namespace batten::postproc
