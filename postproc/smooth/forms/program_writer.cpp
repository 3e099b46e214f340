#include "postproc/smooth/forms/program_writer.h"

#include <algorithm>

#include "gcode/curves/curve_format.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"
#include "gcode/writer/writer.h"
#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

using gcode::NumberFormat;
using gcode::Writer;

// The most digits after the point that can be printed.
constexpr int kMostDecimals = 9;

// Writes the moves of one run and counts what it writes.
class RunWriter {
 public:
  RunWriter(const gcode::Control& target, Writer writer)
      : target_(target), writer_(std::move(writer)) {}

  Writer& writer() { return writer_; }

  void write(const PlannedMove& move) {
    const std::size_t begin = writer_.text().size();
    if (const auto* arc = std::get_if<geometry::Arc>(&move.piece)) {
      if (const auto printed = writer_.arc_to(*arc, move.feed)) {
        result_.moves.push_back({*printed, move.feed});
        ++result_.arcs;
      } else {
        write_chords(*arc, move.feed);
      }
    } else {
      write_line(geometry::end_point(move.piece), move.feed);
    }
    count_from(begin);
  }

  // Curves of many blocks follow each other with the end of the one between them.
  [[nodiscard]] bool write(const PlannedCurve& curve, double feed, int last_decimals) {
    const std::size_t begin = writer_.text().size();
    if (!target_.curves->is_block_per_piece) writer_.end_curve();
    const auto printed = writer_.curve_to(curve.curve, feed, last_decimals);
    if (!printed) return false;
    for (const geometry::PathPiece& piece : *printed) result_.moves.push_back({piece, feed});
    count_from(begin);
    return true;
  }

  void copy(std::string_view comment, bool behind_words) {
    if (behind_words && writer_.add_comment(comment)) return;
    writer_.copy_line(comment);
    ++result_.blocks;
  }

  // The words of arcs and curves cannot be said again by themselves, and no block after a run needs
  // them (section.h).
  void restore(gcode::ModalState after) {
    const std::size_t begin = writer_.text().size();
    const bool curve = after.motion == gcode::MotionMode::kOther;
    if (is_arc(after.motion) || curve) after.motion = gcode::MotionMode::kUnknown;
    writer_.restore(after);
    count_from(begin);
  }

  [[nodiscard]] bool every_line_fits() const { return every_line_fits_; }

  RunText finished() {
    result_.text = writer_.text();
    return std::move(result_);
  }

 private:
  void write_line(const geometry::Point3& end, double feed) {
    const geometry::Point3 start = writer_.state().position.mm;
    writer_.line_to(end, feed);
    const geometry::Point3& reached = writer_.state().position.mm;
    if (reached != start) result_.moves.push_back({geometry::Line{start, reached}, feed});
  }

  // Chords that differ from the arc by half a printed step at most.
  void write_chords(const geometry::Arc& arc, double feed) {
    const gcode::Units units = writer_.state().modal.units;
    const double deviation = gcode::printed_step(place_format(target_, units), units) / 2;
    for (const geometry::PathPiece& chord : chords_for(arc, deviation)) {
      write_line(geometry::end_point(chord), feed);
    }
  }

  void count_from(std::size_t begin) {
    std::string_view written = std::string_view(writer_.text()).substr(begin);
    while (!written.empty()) {
      const std::size_t end = std::min(written.find_first_of("\r\n"), written.size());
      const std::string_view line = written.substr(0, end);
      every_line_fits_ = every_line_fits_ && line_length(target_, line) <= target_.max_line_length;
      // SPL has lines that go on with the block.
      if (!gcode::is_blank(line.front())) ++result_.blocks;
      const std::size_t next = written.find_first_not_of("\r\n", end);
      written = next == std::string_view::npos ? std::string_view() : written.substr(next);
    }
  }

  const gcode::Control& target_;
  Writer writer_;
  RunText result_;
  bool every_line_fits_ = true;
};

bool has_arcs(const OutputPlan& plan) {
  return std::ranges::any_of(plan.moves, [](const PlannedMove& move) {
    return std::holds_alternative<geometry::Arc>(move.piece);
  });
}

// A part of the numbers that a program may hold: what is made of them for a curve (differences of
// third order, sums of lengths) is one of them, too.
constexpr double kGreatestPlace = gcode::kNumberLimit / 16;

// Whether every position that the plan names is numbers that a program may hold.
bool names_numbers(const OutputPlan& plan, double unit) {
  const auto holds = [unit](const geometry::Point3& position) {
    return position.cwiseAbs().maxCoeff() / unit < kGreatestPlace;
  };
  return std::ranges::all_of(plan.moves,
                             [&](const PlannedMove& move) {
                               const auto* arc = std::get_if<geometry::Arc>(&move.piece);
                               return holds(geometry::end_point(move.piece)) &&
                                      (arc == nullptr || holds(arc->center));
                             }) &&
         std::ranges::all_of(plan.curves, [&](const PlannedCurve& curve) {
           return std::ranges::all_of(curve.curve.control_points(), holds);
         });
}

}  // namespace

std::optional<RunText> write_run(const OutputPlan& plan, const Run& run,
                                 const gcode::Program& program, const gcode::Control& target,
                                 gcode::ModalState before, const gcode::ModalState& after,
                                 std::string_view line_end) {
  // A run that ends where there was an arc does not restore it, so that one after it says its own.
  if (is_arc(before.motion)) before.motion = gcode::MotionMode::kUnknown;
  if (!names_numbers(plan, gcode::millimetres_per(before.units))) return std::nullopt;
  const gcode::Position start{run.points.front(), {true, true, true}};
  RunWriter out(target, Writer(target, {before, start}, line_end));
  if (after.feed_without_point) out.writer().use_feeds_without_point();
  if (has_arcs(plan) && !out.writer().centers_understood()) return std::nullopt;

  const auto copy_comments = [&](const std::vector<std::size_t>& comments) {
    for (const std::size_t i : comments) {
      out.copy(program.source.text(run.comments[i].text), run.comments[i].behind_words);
    }
  };
  NumberFormat format = may_have_arcs(plan.form) ? arc_end_format(target, before.units)
                                                 : place_format(target, before.units);
  if (!may_have_arcs(plan.form)) format.decimals = std::min(format.decimals, plan.most_decimals);
  out.writer().use_coordinates(format);
  auto curve = plan.curves.begin();
  for (std::size_t i = 0; i < plan.moves.size();) {
    const PlannedMove& move = plan.moves[i];
    copy_comments(move.comments_before);
    if (curve != plan.curves.end() && curve->first == i) {
      if (target.curves == nullptr) return std::nullopt;
      const std::size_t end = i + curve->count;
      const bool last = end == plan.moves.size();
      const int last_decimals = last ? std::min(run.decimals, kMostDecimals) : 0;
      if (!out.write(*curve, move.feed, last_decimals)) return std::nullopt;
      // Nothing stands inside a curve.
      for (++i; i < end; ++i) copy_comments(plan.moves[i].comments_before);
      ++curve;
      continue;
    }
    if (++i == plan.moves.size()) {
      format.decimals = std::min(std::max(format.decimals, run.decimals), kMostDecimals);
      out.writer().use_coordinates(format);
    }
    out.write(move);
  }
  copy_comments(plan.comments_after);
  out.restore(after);

  const geometry::Point3& reached = out.writer().state().position.mm;
  if ((reached - run.points.back()).norm() > geometry::kSamePlace) return std::nullopt;
  if (!out.every_line_fits()) return std::nullopt;
  return out.finished();
}

}  // namespace batten::postproc
