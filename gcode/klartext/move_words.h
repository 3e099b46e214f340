// The words of L, C, CC and M statements of Klartext.
#pragma once

#include <string_view>
#include <vector>

#include "gcode/klartext/statement.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// Adds the words of RS-274 that say the same: G0 where FMAX stands, otherwise G1, G2 or G3, then
// axes, G40 to G42, F and M. Q parameters and F AUTO are words without a number. A bare R, F or M,
// as old controls print them, says nothing. False where anything else stands there (incremental
// words, feeds per tooth, M functions that change how motions are read ..), or where an arc has no
// DR, no end in X and Y, or a Z, or where a CR has no radius.
[[nodiscard]] bool read_klartext_move(KlartextKind kind, std::string_view text, SourceSpan content,
                                      std::vector<Word>& words);

// Adds I and J for `CC X+10 Y+0`. False where the centre is not two plain numbers.
[[nodiscard]] bool read_klartext_centre(std::string_view text, SourceSpan content,
                                        std::vector<Word>& words);

// M functions of machines and of the common set do what they do on other controls; these change
// how motions are read, or make some: M89, M91, M97 to M99 and everything above. M21 to M23 mirror
// elsewhere and are the builder's here.
[[nodiscard]] bool is_plain_function(double code);

}  // namespace batten::gcode
