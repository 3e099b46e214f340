#include "postproc/batch/leftovers.h"

#include <system_error>

#include "gcode/text/characters.h"

namespace batten::postproc {

namespace fs = std::filesystem;

std::optional<std::string> intended_name(std::string_view half_written) {
  constexpr std::string_view kEnd = ".batten-part";
  // The point before the name and the one of the ending are two.
  if (half_written.size() <= kEnd.size()) return std::nullopt;
  if (!half_written.starts_with('.') || !half_written.ends_with(kEnd)) return std::nullopt;
  half_written.remove_prefix(1);
  half_written.remove_suffix(kEnd.size());
  const std::size_t dot = half_written.rfind('.');  // before the number of the process
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == half_written.size()) {
    return std::nullopt;
  }
  for (const char c : half_written.substr(dot + 1)) {
    if (!gcode::is_digit(c)) return std::nullopt;
  }
  return std::string(half_written.substr(0, dot));
}

std::size_t remove_half_written(const fs::path& root, const std::set<fs::path>& targets) {
  std::error_code error;
  std::size_t removed = 0;
  for (fs::recursive_directory_iterator at(root, error), end; !error && at != end;
       at.increment(error)) {
    const auto name = intended_name(at->path().filename().string());
    if (!name || !targets.contains(at->path().parent_path() / *name)) continue;
    std::error_code remove_error;
    if (fs::remove(at->path(), remove_error)) ++removed;
  }
  return removed;
}

}  // namespace batten::postproc
