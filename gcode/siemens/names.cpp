#include "gcode/siemens/names.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>

#include "gcode/siemens/block.h"
#include "gcode/siemens/lexer.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace siemens_names {

enum class Place : std::uint8_t { kStays, kLost };
enum class Axes : std::uint8_t {
  kMove,
  kTaken,     // the axis words are no motion
  kSetFrame,  // and where there are none, all frames are taken back
};
// What more a name does than its row says.
enum class NameAct : std::uint8_t {
  kNoMore,
  kDeclares,  // the rest of the line declares something
  kEndsTransformation,
  kTilts,        // with arguments; without it ends that
  kOtherMotion,  // splines, circles through points, threads
  kBlends,
  kInches,
  kMillimetres,
  kWorkOffset,
  kSpindle,
  kEndsDiameter,
  kCycle,      // drills, mills ..; afterwards the modes are as before, the place is not known
  kModalCall,  // with a call beside it: a cycle at every place that follows; alone: no more
  kEndsSurfaceSpeed,
};
using enum Place;
using enum Axes;
using enum NameAct;
using Modal = ModalState;

// In the order in which rows are read.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct NameRow {
  std::string_view names;  // with a blank on each side
  std::string_view why;    // the reason why they end a run
  Place place = kStays;    // of the tool
  TriState Modal::*item = nullptr;
  TriState value = TriState::kOn;
  Axes axes = kMove;
  NameAct act = kNoMore;
};
constexpr auto kOff = TriState::kOff;
constexpr auto kOn = TriState::kOn;

