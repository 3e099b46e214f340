#include "gcode/curves/heidenhain_spl_words.h"

#include <string>

namespace batten::gcode {

using geometry::Point3;

bool is_spl_coefficient(const KlartextWord& word) {
  return word.name.size() == 3 && word.name[0] == 'K';
}

bool is_spl_end(const KlartextWord& word) {
  return word.name.size() == 1 && kSplAxes.find(word.name[0]) != std::string_view::npos &&
         word.value.has_value();
}

SplWords joined_at(const Program& program, std::uint32_t first) {
  SplWords joined;
  bool continues = true;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto line = read_klartext_line(program.source.text(program.blocks[at].span));
    const bool more = at > first && line && !line->number && !line->words.empty() &&
                      is_spl_coefficient(line->words.front());
    if (!continues && !more) break;
    ++joined.lines;
    if (!line || (at > first && line->number)) {
      joined.understood = false;
      break;
    }
    for (const KlartextWord& word : line->words) joined.words.push_back(word);
    // Only splines are joined where nothing says so.
    continues = line->continues;
    if (!joined.is("SPL") && !continues) break;
  }
  return joined;
}

std::string_view spl_word_trouble(const SplWords& block) {
  std::string ends;
  std::string coefficients;
  std::string last_axis;
  for (std::size_t i = 1; i < block.words.size(); ++i) {
    const KlartextWord& word = block.words[i];
    if (is_spl_coefficient(word)) {
      coefficients += word.name;
    } else if (is_spl_end(word) && coefficients.empty()) {
      ends += word.name;
    } else if (word.name != "F" && word.name != "FMAX" && word.name != "M") {
      return "spl-words";
    }
  }
  for (std::size_t at = 0; at < coefficients.size(); at += 9) {
    const char axis = coefficients[at + 2];
    const std::string three = {'K', '3', axis, 'K', '2', axis, 'K', '1', axis};
    if (coefficients.substr(at, 9) != three) return "spl-order";
    if (ends.find(axis) == std::string::npos) return "spl-order";
    if (last_axis.find(axis) != std::string::npos) return "spl-order";
    last_axis.push_back(axis);
  }
  if (last_axis.size() != ends.size()) return "spl-order";
  if (ends.size() < 2 || ends.size() > 5) return "spl-axes";
  return {};
}

SplBlock spl_block_of(const SplWords& joined, std::uint32_t at, const Point3& place, double unit) {
  SplBlock block;
  block.block = at;
  block.end = place;
  for (const KlartextWord& word : joined.words) {
    if (word.is("F")) block.feed = word.value;
    if (!is_spl_end(word) && !is_spl_coefficient(word)) continue;
    const char axis = word.name.back();
    if (axis < 'X' || axis > 'Z') continue;
    const int i = axis - 'X';
    if (is_spl_coefficient(word)) {
      block.k[static_cast<std::size_t>(word.name[1] - '1')][i] = *word.value * unit;
    } else {
      block.axes[static_cast<std::size_t>(i)] = true;
      block.end[i] = *word.value * unit;
    }
  }
  return block;
}

}  // namespace batten::gcode
