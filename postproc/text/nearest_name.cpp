#include "postproc/text/nearest_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace batten::postproc {

namespace {

// Slips of the finger: as many wrong letters as a third of the word, but at least one.
constexpr std::size_t kLettersPerSlip = 3;

// Levenshtein's distance, one row at a time.
std::size_t wrong_letters(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearest_name(std::string_view text, std::span<const std::string_view> names) {
  std::string_view nearest;
  std::size_t fewest = std::max<std::size_t>(1, text.size() / kLettersPerSlip) + 1;
  for (const std::string_view name : names) {
    const std::size_t wrong = wrong_letters(text, name);
    if (wrong < fewest) {
      fewest = wrong;
      nearest = name;
    }
  }
  return nearest;
}

std::string suggestion(std::string_view text, std::span<const std::string_view> names) {
  const std::string_view nearest = nearest_name(text, names);
  return nearest.empty() ? "" : fmt::format(", did you mean '{}'?", nearest);
}

}  // namespace batten::postproc
