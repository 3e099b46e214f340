#include "postproc/stream/program_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

#include "gcode/state/reason.h"
#include "geometry/path/path.h"

namespace batten::postproc {

namespace {

// Two ways to one place may differ by so much: noise that one of them leaves out.
constexpr double kWaysApart = 0.1;

struct PlaceOnWay {
  std::uint64_t key = 0;  // of the place
  double way = 0;         // mm, up to there
  std::uint32_t motion = 0;
};

// Places that are the same have the same key; 0 and -0 are.
std::uint64_t key_of(const geometry::Point3& place) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    key = (key ^ std::bit_cast<std::uint64_t>(place[axis] + 0.0)) * 0x9E3779B97F4A7C15U;
    key ^= key >> 29U;
  }
  return key;
}

// The ends of the motions at feed rate.
std::vector<PlaceOnWay> places_of(const gcode::Interpretation& read) {
  std::vector<PlaceOnWay> places;
  places.reserve(read.motions.size());
  double way = 0;
  for (std::size_t i = 0; i < read.motions.size(); ++i) {
    const gcode::Motion& motion = read.motions[i];
    way += way_of(motion);
    if (motion.kind == gcode::MotionKind::kRapid || !motion.end_known) continue;
    places.push_back({key_of(motion.piece.end()), way, static_cast<std::uint32_t>(i)});
  }
  return places;
}

// Which keys there may be, in little room.
class KeyFilter {
 public:
  explicit KeyFilter(const std::vector<PlaceOnWay>& places) : bits_(kBits) {
    for (const PlaceOnWay& place : places) bits_[place.key % kBits] = true;
  }
  [[nodiscard]] bool may_have(std::uint64_t key) const { return bits_[key % kBits]; }

 private:
  static constexpr std::size_t kBits = std::size_t{1} << 20;
  std::vector<bool> bits_;
};

bool as_far(const PlaceOnWay& a, const PlaceOnWay& b) {
  return std::abs(a.way - b.way) <= kWaysApart * std::max(a.way, b.way);
}

}  // namespace

double way_of(const gcode::Motion& motion) {
  const gcode::MotionPath& path = motion.piece;
  return path.is_line() ? (path.end() - path.start()).norm() : geometry::length_of(path);
}

bool ProgramStream::read_on() {
  const auto next = reader_.read_on();
  if (next == PartReader::Next::kNeedsWhole) return false;
  at_end_ = next == PartReader::Next::kAtEnd;
  look_at_new_blocks();
  return true;
}

void ProgramStream::look_at_new_blocks() {
  const gcode::ReadPart& part = reader_.held();
  const auto count = static_cast<std::uint32_t>(part.program.blocks.size());
  for (; looked_at_ < count; ++looked_at_) {
    const gcode::BlockMeaning& block = part.meaning.blocks[looked_at_];
    if (block.motion < 0) continue;
    if (block.barrier == gcode::reason::kRapid &&
        is_plain_rapid({&part.program, &part.meaning}, looked_at_)) {
      ends_.push_back(looked_at_ + 1);
      way_ = 0;
    } else {
      way_ += way_of(part.meaning.motions[static_cast<std::size_t>(block.motion)]);
    }
  }
}

FollowedPart ProgramStream::take(std::uint32_t count) {
  FollowedPart taken{reader_.take(count), before_, line_before_};
  before_ = events_before_next(taken.read());
  if (!taken.part.program.blocks.empty()) line_before_ = taken.part.program.blocks.back().line;
  ends_.clear();
  looked_at_ = 0;
  way_ = 0;
  look_at_new_blocks();
  return taken;
}

std::optional<CommonPlace> last_common_place(const gcode::Interpretation& before,
                                             const gcode::Interpretation& after) {
  const std::vector<PlaceOnWay> old_places = places_of(before);
  std::vector<PlaceOnWay> new_places = places_of(after);
  const KeyFilter filter(new_places);
  std::ranges::stable_sort(new_places, {}, &PlaceOnWay::key);
  for (std::size_t i = old_places.size(); i-- > 0;) {
    const PlaceOnWay& old = old_places[i];
    if (!filter.may_have(old.key)) continue;
    const auto first = std::ranges::lower_bound(new_places, old.key, {}, &PlaceOnWay::key);
    const auto last = std::ranges::upper_bound(new_places, old.key, {}, &PlaceOnWay::key);
    if (first == last) continue;
    const auto nearest = std::ranges::min_element(
        first, last, {}, [&](const PlaceOnWay& place) { return std::abs(place.way - old.way); });
    const gcode::Motion& old_motion = before.motions[old.motion];
    const gcode::Motion& new_motion = after.motions[nearest->motion];
    if (!as_far(old, *nearest) || old_motion.piece.end() != new_motion.piece.end()) continue;
    return CommonPlace{old_motion.block + 1, new_motion.block + 1};
  }
  return std::nullopt;
}

}  // namespace batten::postproc
