#include "postproc/convert/conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "gcode/reading/dropped_words.h"
#include "gcode/reading/source_kind.h"
#include "gcode/rs274/plain_words.h"
#include "gcode/state/code_table.h"
#include "gcode/state/dwell.h"
#include "gcode/state/source_marks.h"

namespace batten::postproc {
namespace {

constexpr std::string_view kCommonLetters = "NXYZIJKRFST";

// Programs with more obstacles than this have the rest counted.
constexpr std::size_t kMostTold = 50;

class BlockCheck {
 public:
  BlockCheck(const gcode::Program& program, const gcode::Control& target)
      : program_(program), target_(target) {}

  std::optional<Obstacle> obstacle_in(const gcode::Block& block) const {
    if (block.opacity == gcode::ParseStatus::kProgramMark) return std::nullopt;
    if (block.opacity != gcode::ParseStatus::kNone)
      return Obstacle{block.span, "is no block of plain words"};
    if (block.block_delete)
      return Obstacle{block.span, "is left out by some controls, run by others"};
    if (block.has_checksum) return Obstacle{block.span, "has a check sum"};
    if (line_length(target_, program_.source.text(block.span)) > target_.max_line_length) {
      return Obstacle{block.span,
                      fmt::format("is longer than {} characters", target_.max_line_length)};
    }
    const std::span<const gcode::Word> words = program_.words_of(block);
    if (const gcode::Word* dwell = find_word(words, 'G', word_code::kDwell)) {
      const std::string_view why = why_not_dwell(words);
      if (why.empty()) return std::nullopt;
      return Obstacle{dwell->span, std::string(why)};
    }
    for (const gcode::Word& word : words) {
      const std::string_view why = why_not(word, words);
      if (!why.empty()) return Obstacle{word.span, std::string(why)};
    }
    if (target_.repeats_words && moves_without_saying_how(words)) {
      return Obstacle{block.span,
                      "names no G0, G1, G2 or G3, which the target needs in every block"};
    }
    for (const gcode::Comment& comment : program_.comments_of(block)) {
      if (!can_say(comment)) return Obstacle{comment.span, "is no comment there"};
    }
    return std::nullopt;
  }

 private:
  // A dwell that waits as long on the target.
  std::string_view why_not_dwell(std::span<const gcode::Word> words) const {
    const auto ms = gcode::dwell_ms(words, program_.dwells);
    if (!ms) return why_no_certain_dwell(words, program_.dwells);
    const auto there = target_.dwell_form == gcode::DwellForm::kUnknown
                           ? std::nullopt
                           : gcode::dwell_ms(words, target_.dwell_form);
    if (!there) return "waits for a time that is not certain there";
    return there == ms ? "" : "waits for another time there";
  }

  std::string_view why_not(const gcode::Word& word, std::span<const gcode::Word> words) const {
    if (!word.is_number) return "has no plain number";
    const int code = gcode::code_of(word);
    if (refuses_word(target_, word.letter, code)) return "is not taken there";
    bool common = false;
    switch (word.letter) {
      case 'G':
        return why_not_g(code);
      case 'M':
        common = gcode::row_of_m(code).is(gcode::trait::kCommon);
        break;
      case 'H':
        common = find_word(words, 'G', word_code::kToolLengthOn) != nullptr;
        break;
      case 'I':
      case 'J':
      case 'K':
        return target_.arc_form == gcode::ArcForm::kRadius ? "may be no offset there" : "";
      default:
        common = kCommonLetters.find(word.letter) != std::string_view::npos;
    }
    return common ? "" : kOtherThere;
  }

  std::string_view why_not_g(int code) const {
    if (const auto meaning = other_meaning(target_, code); !meaning.empty()) return meaning;
    const gcode::CodeRow& row = gcode::row_of_g(code);
    if (!row.is(gcode::trait::kCommon)) return kOtherThere;
    const bool wrong_plane = row.group == gcode::CodeGroup::kPlane &&
                             !takes_arcs_in(target_, row.value.as<gcode::Plane>());
    return wrong_plane ? "is no plane of arcs there" : "";
  }

