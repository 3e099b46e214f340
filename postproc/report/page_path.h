// The tool path as the page of `batten smooth --report` draws it: the old path from place to place,
// each with the place of the new path that the proof has matched with it.
//
// Made from the two texts alone, by the verifier's own reading and comparison: the deviation along
// the path is the distance of the pairs that are the certificate of the proof
// (geometry/distance/path_distance.h), not a nearest-point distance measured beside it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/verification.h"
#include "postproc/report/page_region.h"

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
  std::int32_t run = -1;        // index of the page's row; -1: in none
  double feed = 0;              // mm/min, programmed; 0: none known, or a rapid
  double curvature_before = 0;  // 1/mm: of an arc, or of the circle through three neighbouring
  double curvature_after = 0;   // ends of lines, and between ends in proportion
  double speed_before = 0;      // mm/min, predicted; 0 on rapids and where nothing is predicted
  double speed_after = 0;
};

// A row of the page's table: the lines of the old program that it is about.
struct PageLines {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
};

struct PagePath {
  std::vector<PageVertex> vertices;
  double drawn_within = 0;  // mm: vertices were left out where the rest says it so well
  std::size_t sections = 0;
  std::size_t pairs = 0;               // of all certificates
  std::size_t sections_not_shown = 0;  // their matching could not be made again
  PageRegion region;                   // of the sections that are shown
};

struct PageTuning {
  double drawn_within = 0.01;   // of the tolerance; half a pixel where it is 60 pixels wide
  double speed_within = 0.005;  // of the greatest speed
  double coarser = 4;           // times, each round of thinning a path that is still too long
  int most_rounds = 12;         // of thinning
  double longest_step = 0.5;    // mm: longer ones are cut, since speed changes within a long line
  std::size_t most_cuts = 200;  // of one move
  std::size_t most_in_a_row = 64;  // vertices left out: each step asks all of them again
};
inline constexpr PageTuning kPageTuning;

struct PagePathOptions {
  double tolerance_mm = 0.01;
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  // More vertices than this are thinned further: a page must open fast.
  std::size_t most_vertices = 300000;
  std::size_t most_region_edges = kMostRegionEdges;
  const Machine* machine = nullptr;  // whose speeds are predicted; nullptr: none are
};

// `verification` is that of the same two programs, empty where both are one program. `rows` by
// their lines, none in another. Motions whose place is not known are left out.
[[nodiscard]] PagePath page_path(const ReadProgram& before, const ReadProgram& after,
                                 const Verification& verification, std::span<const PageLines> rows,
                                 const PagePathOptions& options);

// mm/min, before or after.
[[nodiscard]] double fastest_of(const std::vector<PageVertex>& vertices);

// --- fewer vertices that say the same --------------------------------------------------------

struct Thinning {
  double error = 0.0001;     // mm, of places and of offsets
  double speed_error = 1.0;  // mm/min
};

// Leaves out vertices on the straight way between two that stay, within these errors: place, offset
// and both speeds. Ends of chains, and vertices where the kind of move, the run or the feed
// changes, stay. Linear cost.
[[nodiscard]] std::vector<PageVertex> thinned(const std::vector<PageVertex>& vertices,
                                              const Thinning& thinning);

// --- columns of whole numbers as short text, for a page that reads them with a few lines of script

using Column = std::vector<std::int64_t>;

// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

// Each number as zigzag (0, -1, 1, -2 .. become 0, 1, 2, 3 ..) in groups of seven bits, the lowest
// first; all but the last group of a number have the top bit set. Then base64.
[[nodiscard]] std::string packed(const Column& numbers);

// Value, count, value, count ..; packed.
[[nodiscard]] std::string packed_runs(const Column& numbers);

// The differences between neighbours, the first one from 0.
[[nodiscard]] Column steps_of(const Column& numbers);

// The predicted speed along the cutting moves of one program: every chain of them between two
// events is run from rest to rest, as the model of the machine's control does it. Linear cost.
class ProgramSpeeds {
 public:
  ProgramSpeeds(const ReadProgram& read, const ProgramEvents& events, const Machine& machine);

  // mm/min; `share` of the motion's length, 0 to 1. 0 for motions that are in no chain.
  [[nodiscard]] double at(std::uint32_t motion, double share) const;

 private:
  struct Sample {
    double way = 0;    // mm from the start of the chain, along the programmed path
    double speed = 0;  // mm/s
  };
  struct Place {
    std::size_t chain = 0;
    double way = 0;  // as of a sample
    double length = 0;
  };

  void add_chain(const ReadProgram& read, const Cut* begin, const Cut* end, const Machine& machine);

  std::vector<std::vector<Sample>> chains_;
  std::vector<Place> places_;  // one per motion; no length: in no chain
};

// Curvature along a chain of moves, 1/mm. On an arc its own. At a joint of two lines that of the
// circle through their three ends; between joints in proportion, since a line in itself does not
// bend. Where a line meets an arc, the arc's. 0 at the ends of the chain on lines.
class ChainCurvature {
 public:
  explicit ChainCurvature(std::span<const geometry::PathPiece> chain);

  // `place` lies on the piece.
  [[nodiscard]] double at(std::size_t piece, const geometry::Point3& place) const;

 private:
  std::span<const geometry::PathPiece> chain_;
  std::vector<double> at_joint_;  // one more than pieces
};

// How far along a piece a place on it is, from 0 to 1, by its distances from the ends.
[[nodiscard]] double share_of_piece(const geometry::PathPiece& piece,
                                    const geometry::Point3& place);

}  // namespace batten::postproc
