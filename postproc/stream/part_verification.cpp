#include "postproc/stream/part_verification.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "gcode/state/reason.h"
#include "geometry/path/path.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/self_meeting.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {

namespace {

// A part that is compared, with what it takes over.
struct FollowedPart {
  gcode::ReadPart part;
  EventsBefore before;
  std::uint32_t line_before = 0;
  std::optional<ProgramEvents> list = {};  // not of a whole

  [[nodiscard]] ReadProgram read() const {
    return {&part.program, &part.meaning, before, {}, line_before, list ? &*list : nullptr};
  }
};

// mm
double length_of(const gcode::Motion& motion) {
  const gcode::MotionPath& path = motion.piece;
  return path.is_line() ? (path.end() - path.start()).norm() : geometry::length_of(path);
}

// One of two programs that are compared: what of it is held, and where a part may end.
class ProgramStream {
 public:
  ProgramStream(const TextToVerify& text, const PartLimits& limits, bool as_whole)
      : reader_(text.source, text.reading, limits, as_whole) {}

  // False: it needs the whole.
  [[nodiscard]] bool read_on() {
    const auto next = reader_.read_on();
    if (next == PartReader::Next::kNeedsWhole) return false;
    at_end_ = next == PartReader::Next::kAtEnd;
    if (!reader_.is_whole()) look_at_new_blocks();
    return true;
  }
  [[nodiscard]] bool at_end() const { return at_end_; }

  [[nodiscard]] const gcode::ReadPart& held() const { return reader_.held(); }
  [[nodiscard]] std::uint32_t blocks_held() const { return reader_.blocks_held(); }
  // Blocks after plain rapids, of those that are held; of a whole none.
  [[nodiscard]] const std::vector<std::uint32_t>& ends() const { return ends_; }
  // mm, of the motions after the last of these, or since the begin of what is held.
  [[nodiscard]] double length() const { return length_; }

  // The first blocks that are held.
  [[nodiscard]] FollowedPart take(std::uint32_t count) {
    FollowedPart taken{reader_.take(count), before_, line_before_};
    if (reader_.is_whole()) return taken;
    before_ = taken.list.emplace(list_events(taken.read())).at_end;
    if (!taken.part.program.blocks.empty()) line_before_ = taken.part.program.blocks.back().line;
    ends_.clear();
    looked_at_ = 0;
    length_ = 0;
    look_at_new_blocks();
    return taken;
  }
  [[nodiscard]] std::optional<gcode::Diagnostics> finish() { return reader_.finish(); }

 private:
  void look_at_new_blocks() {
    const gcode::ReadPart& part = reader_.held();
    for (; looked_at_ < blocks_held(); ++looked_at_) {
      const gcode::BlockMeaning& block = part.meaning.blocks[looked_at_];
      if (block.motion < 0) continue;
      if (block.barrier == gcode::reason::kRapid &&
          is_plain_rapid({&part.program, &part.meaning}, looked_at_)) {
        ends_.push_back(looked_at_ + 1);
        length_ = 0;
      } else {
        for (const gcode::Motion& motion : gcode::motions_of(part.meaning, looked_at_)) {
          length_ += length_of(motion);
        }
      }
    }
  }

  PartReader reader_;
  EventsBefore before_;
  std::uint32_t line_before_ = 0;
  std::vector<std::uint32_t> ends_;
  std::uint32_t looked_at_ = 0;  // blocks that are held
  double length_ = 0;
  bool at_end_ = false;
};

// The cutting moves of a part, and those of them before its first and after its last event.
struct MovesOfPart {
  explicit MovesOfPart(const FollowedPart& part) : list(*part.list) {
    const std::size_t events = list.events.size();
    before_events = std::span<const Cut>(list.cuts).first(list.cuts_before.front());
    after_events =
        std::span<const Cut>(list.cuts).subspan(events > 0 ? list.cuts_before[events - 1] : 0);
  }

  const ProgramEvents& list;
  std::span<const Cut> before_events;
  std::span<const Cut> after_events;
};

// What the whole asks, beside the distance, of runs that are compared in parts.
class RunsInParts {
 public:
  explicit RunsInParts(double tolerance_mm) : tolerance_(tolerance_mm), new_path_(tolerance_mm) {}

  // The next pair of parts, which have the same events. `ends_in_run`: they end where a run is cut.
  // False: only the whole can say.
  [[nodiscard]] bool take(const FollowedPart& before, const FollowedPart& after, bool ends_in_run) {
    const bool begins_in_run = std::exchange(in_run_, ends_in_run);
    if (!begins_in_run && !ends_in_run) return true;
    const MovesOfPart old_moves(before);
    const MovesOfPart new_moves(after);
    const bool all_in_run = begins_in_run && ends_in_run && new_moves.list.events.empty();
    if (begins_in_run) {
      if (!goes_on(old_moves.before_events, new_moves.before_events)) return false;
      add(after, new_moves.before_events);
      const auto meets = [&] {
        return std::exchange(new_path_, SelfMeeting(tolerance_)).may_meet();
      };
      if (!all_in_run && meets()) return false;
    }
    if (!ends_in_run) return true;
    if (!all_in_run) add(after, new_moves.after_events);
    if (old_moves.after_events.empty() || new_moves.after_events.empty()) return false;
    old_last_ = old_moves.after_events.back();
    new_last_ = new_moves.after_events.back();
    return true;
  }

