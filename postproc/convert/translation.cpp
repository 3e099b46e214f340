#include "postproc/convert/translation.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {
namespace {

// Letters of other alphabets are not the same bytes on all controls.
char plain(char c) { return c >= ' ' && c <= '~' ? c : c == '\t' ? ' ' : '?'; }

bool is_plain_in_comments(char c) {
  const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  return letter || (c >= '0' && c <= '9') || std::string_view(" .,:+-=").find(c) < 7;
}

// As it is, or without what this target does not take there.
std::string comment_said(const gcode::Control& target, std::string_view text) {
  std::string line = comment_line(target, text);
  if (!line.empty()) return line;
  std::string mild(text);
  std::ranges::replace_if(
      mild, [](char c) { return !is_plain_in_comments(c); }, '-');
  line = comment_line(target, mild);
  // "MSG, .." acts on some controls.
  return line.empty() ? comment_line(target, "- " + mild) : line;
}

}  // namespace

void TranslationText::add_comment(std::string_view text, std::uint32_t source_line,
                                  std::size_t longest) {
  constexpr std::string_view kBegin = "; ";
  std::string rest;
  std::ranges::transform(text, std::back_inserter(rest), plain);
  // A ~ at the end of a line of Klartext goes on in the next one.
  std::ranges::replace(rest, '~', '-');
  const std::size_t room = longest - kBegin.size();
  do {
    const std::string part = rest.substr(0, room);
    add(std::string(kBegin) + part, source_line);
    rest.erase(0, part.size());
  } while (!rest.empty());
}

bool TranslationText::add_comment_of(const gcode::Control& target, std::string_view text,
                                     std::uint32_t source_line) {
  constexpr std::size_t kBrackets = 2;
  const std::size_t room = target.max_line_length - kBrackets;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, room);
    const std::string line = comment_said(target, part);
    if (line.empty()) return false;
    add(line, source_line);
    text.remove_prefix(part.size());
  }
  return true;
}

std::string TranslationText::place(double mm, int axis, const gcode::NumberFormat& format,
                                   double unit) {
  const double error = std::abs(gcode::rounded(mm / unit, format.decimals) * unit - mm);
  // Sums of decimals are off by less than this, which is no rounding of ours.
  constexpr double kNoise = 1e-9;
  if (error > kNoise) rounding_[axis] = std::max(rounding_[axis], error);
  return gcode::to_text(mm / unit, format);
}

Translation TranslationText::take() {
  result_.rounding_mm = rounding_.norm() + beside_;
  return std::move(result_);
}

std::string program_name(std::string_view file) {
  constexpr std::size_t kLongest = 16;
  const std::size_t slash = file.find_last_of("/\\");
  if (slash != std::string_view::npos) file.remove_prefix(slash + 1);
  const std::size_t point = file.find('.');
  if (point != std::string_view::npos) file = file.substr(0, point);
  std::string name;
  for (const char c : file.substr(0, std::min(file.size(), kLongest))) {
    const bool small = c >= 'a' && c <= 'z';
    const bool taken = small || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    name += small ? static_cast<char>(c - 'a' + 'A') : taken ? c : '_';
  }
  return name.empty() || name == "_" ? "PROGRAM" : name;
}

}  // namespace batten::postproc
