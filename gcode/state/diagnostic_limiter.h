// How often the same trouble was reported: a program of rubbish must not bury its reader.
#pragma once

#include <cstddef>
#include <set>
#include <string_view>
#include <vector>

#include "gcode/state/code_table.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/source_text.h"

namespace batten::gcode {

// Of one id, as much as is reported one by one.
inline constexpr std::size_t kMostTold = 50;

// Counts diagnostics of one id.
struct ToldCount {
  std::size_t told = 0;
  std::size_t untold = 0;
  SourceSpan first_untold;

  // May one more be told?
  bool counts(SourceSpan where) {
    if (told < kMostTold) {
      ++told;
      return true;
    }
    if (untold++ == 0) first_untold = where;
    return false;
  }
};

// Counts them by their ids, and codes that are told of once.
class DiagnosticLimiter {
 public:
  // May one more of this id be told?
  bool counts(std::string_view id, SourceSpan where);
  bool is_new(Code code) { return codes_.insert(code).second; }
  // One warning for each id of which more was to tell.
  void tell_rest(Diagnostics& found) const;

 private:
  struct OfId {
    std::string_view id;
    ToldCount count;
  };
  std::vector<OfId> ids_;
  std::set<Code> codes_;
};

}  // namespace batten::gcode
