// The lines of a translation as they come.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/control/dialect.h"
#include "gcode/text/number_format.h"
#include "geometry/basic/point.h"
#include "postproc/convert/translation.h"

namespace batten::postproc {

class TranslationText {
 public:
  // `source_line`: from 1.
  void add(std::string_view line, std::uint32_t source_line) {
    result_.text += line;
    result_.text += '\n';
    result_.source_lines.push_back(source_line);
  }

  // "; text", in as many lines as its length takes; characters that are no plain text become ?.
  void add_comment(std::string_view text, std::uint32_t source_line, std::size_t longest);

  void refuse(gcode::SourceSpan where, std::string why) {
    result_.obstacles.push_back({where, std::move(why)});
  }

  // A comment of the target, in as many lines as its length takes; characters that its comments
  // cannot have become -. False where it has no comments, and none for an empty text.
  [[nodiscard]] bool add_comment_of(const gcode::Dialect& target, std::string_view text,
                                    std::uint32_t source_line);

  // The digits of a place, whose rounding is remembered. `unit`: mm.
  [[nodiscard]] std::string place(double mm, int axis, const gcode::NumberFormat& format,
                                  double unit = 1);

  // What is off by as much beside that, mm on each axis.
  void add_rounding(double mm) { beside_ = std::max(beside_, mm); }

  [[nodiscard]] Translation take();

 private:
  Translation result_;
  geometry::Point3 rounding_ = geometry::Point3::Zero();  // greatest on each axis, mm
  double beside_ = 0;                                     // mm
};

}  // namespace batten::postproc
