// Motions as blocks of plain words, for one target.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/control/block_spelling.h"
#include "gcode/control/control.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "postproc/convert/translation.h"

namespace batten::postproc {

class PlainMoves {
 public:
  // Blocks go to `text`, which must outlive it.
  PlainMoves(const gcode::Control& target, TranslationText& text);

  // From here on places are in these units. Says nothing.
  void use_units(gcode::Units units);
  [[nodiscard]] gcode::Units units() const { return modal_.units; }

  // G21, G20; or the target's own words for them.
  [[nodiscard]] std::string_view unit_word() const;

  // What the target takes its unit word for instead; empty where it is its own.
  [[nodiscard]] std::string_view other_meaning_of_units() const;

  // Motion word and feed are said again: a tool change may have a program of its own.
  void forget_modes();

  // Words that stand before those of the next motion, in its block.
  void say_before_next(std::string words) { before_next_ = std::move(words) + " "; }

  // The axes that the motion names, all that is known of it at `feed` (mm/min). Returns why the
  // target cannot be told; else empty.
  [[nodiscard]] std::string say(const gcode::Motion& motion, std::optional<double> feed,
                                std::uint32_t source_line);

 private:
  [[nodiscard]] std::string say_straight(const gcode::Motion& motion, std::optional<double> feed);
  [[nodiscard]] std::string say_arc(const geometry::Arc& arc, double feed);
  [[nodiscard]] std::string say_chords(const geometry::Arc& arc, const gcode::PlaneAxes& plane,
                                       double feed, int chords);
  [[nodiscard]] std::optional<std::string> arc_in_parts(const geometry::Arc& arc,
                                                        const gcode::PlaneAxes& plane, double feed,
                                                        int parts);
  [[nodiscard]] std::string say_block(gcode::SpokenBlock& block, gcode::MotionMode motion,
                                      std::optional<double> feed);
  void print_place(const geometry::Point3& end, int axis, gcode::SpokenBlock& block);
  void note_rounding(double mm, int axis);
  [[nodiscard]] double printed_step() const;
  [[nodiscard]] std::string add_line(std::string line);
  [[nodiscard]] std::string add_lines(std::string_view lines);

  const gcode::Control& target_;
  TranslationText& text_;
  std::uint32_t source_line_ = 1;
  gcode::ModalState modal_;                            // as the control has it
  geometry::Point3 place_ = geometry::Point3::Zero();  // as printed, mm; 0 where not known
  double unit_ = 1;                                    // mm
  std::string before_next_;
};

}  // namespace batten::postproc