 private:
  // Both programs cut on at the feed before the cut, or neither does.
  [[nodiscard]] bool goes_on(std::span<const Cut> old_cuts, std::span<const Cut> new_cuts) const {
    if (old_cuts.empty() || new_cuts.empty()) return old_cuts.empty() && new_cuts.empty();
    return is_one_feed(old_last_, old_cuts.front()) == is_one_feed(new_last_, new_cuts.front());
  }

  void add(const FollowedPart& part, std::span<const Cut> cuts) {
    geometry::Path path;
    path.reserve(cuts.size());
    for (const Cut& cut : cuts) path.push_back(part.part.meaning.motions[cut.motion].piece);
    new_path_.add(path);
  }

  double tolerance_;
  SelfMeeting new_path_;  // of the run that goes on
  bool in_run_ = false;
  Cut old_last_;
  Cut new_last_;
};

// Two paths to one position may differ by so much: noise that one of them leaves out.
constexpr double kPathsApart = 0.1;

// Where a motion at feed rate ends.
struct MotionEnd {
  std::array<double, 3> at = {};
  double length = 0;  // mm, of the path up to there
  std::uint32_t block = 0;
  gcode::Plane plane = gcode::Plane::kXY;  // of arcs, behind it
};

std::vector<MotionEnd> motion_ends(const gcode::Interpretation& read) {
  std::vector<MotionEnd> ends;
  ends.reserve(read.motions.size());
  double length = 0;
  for (const gcode::Motion& motion : read.motions) {
    length += length_of(motion);
    if (motion.kind == gcode::MotionKind::kRapid || !motion.end_known) continue;
    const geometry::Point3 at = motion.piece.end();
    const gcode::Plane plane = read.states[read.blocks[motion.block].state_after].plane;
    ends.push_back({{at.x(), at.y(), at.z()}, length, motion.block, plane});
  }
  return ends;
}

// The ends of motions by position: those that may be at one are a chain.
class EndsByPosition {
 public:
  explicit EndsByPosition(const std::vector<MotionEnd>& ends)
      : first_(std::bit_ceil(2 * ends.size() + 1), kNone), next_(ends.size(), kNone) {
    for (std::uint32_t i = 0; i < ends.size(); ++i) {
      next_[i] = std::exchange(first_[chain_of(ends[i])], i);
    }
  }

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  [[nodiscard]] std::uint32_t first(const MotionEnd& end) const { return first_[chain_of(end)]; }
  [[nodiscard]] std::uint32_t next(std::uint32_t i) const { return next_[i]; }

 private:
  [[nodiscard]] std::size_t chain_of(const MotionEnd& end) const {
    std::uint64_t key = 0;
    for (const double x : end.at) {
      key = (key ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15U;  // -0 is 0
      key ^= key >> 29U;
    }
    return key & (first_.size() - 1);
  }

  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> next_;
};

// Where two long runs that go beside each other may be cut: the old and the new block after the
// last position, the same to the last digit, at which a motion of each ends about as far along, in
// the same plane: what is rewritten may have arcs in another one.
std::optional<std::pair<std::uint32_t, std::uint32_t>> last_common_position(
    const gcode::Interpretation& before, const gcode::Interpretation& after) {
  const std::vector<MotionEnd> old_ends = motion_ends(before);
  const std::vector<MotionEnd> new_ends = motion_ends(after);
  const EndsByPosition by_position(new_ends);
  // NOLINTNEXTLINE(modernize-loop-convert): Clang 14 reads no reverse views
  for (auto old = old_ends.rbegin(); old != old_ends.rend(); ++old) {
    const auto apart = [&](const MotionEnd& end) { return std::abs(end.length - old->length); };
    const MotionEnd* nearest = nullptr;  // the first of those as near
    for (auto i = by_position.first(*old); i != EndsByPosition::kNone; i = by_position.next(i)) {
      const MotionEnd& end = new_ends[i];
      if (end.at != old->at || end.plane != old->plane) continue;
      if (nearest == nullptr || apart(end) <= apart(*nearest)) nearest = &end;
    }
    if (nearest == nullptr) continue;
    if (apart(*nearest) > kPathsApart * std::max(old->length, nearest->length)) continue;
    return std::pair(old->block + 1, nearest->block + 1);
  }
  return std::nullopt;
}

class TextVerifier {
 public:
  TextVerifier(const TextToVerify& before, const TextToVerify& after, const Promise& promise,
               const VerifyLimits& limits, int threads, bool as_whole)
      : old_(before, limits.parts, as_whole),
        new_(after, limits.parts, as_whole),
        brackets_(after.brackets),
        promise_(promise),
        threads_(threads),
        as_whole_(as_whole),
        longest_(limits.longest),
        cut_from_(limits.longest),
        runs_(promise.tolerance_mm) {}

