// What a user vouches for, in every report that rests on it.
#pragma once

#include <memory>
#include <string>

#include "gcode/state/own_words.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// [{"word": "M501", "effect": "keeps state"}]
[[nodiscard]] Json own_words_json(const std::shared_ptr<const gcode::OwnWords>& words);

// Lines of a summary; empty where nothing is vouched for.
[[nodiscard]] std::string own_words_text(const std::shared_ptr<const gcode::OwnWords>& words);

}  // namespace batten::postproc
