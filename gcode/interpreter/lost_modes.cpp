#include "gcode/interpreter/lost_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr std::string_view kId = "modes-unknown";

// An item that is_known() asks for, and the words by which a program says that it is as runs want
// it, in each language; empty where it has none, or never loses the item.
struct ModeWords {
  bool (*is_unknown)(const ModalState&);
  std::string_view name;
  std::string_view rs274;
  std::string_view siemens;
  std::string_view klartext;
};
template <auto kItem, auto kUnknown>
bool is_unknown(const ModalState& state) {
  return state.*kItem == kUnknown;
}
template <auto kItem>
constexpr auto kSwitch = &is_unknown<kItem, TriState::kUnknown>;

using Modal = ModalState;
constexpr std::array kModeWords = {
    ModeWords{&is_unknown<&Modal::units, Units::kUnknown>, "units", "G20 or G21", "G70 or G71", ""},
    ModeWords{&is_unknown<&Modal::plane, Plane::kUnknown>, "plane", "G17", "G17",
              "TOOL CALL with Z"},
    ModeWords{&is_unknown<&Modal::distance, DistanceMode::kUnknown>, "distance", "G90", "G90", ""},
    ModeWords{&is_unknown<&Modal::arc_distance, DistanceMode::kUnknown>, "centres of arcs", "G91.1",
              "", ""},
    ModeWords{&is_unknown<&Modal::feed_mode, FeedMode::kUnknown>, "feed mode", "G94", "G94",
              "M137"},
    ModeWords{&is_unknown<&Modal::path, PathMode::kUnknown>, "path mode", "G64", "G64", ""},
    ModeWords{kSwitch<&Modal::cutter_compensation>, "cutter compensation", "G40", "G40", "R0"},
    ModeWords{kSwitch<&Modal::tool_center_point>, "tool centre point control", "G49", "TRAFOOF",
              "M129"},
    ModeWords{kSwitch<&Modal::tilted_plane>, "tilted plane", "G69", "CYCLE800()", "PLANE RESET"},
    ModeWords{kSwitch<&Modal::scaling>, "scaling", "G50", "TRANS",
              "CYCL DEF 26.1 X1 Y1 Z1, then CYCL DEF 11.1 SCL 1"},
    ModeWords{kSwitch<&Modal::rotation>, "rotation", "G69", "TRANS", "CYCL DEF 10.1 ROT+0"},
    ModeWords{kSwitch<&Modal::mirror>, "mirroring", "G50.1", "TRANS", "CYCL DEF 8.1"},
    ModeWords{kSwitch<&Modal::polar>, "polar coordinates", "G15", "TRAFOOF", ""},
    ModeWords{kSwitch<&Modal::cylindrical>, "cylindrical coordinates", "G7.1 C0", "TRAFOOF", ""},
    ModeWords{kSwitch<&Modal::control_smoothing>, "smoothing by the control", "G5.1 Q0", "COMPOF",
              "M113"},
    ModeWords{kSwitch<&Modal::modal_macro>, "modal macro", "G67", "MCALL",
              "CYCL DEF of a cycle that waits for its call"},
    ModeWords{kSwitch<&Modal::constant_surface_speed>, "constant surface speed", "G97", "G97", ""},
    ModeWords{kSwitch<&Modal::lathe_diameter>, "diameter mode", "G8", "DIAMOF", ""}};
// In the order of the bits of a ModeSet. The laser's, the last, is not asked for.
static_assert(kModeWords.size() == mode::kFirstSwitch + kModalSwitches.size() - 1);
static_assert(kModalSwitches.back().item == &Modal::laser_power_mode);

std::string_view words_of(const ModeWords& row, Language language) {
  return language == Language::kRs274     ? row.rs274
         : language == Language::kSiemens ? row.siemens
                                          : row.klartext;
}

// "plane (G17), scaling (G50)"
std::string missing_in(const ModalState& state, Language language) {
  std::vector<std::string> missing;
  for (const ModeWords& each : kModeWords) {
    if (!each.is_unknown(state)) continue;
    const std::string_view word = words_of(each, language);
    missing.push_back(word.empty() ? std::string(each.name)
                                   : fmt::format("{} ({})", each.name, word));
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

std::vector<std::string_view> words_of_all_modes(const Control& control) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < kModeWords.size(); ++i) {
    if ((control.lacks & (ModeSet{1} << i)) != 0) continue;
    std::string_view word = words_of(kModeWords[i], control.language);
    if (i == 0 && control.unit_words.mm == "G71") word = "G70 or G71";
    const bool is_new = !word.empty() && std::ranges::find(words, word) == words.end();
    if (is_new) words.push_back(word);
  }
  return words;
}

void follow_lost_modes(const Program& part, const Interpretation& read, LostModes& modes,
                       DiagnosticLimiter& limiter, Diagnostics& found) {
  std::uint32_t state = 0;
  bool known = is_known(read.states[0]);
  std::optional<std::uint32_t> missing_of;  // the state that modes.missing is of
  for (std::size_t i = 0; i < read.blocks.size(); ++i) {
    const BlockMeaning& meaning = read.blocks[i];
    const bool was_known = known;
    if (meaning.state_after != state) {
      state = meaning.state_after;
      known = is_known(read.states[state]);
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
      if (state != missing_of) modes.missing = missing_in(read.states[state], part.language);
      missing_of = state;
    }
  }
}

void tell_lost_modes(const LostModes& modes, Diagnostics& found) {
  if (modes.lost && modes.moves > 0) found.push_back(warning_of(modes));
}

}  // namespace batten::gcode