  // Nothing: the whole is to be asked.
  std::optional<VerifiedTexts> run(const std::function<bool()>& stopped) {
    if (as_whole_ && !read_both()) return std::nullopt;
    while (!(old_.at_end() && new_.at_end())) {
      if ((stopped && stopped()) || !read_on() || !compare_what_ends()) return std::nullopt;
    }
    auto of_old = old_.finish();
    auto of_new = new_.finish();
    if (!of_old || !of_new) return std::nullopt;
    result_.of_old = std::move(*of_old);
    result_.of_new = std::move(*of_new);
    result_.as_whole = as_whole_;
    if (!result_.understood()) return std::move(result_);
    if (!compare(old_.blocks_held(), new_.blocks_held(), false)) return std::nullopt;
    return std::move(result_);
  }

 private:
  // To their ends, beside each other.
  [[nodiscard]] bool read_both() {
    std::array<bool, 2> done = {};
    parallel_for(threads_, done.size(), [&](std::size_t i) {
      ProgramStream& stream = i == 0 ? old_ : new_;
      done[i] = true;
      while (done[i] && !stream.at_end()) done[i] = stream.read_on();
    });
    return done[0] && done[1];
  }

  // One part more of the old program, and of the new one as much as goes with it.
  [[nodiscard]] bool read_on() {
    if (!old_.at_end() && !old_.read_on()) return false;
    while (!new_.at_end() && is_new_behind()) {
      if (!new_.read_on()) return false;
    }
    // A rapid that the new program does not have.
    return !new_.at_end() || new_.ends().size() >= old_.ends().size();
  }

  [[nodiscard]] bool is_new_behind() const {
    if (old_.at_end() || new_.ends().size() < old_.ends().size()) return true;
    return new_.ends().size() == old_.ends().size() && new_.length() < old_.length();
  }

  [[nodiscard]] bool compare_what_ends() {
    const std::size_t rapids = std::min(old_.ends().size(), new_.ends().size());
    if (rapids > 0) return compare(old_.ends()[rapids - 1], new_.ends()[rapids - 1], false);
    if (as_whole_ || old_.blocks_held() < cut_from_ || promise_.side != geometry::Side::kBoth)
      return true;
    const auto ends = last_common_position(old_.held().meaning, new_.held().meaning);
    if (ends) return compare(ends->first, ends->second, true);
    cut_from_ = old_.blocks_held() + longest_ / 2;  // not to search the same blocks for each part
    return true;
  }

  // The first blocks of both that are held.
  [[nodiscard]] bool compare(std::uint32_t old_end, std::uint32_t new_end, bool in_run) {
    const FollowedPart before = old_.take(old_end);
    const FollowedPart after = new_.take(new_end);
    cut_from_ = longest_;
    Verification found = verify(before.read(), after.read(), promise_, threads_);
    if (!found.proved() && !as_whole_) return false;
    result_.in_brackets = events_in_brackets(after.read(), brackets_);
    add(std::move(found));
    return runs_.take(before, after, in_run);
  }

  void add(Verification found) {
    Verification& all = result_.verification;
    if (found.deviation_mm > all.deviation_mm) {
      all.deviation_mm = found.deviation_mm;
      all.deviation_line = found.deviation_line;
    }
    all.corner_mm = std::max(all.corner_mm, found.corner_mm);
    all.events_compared += found.events_compared;
    std::ranges::move(found.sections, std::back_inserter(all.sections));
    std::ranges::move(found.violations, std::back_inserter(all.violations));
  }

  ProgramStream old_;
  ProgramStream new_;
  const std::vector<LineBracket>& brackets_;
  const Promise& promise_;
  int threads_;
  bool as_whole_;
  std::size_t longest_;
  std::size_t cut_from_;  // so many old blocks are held before a run is cut
  RunsInParts runs_;
  VerifiedTexts result_;
};

}  // namespace

std::optional<VerifiedTexts> verify_texts(const TextToVerify& before, const TextToVerify& after,
                                          const Promise& promise,
                                          const std::function<bool()>& stopped,
                                          const VerifyLimits& limits) {
  const std::size_t both = before.source.text().size() + after.source.text().size();
  const int threads = both < limits.least_for_threads ? 1 : limits.threads;
  const auto verified = [&](bool as_whole) {
    return TextVerifier(before, after, promise, limits, threads, as_whole).run(stopped);
  };
  const bool plain = before.reading.text.language == gcode::Language::kRs274 &&
                     after.reading.text.language == gcode::Language::kRs274;
  const std::size_t size = std::max(before.source.text().size(), after.source.text().size());
  if (plain && size >= limits.parts.least_text && after.brackets.empty()) {
    if (auto in_parts = verified(false)) return in_parts;
  }
  return stopped && stopped() ? std::nullopt : verified(true);
}

}  // namespace batten::postproc