// Not in it are words that are not known: they end the run, and nothing is known after them.
constexpr NameRow kNames[] = {
    {" SOFT BRISK DRIVE FFWON FFWOF STOPRE MSG ADIS ADISPOS NORM KONT CUT2D CUT2DF "
     "CFC CFIN CFTCP G450 G451 G601 G602 G603 BRISKA SOFTA DRIVEA JERKA CPRECON "
     "CPRECOF DYNNORM DYNPOS DYNROUGH DYNSEMIFIN DYNFINISH DYNPREC FNORM FIFOCTRL "
     "STARTFIFO STOPFIFO LIMS ACC ACCLIMA VELOLIM VELOLIMA JERKLIM JERKLIMA SBLON "
     "SBLOF DISPLON DISPLOF SPLINEPATH ORIWKS ORIMKS ORIAXES ORIVECT ORIEULER ORIRPY "
     "ORIRPY2 ORISON ORISOF OSC OSS OSSE OST OSOF SPATH UPATH CDOF CDOF2 GROUP_BEGIN "
     "GROUP_END G140 G141 G142 G143 G340 G341 G460 G461 G462 WORKPIECE ",
     reason::kStateChange},
    {.names = " DEF EXTERN ", .why = reason::kStateChange, .act = kDeclares},
    {" CYCLE832 CTOL OTOL ATOL ", reason::kControlSmoothing},
    {" COMPON COMPCURV COMPCAD COMPSURF COMPPATH ", reason::kControlSmoothing, kStays,
     &Modal::control_smoothing},
    {" COMPOF ", reason::kControlSmoothing, kStays, &Modal::control_smoothing, kOff},
    {" TRAORI ", reason::kToolCenterPoint, kLost, &Modal::tool_center_point},
    {" TRAFOOF ", reason::kToolCenterPoint, kLost, &Modal::tool_center_point, kOff, kMove,
     kEndsTransformation},
    {" TRANSMIT ", reason::kPolar, kLost, &Modal::polar_interpolation},
    {" TRACYL ", reason::kCylindrical, kLost, &Modal::cylindrical},
    {" CYCLE800 ", reason::kTiltedPlane, kLost, &Modal::tilted_plane, kOn, kMove, kTilts},
    {" TOROT TOFRAME PAROT ", reason::kTiltedPlane, kLost, &Modal::tilted_plane},
    {" TOROTOF PAROTOF ", reason::kTiltedPlane, kLost, &Modal::tilted_plane, kOff},
    {.names = " TRANS ", .why = reason::kCoordinateChange, .place = kLost, .axes = kSetFrame},
    {.names = " ATRANS G58 G59 ", .why = reason::kCoordinateChange, .place = kLost, .axes = kTaken},
    {" ROT ROTS ", reason::kRotation, kLost, &Modal::rotation, kOn, kSetFrame},
    {" SCALE ", reason::kScaling, kLost, &Modal::scaling, kOn, kSetFrame},
    {" MIRROR ", reason::kMirror, kLost, &Modal::mirror, kOn, kSetFrame},
    {" AROT AROTS RPL ", reason::kRotation, kLost, &Modal::rotation, kOn, kTaken},
    {" ASCALE ", reason::kScaling, kLost, &Modal::scaling, kOn, kTaken},
    {" AMIRROR ", reason::kMirror, kLost, &Modal::mirror, kOn, kTaken},
    {.names = " ASPLINE BSPLINE CSPLINE POLY CIP CT INVCW INVCCW ",
     .why = reason::kSpline,
     .place = kLost,
     .act = kOtherMotion},
    {" PO PL PW SD BAUTO BNAT BTAN EAUTO ENAT ETAN RND CHF CHR ANG AR AP RP TURN FB "
     "SUPA G153 I1 J1 K1 G147 G148 G247 G248 G347 G348 DISR DISCL ",
     reason::kNotUnderstood, kLost},
    {.names = " G641 G642 G643 G644 G645 ", .why = reason::kStateChange, .act = kBlends},
    {.names = " G70 G700 ", .why = reason::kStateChange, .act = kInches},
    {.names = " G71 G710 ", .why = reason::kStateChange, .act = kMillimetres},
    {.names = " G110 G111 G112 G25 G26 ", .why = reason::kStateChange, .axes = kTaken},
    {.names = " G74 G75 ", .why = reason::kCoordinateChange, .place = kLost, .axes = kTaken},
    {.names = " G500 ", .why = reason::kCoordinateChange, .place = kLost, .act = kWorkOffset},
    {" D ", reason::kToolChange, kLost},
    {.names = " SPOS SPOSA SPCON SPCOF SETMS ", .why = reason::kSpindle, .act = kSpindle},
    {" DIAMON DIAM90 DIAMCYCOF ", reason::kLatheDiameter, kLost, &Modal::lathe_diameter},
    {.names = " DIAMOF ", .why = reason::kStateChange, .act = kEndsDiameter},
    {.names = " CYCLE60 CYCLE61 CYCLE62 CYCLE63 CYCLE64 CYCLE70 CYCLE71 CYCLE72 CYCLE73 "
              "CYCLE74 CYCLE75 CYCLE76 CYCLE77 CYCLE78 CYCLE79 CYCLE81 CYCLE82 CYCLE83 "
              "CYCLE84 CYCLE85 CYCLE86 CYCLE87 CYCLE88 CYCLE89 CYCLE90 CYCLE801 CYCLE802 "
              "CYCLE840 CYCLE899 HOLES1 HOLES2 SLOT1 SLOT2 LONGHOLE POCKET1 POCKET2 POCKET3 "
              "POCKET4 ",
     .why = reason::kCannedCycle,
     .place = kLost,
     .act = kCycle},
    {" MCALL ", reason::kCannedCycle, kStays, &Modal::modal_macro, kOff, kMove, kModalCall},
    {" G961 G962 ", reason::kSpindle, kStays, &Modal::constant_surface_speed},
    {" G971 G972 G973 ", reason::kSpindle, kStays, &Modal::constant_surface_speed, kOff, kMove,
     kEndsSurfaceSpeed},
    {.names = " G331 G332 G34 G35 G63 ",
     .why = reason::kThreading,
     .place = kLost,
     .act = kOtherMotion},
    {" A2 B2 C2 A3 B3 C3 A4 B4 C4 A5 B5 C5 LEAD TILT THETA ", reason::kOtherAxis, kLost},
};

// A value for the program's own computing.
constexpr NameRow kVariable = {"", reason::kAssignment};

const NameRow* row_with(std::string_view name) {
  const std::string word = " " + std::string(name) + " ";
  const auto* row = std::ranges::find_if(
      kNames, [&](const NameRow& each) { return each.names.find(word) != std::string_view::npos; });
  return row == std::end(kNames) ? nullptr : row;
}