  static bool moves_without_saying_how(std::span<const gcode::Word> words) {
    bool moves = false;
    bool says_how = false;
    for (const gcode::Word& word : words) {
      moves = moves || (word.letter >= 'X' && word.letter <= 'Z');
      says_how = says_how ||
                 (word.letter == 'G' && gcode::row_of_g(gcode::code_of(word)).is_plain_motion());
    }
    return moves && !says_how;
  }

  bool can_say(const gcode::Comment& comment) const {
    const std::string said = comment_line(target_, "x");
    return comment.kind != gcode::CommentKind::kActive && !said.empty() &&
           program_.source.text(comment.span).front() == said.front();
  }

  const gcode::Program& program_;
  const gcode::Control& target_;
};

// A dwell that waits for another time on the target.
struct OtherDwell {
  gcode::SourceSpan where;
  std::int32_t ms = 0;
  std::int32_t ms_there = 0;
};

// The first one. What G4 P means is known only where the user has named the source.
std::optional<OtherDwell> other_dwell(const gcode::Program& program, const gcode::Control& target) {
  const gcode::DwellForm there = target.dwell_form;
  if (program.dwells == gcode::DwellForm::kUnknown || there == gcode::DwellForm::kUnknown ||
      program.dwells == there) {
    return std::nullopt;
  }
  for (const gcode::Block& block : program.blocks) {
    const auto words = program.words_of(block);
    if (find_word(words, 'G', word_code::kDwell) == nullptr) continue;
    const auto ms = gcode::dwell_ms(words, program.dwells);
    const auto ms_there = gcode::dwell_ms(words, there);
    if (ms && ms_there && ms != ms_there) return OtherDwell{block.span, *ms, *ms_there};
  }
  return std::nullopt;
}

// Where the program says its language, if it does, and what says so.
std::pair<gcode::SourceSpan, std::string> evidence_of(gcode::Language language,
                                                      const gcode::SourceText& source,
                                                      const SmoothOptions& options) {
  constexpr std::string_view kFound = "found {}, so this is";
  for (const gcode::LanguageMark& each : gcode::language_marks(source)) {
    if (each.language == language) return {each.where, fmt::format(kFound, each.evidence)};
  }
  const auto plain = gcode::plain_beginning(source);
  const bool by_text = options.source == gcode::SourceKind::kAuto && plain;
  return {plain.value_or(gcode::SourceSpan{}),
          by_text ? fmt::format(kFound, source.text(*plain)) : "--source says that this is"};
}

}  // namespace

std::optional<gcode::Language> language_read(const gcode::SourceText& source,
                                             const SmoothOptions& options,
                                             gcode::Diagnostics& found) {
  const gcode::Language of_target = options.target->language;
  const auto language = gcode::source_language(source, options.source, of_target, found);
  const bool plain = language == gcode::Language::kRs274 && of_target == gcode::Language::kSiemens;
  if (!language || *language == of_target || plain) return language;
  const auto [where, evidence] = evidence_of(*language, source, options);
  found.push_back(
      {gcode::Severity::kError, "foreign-language", where,
       fmt::format("{} a program in {}; target {} reads {}, and --convert says it there "
                   "where every block can be said",
                   evidence, gcode::describe(*language), options.target->name,
                   gcode::describe(of_target))});
  return std::nullopt;
}

std::optional<gcode::Language> language_before_target(const gcode::SourceText& source,
                                                      gcode::SourceKind kind,
                                                      gcode::Language target) {
  const auto fallback = target == gcode::Language::kSiemens ? std::optional(target) : std::nullopt;
  gcode::Diagnostics uncertain;
  return gcode::source_language(source, kind, fallback, uncertain);
}

std::optional<gcode::Language> language_to_translate(const gcode::SourceText& source,
                                                     const SmoothOptions& options) {
  if (!options.convert) return std::nullopt;
  const auto language = language_before_target(source, options.source, options.target->language);
  return language == options.target->language ? std::nullopt : language;
}

gcode::Reading reading_of(const SmoothOptions& options, gcode::Language language) {
  const gcode::Decimals decimals =
      gcode::decimals_read(options.source, options.target, language, options.decimals);
  return {.language = language,
          .decimals = decimals,
          .units = options.units,
          .dwells = gcode::dwells_of(options.source),
          .keeps_expressions = options.keep_expressions};
}

void tell_of_other_family(const gcode::Program& program, const gcode::Control& target,
                          gcode::Diagnostics& found) {
  for (const gcode::FoundMark& each : gcode::source_marks(program)) {
    if ((target.known_marks & gcode::mark(each.mark)) != 0) continue;
    const std::string_view name = gcode::droppable_name(program.source.text(each.where));
    const std::string to_do = name.empty() ? "--convert lists which blocks could not be said there"
                                           : fmt::format("--drop {} takes such words out", name);
    found.push_back({gcode::Severity::kError, "other-family", each.where,
                     fmt::format("{}: a program for other controls than target {}; {}",
                                 gcode::describe(each.mark), target.name, to_do)});
  }
  if (const auto dwell = other_dwell(program, target)) {
    found.push_back(
        {gcode::Severity::kError, "other-family", dwell->where,
         fmt::format("{} waits for {} s on the control that --source names, and for {} s "
                     "on target {}; --convert lists which blocks could not be said "
                     "there",
                     program.source.text(dwell->where), gcode::dwell_seconds(dwell->ms, false),
                     gcode::dwell_seconds(dwell->ms_there, false), target.name)});
  }
}

void tell_what_cannot_be_said(const gcode::Program& program, const gcode::Control& target,
                              gcode::Diagnostics& found) {
  const BlockCheck check(program, target);
  std::vector<Obstacle> obstacles;
  for (const gcode::Block& block : program.blocks) {
    if (auto obstacle = check.obstacle_in(block)) obstacles.push_back(std::move(*obstacle));
  }
  tell_obstacles(obstacles, program, target, found);
}

void tell_obstacles(const std::vector<Obstacle>& obstacles, const gcode::Program& program,
                    const gcode::Control& target, gcode::Diagnostics& found) {
  constexpr std::size_t kMostShown = 40;  // characters
  const std::size_t told = std::min(obstacles.size(), kMostTold);
  for (std::size_t i = 0; i < told; ++i) {
    const std::string_view text = program.source.text(obstacles[i].where);
    found.push_back(
        {gcode::Severity::kError, "cannot-convert", obstacles[i].where,
         fmt::format("{}{} {} (target {})", text.substr(0, kMostShown),
                     text.size() > kMostShown ? ".." : "", obstacles[i].why, target.name)});
  }
  if (obstacles.size() > told) {
    found.push_back(
        {gcode::Severity::kError, "cannot-convert", obstacles[told].where,
         fmt::format("from here on {} more blocks of this kind", obstacles.size() - told)});
  }
}

const gcode::Word* find_word(std::span<const gcode::Word> words, char letter,
                             std::optional<int> code) {
  const auto found = std::ranges::find_if(words, [&](const gcode::Word& word) {
    return word.letter == letter && (!code || gcode::code_of(word) == *code);
  });
  return found == words.end() ? nullptr : &*found;
}

std::string_view why_no_certain_dwell(std::span<const gcode::Word> words, gcode::DwellForm form) {
  if (form == gcode::DwellForm::kSecondsF && find_word(words, 'S') != nullptr) {
    return "waits for turns of the spindle, which is no time";
  }
  if (form == gcode::DwellForm::kUnknown && find_word(words, 'P') != nullptr) {
    return "waits for seconds on some controls and for milliseconds on others; --source ngc, grbl, "
           "fanuc or haas says which";
  }
  return "waits for a time that is not certain";
}

}  // namespace batten::postproc
