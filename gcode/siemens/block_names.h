// The names of a Siemens block: what stands in it beside the words of one letter that it lists.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/siemens/lexer.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// In upper case, without index, value and arguments: SOFT, CYCLE832, G71, D; "G?" for a G word that
// is no whole number. Empty for a token that the block lists as a word (G1, X=5, CR=5), and for one
// that is neither a word nor a name. `source`: the text whose tokens the lexer gives.
[[nodiscard]] std::string siemens_name(std::string_view source, const SiemensToken& token);

struct SiemensName {
  std::string name;  // of a label: with its colon
  SourceSpan span;   // with value and arguments
};

// All names of a block, which is a span of `source`, in their order; labels too.
[[nodiscard]] std::vector<SiemensName> siemens_names_in(std::string_view source, SourceSpan block);

}  // namespace batten::gcode
