#include "gcode/interpreter/lost_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/state/mode_words.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr std::string_view kId = "modes-unknown";

// "plane (G17), scaling (G50)"
std::string missing_in(const ModalState& state, ModeSet asked, Language language) {
  std::vector<std::string> missing;
  ModeSet bit = 1;
  for (const ModeWords& each : mode_words()) {
    const bool is_missing = (asked & bit) != 0 && each.is_unknown(state);
    bit <<= 1U;
    if (!is_missing) continue;
    std::vector<std::string_view> ways = {each.in(language), each.option};
    std::erase(ways, std::string_view{});
    missing.push_back(ways.empty() ? std::string(each.name)
                                   : fmt::format("{} ({})", each.name, fmt::join(ways, ", or ")));
  }
  return fmt::format("{}", fmt::join(missing, ", "));
}

Diagnostic warning_of(const LostModes& modes) {
  const std::string_view besides = modes.by_call
                                       ? ", or --allow subprogram where it leaves them as they were"
                                       : ", or say with --word what the block does";
  return {Severity::kWarning, kId, modes.where,
          fmt::format("which modes hold behind '{}' is not known, so {} block{} with X, Y or Z {} "
                      "copied; not set again before the last of them: {}. Set these after it, as "
                      "far as the control has the words{}",
                      modes.text, modes.moves, modes.moves == 1 ? "" : "s",
                      modes.moves == 1 ? "is" : "are", modes.missing, besides)};
}

bool names_place(const Program& program, const Block& block) {
  return std::ranges::any_of(program.words_of(block), [](const Word& word) {
    return word.letter >= 'X' && word.letter <= 'Z';
  });
}

}  // namespace

void follow_lost_modes(const Program& part, const std::vector<BlockFlow>& flow,
                       const Interpretation& read, ModeSet asked, LostModes& modes,
                       DiagnosticLimiter& limiter, Diagnostics& found) {
  std::uint32_t state = 0;
  bool known = is_known(read.states[0], asked);
  std::optional<std::uint32_t> missing_of;  // the state that modes.missing is of
  for (std::size_t i = 0; i < read.blocks.size(); ++i) {
    if (flow[i].in_definition != InDefinition::kNo) continue;
    const BlockMeaning& meaning = read.blocks[i];
    const bool was_known = known;
    if (meaning.state_after != state) {
      state = meaning.state_after;
      known = is_known(read.states[state], asked);
    }
    if (was_known && !known) {
      const Block& block = part.blocks[i];
      modes = {.lost = true,
               .where = block.span,
               .text = shown(part.source.text(block.span)),
               .by_call = meaning.barrier == reason::kSubprogram,
               .missing = {}};
    } else if (modes.lost && known) {
      modes.lost = false;
      if (modes.moves > 0 && limiter.counts(kId, modes.where)) found.push_back(warning_of(modes));
    } else if (modes.lost && names_place(part, part.blocks[i])) {
      ++modes.moves;
      if (state != missing_of) modes.missing = missing_in(read.states[state], asked, part.language);
      missing_of = state;
    }
  }
}

void tell_lost_modes(const LostModes& modes, Diagnostics& found) {
  if (modes.lost && modes.moves > 0) found.push_back(warning_of(modes));
}

}  // namespace batten::gcode
