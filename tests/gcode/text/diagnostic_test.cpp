#include "gcode/text/diagnostic.h"

#include <gtest/gtest.h>

namespace batten::gcode {
namespace {

TEST(Diagnostic, SaysFilePlaceSeverityIdAndMessage) {
  const SourceText source("part.nc", "G21\nG2 X1 R5\n");
  const Diagnostic radius{Severity::kError, "arc-radius-mismatch", SourceSpan{7, 9},
                          "start radius 10.000 mm, end radius 10.412 mm"};
  EXPECT_EQ(to_text(radius, source),
            "part.nc:2:4: error: arc-radius-mismatch: start radius 10.000 mm, end radius "
            "10.412 mm");
  const Diagnostic note{Severity::kNote, "a-note", SourceSpan{0, 3}, "text"};
  EXPECT_EQ(to_text(note, source), "part.nc:1:1: note: a-note: text");
  const Diagnostic warning{Severity::kWarning, "a-warning", SourceSpan{4, 4}, "text"};
  EXPECT_EQ(to_text(warning, source), "part.nc:2:1: warning: a-warning: text");
}

TEST(Diagnostic, OnlyAnErrorIsAnError) {
  Diagnostics found;
  EXPECT_FALSE(has_error(found));
  found.push_back({Severity::kNote, "a-note", {}, ""});
  found.push_back({Severity::kWarning, "a-warning", {}, ""});
  EXPECT_FALSE(has_error(found));
  found.push_back({Severity::kError, "an-error", {}, ""});
  EXPECT_TRUE(has_error(found));
}

}  // namespace
}  // namespace batten::gcode
