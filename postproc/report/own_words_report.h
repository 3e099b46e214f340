// What a user vouches for, and which programs are called, in every report that rests on it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gcode/state/own_words.h"
#include "postproc/stream/called_files.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// [{"word": "M501", "effect": "keeps state"}]
[[nodiscard]] Json own_words_json(const std::shared_ptr<const gcode::OwnWords>& words);

// [{"call": "O1234", "file": "O1234.nc", "why_not": ""}]; `why_not` is empty where it was read.
[[nodiscard]] Json called_json(const std::vector<CalledFile>& files);

// Lines of a summary; empty where nothing is vouched for.
[[nodiscard]] std::string own_words_text(const std::shared_ptr<const gcode::OwnWords>& words);

}  // namespace batten::postproc
