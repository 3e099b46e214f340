#include "postproc/profile/profile_keys.h"

namespace batten::postproc {
namespace {

using gcode::ArcForm;
using gcode::CommentStyle;
using gcode::Control;

// What can be printed, and a block of the longest line that any control takes.
constexpr int kMostDecimals = 9;
constexpr std::size_t kLongestLine = 100000;

// Blocks of an arc need this much.
constexpr std::size_t kShortestLine = 40;

constexpr std::array<std::string_view, 3> kCommentNames = {"none", "parentheses", "semicolon"};
constexpr std::array<std::string_view, 2> kArcForms = {"centres", "radius"};

constexpr WholeNumberKey decimals(int& (*place)(Control&)) { return {place, 0, kMostDecimals}; }

constexpr std::array kKeys = {
    ProfileKey{"", "name", "what reports call it",
               TextKey{[](Control& t) -> std::string& { return t.name; }}},
    ProfileKey{"", "description", "one line",
               TextKey{[](Control& t) -> std::string& { return t.description; }}},
    ProfileKey{"", "machine", "a built-in machine whose time counts when none is given",
               TextKey{[](Control& t) -> std::string& { return t.machine; }}},

    ProfileKey{"numbers", "places-mm", "decimals of X Y Z along lines, millimetre programs",
               decimals([](Control& t) -> int& { return t.places.mm; })},
    ProfileKey{"numbers", "places-inch", "the same, inch programs",
               decimals([](Control& t) -> int& { return t.places.inch; })},
    ProfileKey{"numbers", "arc-ends-mm", "decimals of X Y Z in runs with arcs",
               decimals([](Control& t) -> int& { return t.arc_ends.mm; })},
    ProfileKey{"numbers", "arc-ends-inch", "the same, inch programs",
               decimals([](Control& t) -> int& { return t.arc_ends.inch; })},
    ProfileKey{"numbers", "centres-mm", "decimals of I J K R",
               decimals([](Control& t) -> int& { return t.centers.mm; })},
    ProfileKey{"numbers", "centres-inch", "the same, inch programs",
               decimals([](Control& t) -> int& { return t.centers.inch; })},
    ProfileKey{"numbers", "feeds", "most decimals of F, which is copied",
               decimals([](Control& t) -> int& { return t.feed_decimals; })},
    ProfileKey{"numbers", "decimal-point", "X5. rather than X5",
               FlagKey{[](Control& t) -> bool& { return t.decimal_point; }}},
    ProfileKey{"numbers", "trailing-zeros", "X1.500 rather than X1.5",
               FlagKey{[](Control& t) -> bool& { return t.trailing_zeros; }}},

    ProfileKey{"lines", "max-length", "characters; a run that needs more is kept",
               LengthKey{[](Control& t) -> std::size_t& { return t.max_line_length; },
                         kShortestLine, kLongestLine}},
    ProfileKey{"lines", "blanks", "between words",
               FlagKey{[](Control& t) -> bool& { return t.blanks; }}},
    ProfileKey{
        "lines", "comments", "none, parentheses or semicolon",
        NameKey{kCommentNames,
                [](const Control& t) { return static_cast<std::size_t>(t.comments); },
                [](Control& t, std::size_t i) { t.comments = static_cast<CommentStyle>(i); }}},
    ProfileKey{"lines", "repeat-words", "G1 in every block, X and Y in every arc",
               FlagKey{[](Control& t) -> bool& { return t.repeats_words; }}},

    ProfileKey{"arcs", "planes", "where arcs are taken; [] for none",
               PlanesKey{[](Control& t) -> std::array<bool, 3>& { return t.planes; }}},
    ProfileKey{"arcs", "helices", "arcs that rise",
               FlagKey{[](Control& t) -> bool& { return t.helices; }}},
    ProfileKey{
        "arcs", "words", "centres (I J K from the start) or radius (R)",
        NameKey{kArcForms, [](const Control& t) { return static_cast<std::size_t>(t.arc_form); },
                [](Control& t, std::size_t i) { t.arc_form = static_cast<ArcForm>(i); }}},
    ProfileKey{"arcs", "absolute-centres", "G90.1 and G91.1 are known",
               FlagKey{[](Control& t) -> bool& { return t.arc_distance_mode; }}},
    ProfileKey{"arcs", "max-sweep", "degrees; longer arcs are written as several",
               DecimalKey{[](Control& t) -> double& { return t.max_sweep_deg; }, 1, 360}},
    ProfileKey{"arcs", "single-quadrants", "arcs end at the axes",
               FlagKey{[](Control& t) -> bool& { return t.single_quadrants; }}},
    ProfileKey{"arcs", "min-radius", "mm; tighter arcs become lines",
               DecimalKey{[](Control& t) -> double& { return t.min_radius; }, 0.001, 1e6}},
    ProfileKey{"arcs", "max-radius", "mm; flatter arcs become lines",
               DecimalKey{[](Control& t) -> double& { return t.max_radius; }, 0.001, 1e6}},
    ProfileKey{"arcs", "chord-error", "mm by which the control's own chords leave an arc; 0: none",
               DecimalKey{[](Control& t) -> double& { return t.chords.error; }, 0, 10}},
    ProfileKey{"arcs", "chord-length", "mm, of the control's own chords; 0: not by length",
               DecimalKey{[](Control& t) -> double& { return t.chords.longest; }, 0, 100}},
    ProfileKey{"arcs", "least-chord-length", "mm, where there are so many chords in a circle:",
               DecimalKey{[](Control& t) -> double& { return t.chords.shortest; }, 0, 100}},
    ProfileKey{"arcs", "chords-per-circle", "0: chord-length alone counts",
               DecimalKey{[](Control& t) -> double& { return t.chords.per_circle; }, 0, 1e5}},
};

}  // namespace

std::span<const ProfileKey> profile_keys() { return kKeys; }

}  // namespace batten::postproc
