#include "postproc/stream/part_verification.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>

#include "geometry/path/path.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/self_meeting.h"
#include "postproc/stream/program_stream.h"

namespace batten::postproc {

namespace {

bool is_one_feed(const Cut& a, const Cut& b) {
  return a.feed == b.feed && a.feed_without_point == b.feed_without_point;
}

// The cutting moves of a part at its two ends.
class MovesOfPart {
 public:
  explicit MovesOfPart(const FollowedPart& part) : part_(part), list_(list_events(part.read())) {}

  [[nodiscard]] bool has_events() const { return !list_.events.empty(); }
  [[nodiscard]] std::span<const Cut> before_events() const {
    return std::span<const Cut>(list_.cuts).first(list_.cuts_before.front());
  }
  [[nodiscard]] std::span<const Cut> behind_events() const {
    const std::size_t events = list_.events.size();
    return std::span<const Cut>(list_.cuts).subspan(events > 0 ? list_.cuts_before[events - 1] : 0);
  }
  [[nodiscard]] geometry::Path path_of(std::span<const Cut> cuts) const {
    geometry::Path path;
    path.reserve(cuts.size());
    for (const Cut& cut : cuts) path.push_back(part_.part.meaning.motions[cut.motion].piece);
    return path;
  }

 private:
  const FollowedPart& part_;
  ProgramEvents list_;
};

// What the whole asks, beside the distance, of runs that are compared in pieces.
class RunsInPieces {
 public:
  explicit RunsInPieces(double tolerance_mm) : tolerance_(tolerance_mm), new_path_(tolerance_mm) {}

  // The next pair of parts, which have the same events. `ends_in_run`: they end where a run is cut.
  // False: only the whole can say.
  [[nodiscard]] bool take(const FollowedPart& before, const FollowedPart& after, bool ends_in_run) {
    const bool begins_in_run = std::exchange(in_run_, ends_in_run);
    if (!begins_in_run && !ends_in_run) return true;
    const MovesOfPart old_moves(before);
    const MovesOfPart new_moves(after);
    const bool all_in_run = begins_in_run && ends_in_run && !new_moves.has_events();
    if (begins_in_run) {
      if (!goes_on(old_moves.before_events(), new_moves.before_events())) return false;
      new_path_.add(new_moves.path_of(new_moves.before_events()));
      if (!all_in_run && !end_run()) return false;
    }
    if (!ends_in_run) return true;
    if (!all_in_run) new_path_.add(new_moves.path_of(new_moves.behind_events()));
    return leave_open(old_moves.behind_events(), new_moves.behind_events());
  }

 private:
  // Both programs cut on at the feed before the cut, or neither does.
  [[nodiscard]] bool goes_on(std::span<const Cut> old_cuts, std::span<const Cut> new_cuts) const {
    if (old_cuts.empty() || new_cuts.empty()) return old_cuts.empty() && new_cuts.empty();
    return is_one_feed(old_last_, old_cuts.front()) == is_one_feed(new_last_, new_cuts.front());
  }

  [[nodiscard]] bool end_run() {
    return !std::exchange(new_path_, SelfMeeting(tolerance_)).may_meet();
  }

  [[nodiscard]] bool leave_open(std::span<const Cut> old_cuts, std::span<const Cut> new_cuts) {
    if (old_cuts.empty() || new_cuts.empty()) return false;
    old_last_ = old_cuts.back();
    new_last_ = new_cuts.back();
    return true;
  }

  double tolerance_;
  SelfMeeting new_path_;  // of the run that goes on
  bool in_run_ = false;
  Cut old_last_;
  Cut new_last_;
};

class PartVerifier {
 public:
  PartVerifier(const TextToVerify& before, const TextToVerify& after, const Promise& promise,
               const VerifyLimits& limits)
      : old_(before.source, before.reading, limits.parts),
        new_(after.source, after.reading, limits.parts),
        promise_(promise),
        longest_(limits.longest),
        cut_from_(limits.longest),
        runs_(promise.tolerance_mm) {}

  std::optional<VerifiedInParts> run(const std::function<bool()>& stopped) {
    while (!(old_.at_end() && new_.at_end())) {
      if ((stopped && stopped()) || !read_on() || !compare_what_ends()) return std::nullopt;
    }
    if (!compare(all_of(old_), all_of(new_), false)) return std::nullopt;
    auto of_old = old_.finish();
    auto of_new = new_.finish();
    if (!of_old || !of_new) return std::nullopt;
    return VerifiedInParts{std::move(result_), std::move(*of_old), std::move(*of_new)};
  }

 private:
  static std::uint32_t all_of(const ProgramStream& text) {
    return static_cast<std::uint32_t>(text.blocks_held());
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
    return new_.ends().size() == old_.ends().size() && new_.way() < old_.way();
  }

  [[nodiscard]] bool compare_what_ends() {
    const std::size_t ends = std::min(old_.ends().size(), new_.ends().size());
    if (ends > 0) return compare(old_.ends()[ends - 1], new_.ends()[ends - 1], false);
    if (old_.blocks_held() < cut_from_ || promise_.side != geometry::Side::kBoth) return true;
    const auto place = last_common_place(old_.held().meaning, new_.held().meaning);
    if (place) return compare(place->old_end, place->new_end, true);
    cut_from_ = old_.blocks_held() + longest_ / 2;  // what was looked at is not asked part for part
    return true;
  }

  // The first blocks of both that are held.
  [[nodiscard]] bool compare(std::uint32_t old_end, std::uint32_t new_end, bool in_run) {
    const FollowedPart before = old_.take(old_end);
    const FollowedPart after = new_.take(new_end);
    cut_from_ = longest_;
    Verification found = verify(before.read(), after.read(), promise_);
    if (!found.proved()) return false;
    add(std::move(found));
    return runs_.take(before, after, in_run);
  }

  void add(Verification found) {
    if (found.deviation_mm > result_.deviation_mm) {
      result_.deviation_mm = found.deviation_mm;
      result_.deviation_line = found.deviation_line;
    }
    result_.corner_mm = std::max(result_.corner_mm, found.corner_mm);
    result_.events_compared += found.events_compared;
    std::ranges::move(found.stretches, std::back_inserter(result_.stretches));
  }

  ProgramStream old_;
  ProgramStream new_;
  const Promise& promise_;
  std::size_t longest_;
  std::size_t cut_from_;  // so many old blocks are held before a run is cut
  RunsInPieces runs_;
  Verification result_;
};

}  // namespace

std::optional<VerifiedInParts> verify_in_parts(const TextToVerify& before,
                                               const TextToVerify& after, const Promise& promise,
                                               const std::function<bool()>& stopped,
                                               const VerifyLimits& limits) {
  return PartVerifier(before, after, promise, limits).run(stopped);
}

}  // namespace batten::postproc
