#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "postproc/profile/profile_words.h"
#include "postproc/translation/translation.h"
#include "postproc/translation/translation_text.h"

namespace batten::postproc {
namespace {

using gcode::Word;

// In tenths: words that say nothing more where they stand, for what they end was refused, or is
// always so there.
constexpr std::array kLeftOut = {800, 911, 980, 990};

// The source's words, where Siemens has the same, and their own where it has others.
class SiemensSpeaker {
 public:
  SiemensSpeaker(const TranslationSource& source, const gcode::Dialect& target,
                 std::string_view name)
      : source_(source), target_(target) {
    text_.add(fmt::format("%_N_{}_MPF", name), 1);
  }

  Translation say() {
    for (const gcode::Block& block : source_.program.blocks) {
      for (const gcode::Comment& comment : source_.program.comments_of(block)) {
        say_comment(source_.program.source.text(comment.span), block.line);
      }
      if (block.opacity == gcode::Opacity::kNone) say_block(block);
    }
    for (const Act& act : source_.acts.acts) check(act);
    return text_.take();
  }

 private:
  void say_comment(std::string_view text, std::uint32_t line) {
    const bool in_parentheses = text.starts_with('(');
    text.remove_prefix(1);
    if (in_parentheses && text.ends_with(')')) text.remove_suffix(1);
    while (text.starts_with(' ')) text.remove_prefix(1);
    text_.add_comment(text, line, target_.max_line_length());
  }

  void say_block(const gcode::Block& block) {
    std::string line;
    for (const Word& word : source_.program.words_of(block)) {
      const std::string said = said_as(word, block.line);
      if (said.empty()) continue;
      line += (line.empty() ? "" : " ") + said;
    }
    const bool only_number = line.starts_with('N') && line.find(' ') == std::string::npos;
    if (!line.empty() && !only_number) text_.add(line, block.line);
  }

  // Units stand in a block of their own, before the others.
  std::string said_as(const Word& word, std::uint32_t line) {
    std::string text;
    for (const char c : source_.program.source.text(word.span)) {
      if (c == ' ' || c == '\t') continue;
      text += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    if (word.letter == 'R') return "CR=" + text.substr(1);
    if (word.letter != 'G') return text;
    const int code = tenths_of(word);
    if (std::ranges::find(kLeftOut, code) != kLeftOut.end()) return {};
    if (code == 200 || code == 210) {
      text_.add(code == 200 ? "G700" : "G710", line);
      return {};
    }
    if (code == 430 || code == 490) {
      text_.refuse(word.span, "takes the length of a tool, which D does there");
    }
    if (code == 580 || code == 590) text_.refuse(word.span, "is another offset there");
    if (code == 901) text_.refuse(word.span, "is said at each centre there");
    return text;
  }

  void check(const Act& act) {
    if (act.kind != ActKind::kMotion) return;
    const auto* arc = source_.meaning.motions[static_cast<std::size_t>(act.motion)].piece.arc();
    if (arc == nullptr) return;
    const double rise = arc->axis.dot(arc->end - arc->start);
    constexpr double kNoRise = 1e-9;  // mm
    if (std::abs(rise) > kNoRise) text_.refuse(act.where, "is a helix");
  }

  const TranslationSource& source_;
  const gcode::Dialect& target_;
  TranslationText text_;
};

}  // namespace

Translation in_siemens(const TranslationSource& source, const gcode::Dialect& target,
                       std::string_view name) {
  return SiemensSpeaker(source, target, name).say();
}

}  // namespace batten::postproc
