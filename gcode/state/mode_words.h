// The modes that runs ask for, by name, and the words by which a program says them.
#pragma once

#include <span>
#include <string_view>

#include "gcode/state/modal_state.h"
#include "gcode/text/language.h"

namespace batten::gcode {

// A mode that is_known() asks for, and the words that set it as runs want it, in each language;
// empty where the language has none, or never loses the mode.
struct ModeWords {
  bool (*is_unknown)(const ModalState&);
  std::string_view name;
  std::string_view rs274;
  std::string_view siemens;
  std::string_view klartext;
  std::string_view option = {};  // with which runs go without the mode

  [[nodiscard]] std::string_view in(Language language) const {
    return language == Language::kRs274     ? rs274
           : language == Language::kSiemens ? siemens
                                            : klartext;
  }
};

// In the order of the bits of a ModeSet.
[[nodiscard]] std::span<const ModeWords> mode_words();

}  // namespace batten::gcode
