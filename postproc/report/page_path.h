// The tool path as the page of `batten smooth --report` draws it: the old path from place to place,
// each with the place of the new path that the proof has matched with it.
//
// Made from the two texts alone, by the verifier's own reading and comparison: the deviation along
// the path is the distance of the pairs that are the certificate of the proof
// (geometry/distance/path_distance.h), not a nearest-point distance measured beside it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/basic/point.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/verification.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// What leads to a vertex from the one before it.
enum class PageStep : std::uint8_t {
  kNone,       // nothing: a chain of moves begins here
  kRapid,      // copied
  kCopied,     // a cutting move that is the same in both programs
  kRewritten,  // a cutting move that was compared
};

struct PageVertex {
  geometry::Point3 place = geometry::Point3::Zero();     // mm, on the old path
  geometry::Vector3 offset = geometry::Vector3::Zero();  // mm, from there to the new path
  PageStep step = PageStep::kNone;
  std::uint32_t old_line = 0;
  std::uint32_t new_line = 0;   // 0: not known
  std::int32_t run = -1;        // index into SmoothResult::runs; -1: in none
  double feed = 0;              // mm/min, programmed; 0: none known, or a rapid
  double curvature_before = 0;  // 1/mm: of an arc, or of the circle through three neighbouring
  double curvature_after = 0;   // ends of lines, and between ends in proportion
  double speed_before = 0;      // mm/min, predicted; 0 on rapids and where nothing is predicted
  double speed_after = 0;
};

struct PagePath {
  std::vector<PageVertex> vertices;
  double drawn_within = 0;  // mm: vertices were left out where the rest says it so well
  std::size_t stretches = 0;
  std::size_t pairs = 0;                // of all certificates
  std::size_t stretches_not_shown = 0;  // their matching could not be made again
};

// mm/min, predicted: of a motion of the program (an index into Interpretation::motions), at a share
// of its length from 0 to 1.
using SpeedAlong = std::function<double(std::uint32_t motion, double share)>;

struct PagePathOptions {
  double tolerance_mm = 0.01;
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  // More vertices than this are thinned further: a page must open fast.
  std::size_t most_vertices = 400000;
  SpeedAlong speed_before = {};  // may be empty: nothing is predicted
  SpeedAlong speed_after = {};
};

// `verification` is that of the same two programs. Motions whose place is not known are left out.
[[nodiscard]] PagePath page_path(const ReadProgram& before, const ReadProgram& after,
                                 const Verification& verification, std::span<const RunReport> runs,
                                 const PagePathOptions& options);

// --- fewer vertices that say the same --------------------------------------------------------

struct Thinning {
  double error = 0.0001;     // mm, of places and of offsets
  double speed_error = 1.0;  // mm/min
};

// Leaves out vertices that lie between two that stay, on the straight way from the one to the
// other, within these errors: place, offset and both speeds. Ends of chains, and vertices where the
// kind of move, the run or the feed changes, stay. Linear cost.
[[nodiscard]] std::vector<PageVertex> thinned(const std::vector<PageVertex>& vertices,
                                              const Thinning& thinning);

// Columns of whole numbers as short text, for a page that reads them with a few lines of script.

// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

// Each number as zigzag (0, -1, 1, -2 .. become 0, 1, 2, 3 ..) in groups of seven bits, the lowest
// first; all but the last group of a number have the top bit set. Then base64.
[[nodiscard]] std::string packed(const std::vector<std::int64_t>& numbers);

// The differences between neighbours, the first one from 0; packed.
[[nodiscard]] std::string packed_steps(const std::vector<std::int64_t>& numbers);

// Value, count, value, count ..; packed.
[[nodiscard]] std::string packed_runs(const std::vector<std::int64_t>& numbers);

// The same of the differences: for numbers that mostly go on by the same step.
[[nodiscard]] std::string packed_step_runs(const std::vector<std::int64_t>& numbers);

}  // namespace batten::postproc