// `assigned`: an = stands behind it. nullptr for names that are not known: they could do anything.
const NameRow* row_of(std::string_view name, bool assigned) {
  if (const NameRow* row = row_with(name)) return row;
  // G505 to G599: more work offsets.
  if (name.size() == 4 && name.starts_with("G5") && is_digit(name[2]) && is_digit(name[3]) &&
      name.substr(2) >= "05") {
    return row_with("G500");
  }
  if (!assigned) return nullptr;
  const char letter = name.front();
  if (name == "R") return &kVariable;  // R[5]=
  if (!is_numbered(name)) return nullptr;
  if (letter == 'R') return &kVariable;
  if (letter == 'S' || letter == 'M') return row_with("SPOS");
  if (letter == 'T') return row_with("D");
  // X1=10: an axis of the machine, or one of several.
  const bool axis = std::string_view("XYZABCUVWQ").find(letter) != std::string_view::npos;
  return axis ? row_with("A2") : nullptr;
}

class NameApplier {
 public:
  NameApplier(std::string_view text, const BlockWords& words, SiemensVariables& variables,
              ControlState& state)
      : text_(text), words_(words), variables_(variables), state_(state) {}

  NamedEffect apply() {
    SiemensLexer lexer(text_, {0, static_cast<std::uint32_t>(text_.size())});
    for (;;) {
      const SiemensToken token = lexer.next();
      if (token.kind == SiemensTokenKind::kEnd || token.kind == SiemensTokenKind::kComment) break;
      if (token.kind == SiemensTokenKind::kLabel) block(reason::kProgramFlow);
      const std::string name = siemens_name(text_, token);
      if (name.empty()) continue;
      const bool own = token.assigned && variables_.contains(name);
      const NameRow* row = own ? &kVariable : row_of(name, token.assigned);
      const bool is_code = is_numbered(name) && name[0] == 'G';
      if (const OwnWord* word = row == nullptr && is_code ? own_call(state_, name) : nullptr) {
        effect_.own = word;
        effect_.takes_axes = true;
        block(reason::kOwnWord);
        continue;
      }
      if (row == nullptr) {
        effect_.understood = false;
        block(reason::kForeignWords);
        break;
      }
      if (row->act == NameAct::kDeclares) {
        block(reason::kForeignWords);
        if (name == "DEF") add_declared_names(text_.substr(token.span.end), variables_);
        break;
      }
      calls_modally_ = calls_modally_ || row->act == NameAct::kModalCall;
      apply(*row, token.arguments);
    }
    block(reason::kStateChange);
    return effect_;
  }

 private:
  void block(std::string_view why) {
    if (effect_.barrier.empty()) effect_.barrier = why;
  }

  ModalState& modal() { return state_.modal; }

  void set_units_to(Units units) {
    set_units(state_, units);
    state_.mark_set(CodeGroup::kUnits);
    effect_.unit_word = true;
  }

  void apply(const NameRow& row, bool arguments) {
    block(row.why);
    effect_.loses_place |= row.place == Place::kLost;
    effect_.takes_axes |= row.axes != Axes::kMove;
    if (row.item != nullptr) modal().*row.item = row.value;
    // With axis words a frame is set; without any all programmable frames are taken back.
    if (row.axes == Axes::kSetFrame && !words_.has_any("XYZABCUVW")) {
      modal().rotation = modal().scaling = modal().mirror = TriState::kOff;
    }
    apply_more(row, arguments);
  }

  // What the act of the row is.
  void apply_more(const NameRow& row, bool arguments) {
    switch (row.act) {
      case NameAct::kEndsTransformation:
        modal().polar = TriState::kOff;
        modal().polar_interpolation = TriState::kOff;
        modal().cylindrical = TriState::kOff;
        return;
      case NameAct::kTilts:
        if (!arguments) modal().tilted_plane = TriState::kOff;
        return;
      case NameAct::kOtherMotion:
        modal().motion = MotionMode::kOther;
        state_.other_motion = row.why;
        return;
      case NameAct::kBlends:
        modal().path = PathMode::kBlending;
        return;
      case NameAct::kInches:
        return set_units_to(Units::kInch);
      case NameAct::kMillimetres:
        return set_units_to(Units::kMillimetre);
      case NameAct::kWorkOffset:
        state_.work_offset = 0;
        return;
      case NameAct::kSpindle:
        modal().spindle_speed.reset();
        return;
      case NameAct::kEndsDiameter:
        effect_.loses_place |= modal().lathe_diameter != TriState::kOff;
        modal().lathe_diameter = TriState::kOff;
        return;
      case NameAct::kCycle:
        modal().motion = MotionMode::kUnknown;
        modal().feed.reset();
        modal().spindle_speed.reset();
        if (calls_modally_) modal().modal_macro = TriState::kOn;
        return;
      case NameAct::kEndsSurfaceSpeed:
        // With G971 F is per minute, with G973 what it was.
        modal().feed_mode = FeedMode::kUnknown;
        modal().feed.reset();
        return;
      default:
        return;
    }
  }

