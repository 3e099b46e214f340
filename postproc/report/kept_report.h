// What keeps cutting moves from being rewritten, in words and as JSON.
#pragma once

#include <string>

#include "postproc/runs/kept_causes.h"
#include "postproc/text/json_values.h"

namespace batten::postproc {

// "93.1 % of the cutting length, since line 5 'G41 D1' (cutter-compensation)": of the moves where
// the length of some is not known.
[[nodiscard]] std::string cause_text(const KeptCauses& kept, const KeptCause& cause);

// "93 % cutter-compensation, line 5": of the greatest cause; empty where none keeps a tenth.
[[nodiscard]] std::string cause_in_brief(const KeptCauses& kept);

// Why a program has no run: its greatest cause and what to do about it, or that nothing cuts.
[[nodiscard]] std::string why_nothing(const KeptCauses& kept);

// Of the summary: the three greatest causes, each with what it means and, where it costs much, what
// to do.
void add_causes(const KeptCauses& kept, std::string& lines);

// {moves, moves_without_length, length_mm, causes: [{id, line, first_line, block, times, moves,
// moves_without_length, length_mm, share, text, advice, can_be_allowed}]}
[[nodiscard]] Json kept_json(const KeptCauses& kept);

}  // namespace batten::postproc
