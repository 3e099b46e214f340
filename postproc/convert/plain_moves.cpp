#include "postproc/convert/plain_moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "gcode/controls/arc_rules.h"
#include "gcode/state/modal_state.h"
#include "gcode/writer/writer.h"

namespace batten::postproc {
namespace {

using gcode::MotionMode;

// mm: an arc that rises by more is a helix.
constexpr double kNoRise = 1e-9;

// mm: how far the arc leaves so many chords of equal length.
double sagitta_of(const geometry::Arc& arc, int chords) {
  const geometry::Vector3 from_center = arc.start - arc.center;
  const double radius = (from_center - from_center.dot(arc.axis) * arc.axis).norm();
  const double half = std::abs(arc.sweep) / 2 / chords;
  return radius * (1 - std::cos(std::min(half, std::numbers::pi)));
}

}  // namespace

PlainMoves::PlainMoves(const gcode::Control& target, TranslationText& text)
    : target_(target), text_(text) {
  modal_.units = gcode::Units::kMillimetre;
}

void PlainMoves::use_units(gcode::Units units) {
  modal_.units = units == gcode::Units::kInch ? units : gcode::Units::kMillimetre;
  unit_ = gcode::millimetres_per(modal_.units);
  modal_.feed.reset();
}

std::string_view PlainMoves::unit_word() const { return gcode::unit_word(target_, modal_.units); }

std::string_view PlainMoves::other_meaning_of_units() const {
  const std::string_view word = unit_word();
  if (word == "G20") return other_meaning(target_, 200);
  return word == "G21" ? other_meaning(target_, 210) : "";
}

void PlainMoves::forget_modes() {
  modal_.motion = MotionMode::kUnknown;
  modal_.feed.reset();
}

std::string PlainMoves::say(const gcode::Motion& motion, std::optional<double> feed,
                            std::uint32_t source_line) {
  source_line_ = source_line;
  const auto* arc = motion.piece.arc();
  return arc != nullptr ? say_arc(*arc, *feed) : say_straight(motion, feed);
}

std::string PlainMoves::say_straight(const gcode::Motion& motion, std::optional<double> feed) {
  gcode::SpokenBlock block;
  const geometry::Point3 end = motion.piece.end();
  for (int axis = 0; axis < 3; ++axis) {
    if (motion.axes_named[static_cast<std::size_t>(axis)]) print_place(end, axis, block);
  }
  const bool rapid = motion.kind == gcode::MotionKind::kRapid;
  return say_block(block, rapid ? MotionMode::kRapid : MotionMode::kLine, feed);
}

void PlainMoves::print_place(const geometry::Point3& end, int axis, gcode::SpokenBlock& block) {
  std::string digits = text_.place(end[axis], axis, place_format(target_, modal_.units), unit_);
  place_[axis] = gcode::read_number(digits)->value * unit_;
  block.places[static_cast<std::size_t>(axis)] = std::move(digits);
}

std::string PlainMoves::say_block(gcode::SpokenBlock& block, MotionMode motion,
                                  std::optional<double> feed) {
  if (modal_.motion != motion || target_.repeats_words) block.motion = motion;
  modal_.motion = motion;
  if (feed && modal_.feed != feed) {
    block.feed = gcode::to_text(*feed / unit_, feed_format(target_));
    modal_.feed = feed;
  }
  std::string line;
  gcode::add_lines(block, target_.language, target_.blanks, "", line);
  return add_line(std::move(line));
}

std::string PlainMoves::add_line(std::string line) {
  line.insert(0, std::exchange(before_next_, {}));
  if (line_length(target_, line) > target_.max_line_length) {
    return fmt::format("needs a line of more than {} characters", target_.max_line_length);
  }
  text_.add(line, source_line_);
  return {};
}

// In as many parts as the target needs: its arcs may be short, and full turns none.
std::string PlainMoves::say_arc(const geometry::Arc& arc, double feed) {
  if (std::abs(arc.axis.dot(arc.end - arc.start)) > kNoRise && !target_.helices) {
    return "is a helix";
  }
  const gcode::PlaneAxes* plane = gcode::plane_across(arc.axis);
  if (plane == nullptr || !takes_arcs_in(target_, plane->plane))
    return "is an arc in another plane";
  constexpr double kSlack = 1e-9;  // of a part: none more for the rounding of a half turn
  const int least = std::max(
      1, static_cast<int>(std::ceil(std::abs(arc.sweep) / max_arc_sweep(target_) - kSlack)));
  for (const int parts : {least, least + 1, 2 * (least + 1)}) {
    if (const auto lines = arc_in_parts(arc, *plane, feed, parts)) return add_lines(*lines);
  }
  constexpr int kMostChords = 100;
  for (int chords = 1; chords <= kMostChords; ++chords) {
    const double sagitta = sagitta_of(arc, chords);
    if (sagitta > printed_step()) continue;
    text_.add_rounding(sagitta);
    return say_chords(arc, *plane, feed, chords);
  }
  const std::string_view why = gcode::arc_refusal(target_, arc, modal_.units);
  return why.empty() ? "is an arc that rounding would change"
                     : fmt::format("is an arc that is not taken there: {}", why);
}

// The blocks, where the target takes all parts; only then this knows that they were said.
std::optional<std::string> PlainMoves::arc_in_parts(const geometry::Arc& arc,
                                                    const gcode::PlaneAxes& plane, double feed,
                                                    int parts) {
  gcode::Position start{place_, {true, true, true}};
  const bool level = std::abs(arc.axis.dot(arc.end - arc.start)) <= kNoRise;
  if (level) start.mm[plane.normal] = arc.start[plane.normal];
  gcode::Writer writer(target_, {modal_, start}, "\n");
  for (int i = 0; i < parts; ++i) {
    const auto part = geometry::sub_piece(geometry::PathPiece(arc), static_cast<double>(i) / parts,
                                          static_cast<double>(i + 1) / parts);
    if (!writer.arc_to(std::get<geometry::Arc>(part), feed)) return std::nullopt;
  }
  modal_ = writer.state().modal;
  modal_.feed = feed;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == plane.normal && level) continue;
    note_rounding(arc.end[axis], axis);
    place_[axis] = writer.state().position.mm[axis];
  }
  return writer.text();
}

void PlainMoves::note_rounding(double mm, int axis) {
  (void)text_.place(mm, axis, place_format(target_, modal_.units), unit_);
}

std::string PlainMoves::add_lines(std::string_view lines) {
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    if (std::string why = add_line(std::string(lines.substr(0, end))); !why.empty()) return why;
    lines.remove_prefix(end + 1);
  }
  return {};
}

std::string PlainMoves::say_chords(const geometry::Arc& arc, const gcode::PlaneAxes& plane,
                                   double feed, int chords) {
  const bool rises = std::abs(arc.axis.dot(arc.end - arc.start)) > kNoRise;
  for (int i = 1; i <= chords; ++i) {
    gcode::SpokenBlock block;
    const geometry::Point3 end =
        geometry::point_at(geometry::PathPiece(arc), static_cast<double>(i) / chords);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis != plane.normal || rises) print_place(end, axis, block);
    }
    if (std::string why = say_block(block, MotionMode::kLine, feed); !why.empty()) return why;
  }
  return {};
}

double PlainMoves::printed_step() const {
  return gcode::printed_step(place_format(target_, modal_.units), modal_.units);
}

}  // namespace batten::postproc