  std::string_view text_;
  const BlockWords& words_;
  SiemensVariables& variables_;
  ControlState& state_;
  NamedEffect effect_;
  bool calls_modally_ = false;  // MCALL stands before it in the block
};

}  // namespace siemens_names

bool is_known_siemens_name(std::string_view name) {
  return siemens_names::row_of(name, false) != nullptr;
}

NamedEffect apply_names(std::string_view text, const BlockWords& words, SiemensVariables& variables,
                        ControlState& state) {
  return siemens_names::NameApplier(text, words, variables, state).apply();
}

namespace {

// Of the curves that are written into programs of plain words.
constexpr std::array<std::string_view, 6> kNamesBesidePlainWords = {"POLY",    "PO", "PL",
                                                                    "BSPLINE", "SD", "PW"};

// Of values, no words of a block: the radius of an arc, places in either mode.
constexpr std::array<std::string_view, 3> kValueNames = {"CR", "AC", "IC"};

// Codes of three digits that no other control has for something else.
constexpr std::array<std::string_view, 13> kCodes = {"G500", "G505", "G506", "G507", "G601",
                                                     "G602", "G603", "G641", "G642", "G643",
                                                     "G644", "G645", "G710"};

// The place behind a string, brackets or a value that starts here; the next character otherwise.
std::size_t after_part(std::string_view text, std::size_t at) {
  if (text[at] == '"') {
    const std::size_t end = text.find('"', at + 1);
    return end == std::string_view::npos ? text.size() : end + 1;
  }
  if (text[at] == '[' || text[at] == '(') {
    return after_siemens_brackets(text, at).value_or(text.size());
  }
  return at + 1;
}

}  // namespace

bool has_siemens_name(std::string_view line) {
  for (std::size_t at = 0; at < line.size() && line[at] != ';';) {
    std::size_t end = at;
    while (end < line.size() && is_letter(line[end])) ++end;
    const std::size_t letters = end - at;
    if (letters > 1) {
      while (end < line.size() && is_name_character(line[end])) ++end;
      const std::string name = in_capitals(line.substr(at, end - at));
      const bool plain = std::ranges::count(kNamesBesidePlainWords, name) > 0;
      if (!plain && (std::ranges::count(kValueNames, name) > 0 || is_known_siemens_name(name))) {
        return true;
      }
    } else if (letters == 1) {
      if (in_capitals(line.substr(at, 3)) == "T=\"") return true;  // a tool by its name
      while (end < line.size() && is_digit(line[end])) ++end;
      if (std::ranges::count(kCodes, in_capitals(line.substr(at, end - at))) > 0) return true;
    }
    const std::size_t close = line[at] == '<' ? line.find('>', at) : std::string_view::npos;
    at = letters > 0 ? end : close != std::string_view::npos ? close : after_part(line, at);
  }
  return false;
}

// The name is the last one before a comma, an = or the end: words of the type stand before it.
void add_declared_names(std::string_view declaration, SiemensVariables& variables) {
  std::string name;
  bool in_value = false;
  const auto end_of_name = [&] {
    if (!name.empty()) variables.insert(name);
    name.clear();
  };
  for (std::size_t at = 0; at < declaration.size();) {
    const char c = declaration[at];
    if (c == ';') break;
    if (c == ',') {
      if (!in_value) end_of_name();
      in_value = false;
    } else if (c == '=') {
      end_of_name();
      in_value = true;
    } else if (!in_value && (is_letter(c) || c == '_')) {
      const std::size_t end = after_siemens_name(declaration, at);
      name = in_capitals(declaration.substr(at, end - at));
      at = end;
      continue;
    }
    at = after_part(declaration, at);
  }
  if (!in_value) end_of_name();
}

}  // namespace batten::gcode
