#include "gcode/siemens/name_kinds.h"

#include <algorithm>
#include <iterator>

#include "gcode/siemens/lexer.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

struct NameRow {
  std::string_view name;
  NameKind kind;
};

// Not in it are words that are not known: they end the run, and nothing is known after them.
constexpr NameRow kNames[] = {
    {"SOFT", NameKind::kNothing},
    {"BRISK", NameKind::kNothing},
    {"DRIVE", NameKind::kNothing},
    {"FFWON", NameKind::kNothing},
    {"FFWOF", NameKind::kNothing},
    {"STOPRE", NameKind::kNothing},
    {"MSG", NameKind::kNothing},
    {"CYCLE832", NameKind::kTolerance},
    {"CTOL", NameKind::kTolerance},
    {"OTOL", NameKind::kTolerance},
    {"ATOL", NameKind::kTolerance},
    {"ADIS", NameKind::kNothing},
    {"ADISPOS", NameKind::kNothing},
    {"NORM", NameKind::kNothing},
    {"KONT", NameKind::kNothing},
    {"CUT2D", NameKind::kNothing},
    {"CUT2DF", NameKind::kNothing},
    {"CFC", NameKind::kNothing},
    {"CFIN", NameKind::kNothing},
    {"CFTCP", NameKind::kNothing},
    {"G450", NameKind::kNothing},
    {"G451", NameKind::kNothing},
    {"G601", NameKind::kNothing},
    {"G602", NameKind::kNothing},
    {"G603", NameKind::kNothing},
    {"BRISKA", NameKind::kNothing},
    {"SOFTA", NameKind::kNothing},
    {"DRIVEA", NameKind::kNothing},
    {"JERKA", NameKind::kNothing},
    {"CPRECON", NameKind::kNothing},
    {"CPRECOF", NameKind::kNothing},
    {"DYNNORM", NameKind::kNothing},
    {"DYNPOS", NameKind::kNothing},
    {"DYNROUGH", NameKind::kNothing},
    {"DYNSEMIFIN", NameKind::kNothing},
    {"DYNFINISH", NameKind::kNothing},
    {"DYNPREC", NameKind::kNothing},
    {"FNORM", NameKind::kNothing},
    {"FIFOCTRL", NameKind::kNothing},
    {"STARTFIFO", NameKind::kNothing},
    {"STOPFIFO", NameKind::kNothing},
    {"LIMS", NameKind::kNothing},
    {"ACC", NameKind::kNothing},
    {"ACCLIMA", NameKind::kNothing},
    {"VELOLIM", NameKind::kNothing},
    {"VELOLIMA", NameKind::kNothing},
    {"JERKLIM", NameKind::kNothing},
    {"JERKLIMA", NameKind::kNothing},
    {"SBLON", NameKind::kNothing},
    {"SBLOF", NameKind::kNothing},
    {"DISPLON", NameKind::kNothing},
    {"DISPLOF", NameKind::kNothing},
    {"SPLINEPATH", NameKind::kNothing},
    {"ORIWKS", NameKind::kNothing},
    {"ORIMKS", NameKind::kNothing},
    {"ORIAXES", NameKind::kNothing},
    {"ORIVECT", NameKind::kNothing},
    {"ORIEULER", NameKind::kNothing},
    {"ORIRPY", NameKind::kNothing},
    {"ORIRPY2", NameKind::kNothing},
    {"ORISON", NameKind::kNothing},
    {"ORISOF", NameKind::kNothing},
    {"OSC", NameKind::kNothing},
    {"OSS", NameKind::kNothing},
    {"OSSE", NameKind::kNothing},
    {"OST", NameKind::kNothing},
    {"OSOF", NameKind::kNothing},
    {"SPATH", NameKind::kNothing},
    {"UPATH", NameKind::kNothing},
    {"CDOF", NameKind::kNothing},
    {"CDOF2", NameKind::kNothing},
    {"GROUP_BEGIN", NameKind::kNothing},
    {"GROUP_END", NameKind::kNothing},
    {"G140", NameKind::kNothing},
    {"G141", NameKind::kNothing},
    {"G142", NameKind::kNothing},
    {"G143", NameKind::kNothing},
    {"G340", NameKind::kNothing},
    {"G341", NameKind::kNothing},
    {"G460", NameKind::kNothing},
    {"G461", NameKind::kNothing},
    {"G462", NameKind::kNothing},
    {"WORKPIECE", NameKind::kNothing},
    {"DEF", NameKind::kDeclaration},
    {"EXTERN", NameKind::kDeclaration},
    {"COMPON", NameKind::kRefitOn},
    {"COMPCURV", NameKind::kRefitOn},
    {"COMPCAD", NameKind::kRefitOn},
    {"COMPSURF", NameKind::kRefitOn},
    {"COMPPATH", NameKind::kRefitOn},
    {"COMPOF", NameKind::kRefitOff},
    {"TRAORI", NameKind::kToolCenterOn},
    {"TRAFOOF", NameKind::kTransformationOff},
    {"TRANSMIT", NameKind::kPolarOn},
    {"TRACYL", NameKind::kCylinderOn},
    {"CYCLE800", NameKind::kTilt},
    {"TOROT", NameKind::kTiltOn},
    {"TOFRAME", NameKind::kTiltOn},
    {"PAROT", NameKind::kTiltOn},
    {"TOROTOF", NameKind::kTiltOff},
    {"PAROTOF", NameKind::kTiltOff},
    {"TRANS", NameKind::kOffset},
    {"ATRANS", NameKind::kOffsetOn},
    {"ROT", NameKind::kRotation},
    {"ROTS", NameKind::kRotation},
    {"AROT", NameKind::kRotationOn},
    {"AROTS", NameKind::kRotationOn},
    {"RPL", NameKind::kRotationOn},
    {"SCALE", NameKind::kScaling},
    {"ASCALE", NameKind::kScalingOn},
    {"MIRROR", NameKind::kMirror},
    {"AMIRROR", NameKind::kMirrorOn},
    {"ASPLINE", NameKind::kSpline},
    {"BSPLINE", NameKind::kSpline},
    {"CSPLINE", NameKind::kSpline},
    {"POLY", NameKind::kSpline},
    {"CIP", NameKind::kSpline},
    {"CT", NameKind::kSpline},
    {"INVCW", NameKind::kSpline},
    {"INVCCW", NameKind::kSpline},
    {"PO", NameKind::kBlockPath},
    {"PL", NameKind::kBlockPath},
    {"PW", NameKind::kBlockPath},
    {"SD", NameKind::kBlockPath},
    {"BAUTO", NameKind::kBlockPath},
    {"BNAT", NameKind::kBlockPath},
    {"BTAN", NameKind::kBlockPath},
    {"EAUTO", NameKind::kBlockPath},
    {"ENAT", NameKind::kBlockPath},
    {"ETAN", NameKind::kBlockPath},
    {"RND", NameKind::kBlockPath},
    {"CHF", NameKind::kBlockPath},
    {"CHR", NameKind::kBlockPath},
    {"ANG", NameKind::kBlockPath},
    {"AR", NameKind::kBlockPath},
    {"AP", NameKind::kBlockPath},
    {"RP", NameKind::kBlockPath},
    {"TURN", NameKind::kBlockPath},
    {"FB", NameKind::kBlockPath},
    {"SUPA", NameKind::kBlockPath},
    {"G153", NameKind::kBlockPath},
    {"I1", NameKind::kBlockPath},
    {"J1", NameKind::kBlockPath},
    {"K1", NameKind::kBlockPath},
    {"G641", NameKind::kBlending},
    {"G642", NameKind::kBlending},
    {"G643", NameKind::kBlending},
    {"G644", NameKind::kBlending},
    {"G645", NameKind::kBlending},
    {"G70", NameKind::kInch},
    {"G700", NameKind::kInch},
    {"G71", NameKind::kMillimetre},
    {"G710", NameKind::kMillimetre},
    {"G110", NameKind::kPole},
    {"G111", NameKind::kPole},
    {"G112", NameKind::kPole},
    {"G25", NameKind::kPole},
    {"G26", NameKind::kPole},
    {"G58", NameKind::kOffsetOn},
    {"G59", NameKind::kOffsetOn},
    {"G74", NameKind::kApproach},
    {"G75", NameKind::kApproach},
    {"G500", NameKind::kWorkOffset},
    {"D", NameKind::kTool},
    {"DIAMON", NameKind::kDiameterOn},
    {"DIAM90", NameKind::kDiameterOn},
    {"DIAMCYCOF", NameKind::kDiameterOn},
    {"DIAMOF", NameKind::kDiameterOff},
    {"G331", NameKind::kThread},
    {"G332", NameKind::kThread},
    {"G34", NameKind::kThread},
    {"G35", NameKind::kThread},
    {"G63", NameKind::kThread},
    {"G147", NameKind::kBlockPath},
    {"G148", NameKind::kBlockPath},
    {"G247", NameKind::kBlockPath},
    {"G248", NameKind::kBlockPath},
    {"G347", NameKind::kBlockPath},
    {"G348", NameKind::kBlockPath},
    {"DISR", NameKind::kBlockPath},
    {"DISCL", NameKind::kBlockPath},
    {"G961", NameKind::kSurfaceSpeedOn},
    {"G962", NameKind::kSurfaceSpeedOn},
    {"G971", NameKind::kSurfaceSpeedOff},
    {"G972", NameKind::kSurfaceSpeedOff},
    {"G973", NameKind::kSurfaceSpeedOff},
    {"SPOS", NameKind::kSpindle},
    {"SPOSA", NameKind::kSpindle},
    {"SPCON", NameKind::kSpindle},
    {"SPCOF", NameKind::kSpindle},
    {"SETMS", NameKind::kSpindle},
    {"A2", NameKind::kOtherAxis},
    {"B2", NameKind::kOtherAxis},
    {"C2", NameKind::kOtherAxis},
    {"A3", NameKind::kOtherAxis},
    {"B3", NameKind::kOtherAxis},
    {"C3", NameKind::kOtherAxis},
    {"A4", NameKind::kOtherAxis},
    {"B4", NameKind::kOtherAxis},
    {"C4", NameKind::kOtherAxis},
    {"A5", NameKind::kOtherAxis},
    {"B5", NameKind::kOtherAxis},
    {"C5", NameKind::kOtherAxis},
    {"LEAD", NameKind::kOtherAxis},
    {"TILT", NameKind::kOtherAxis},
    {"THETA", NameKind::kOtherAxis},
    {"MCALL", NameKind::kModalCall},
    {"CYCLE60", NameKind::kCycle},
    {"CYCLE61", NameKind::kCycle},
    {"CYCLE62", NameKind::kCycle},
    {"CYCLE63", NameKind::kCycle},
    {"CYCLE64", NameKind::kCycle},
    {"CYCLE70", NameKind::kCycle},
    {"CYCLE71", NameKind::kCycle},
    {"CYCLE72", NameKind::kCycle},
    {"CYCLE73", NameKind::kCycle},
    {"CYCLE74", NameKind::kCycle},
    {"CYCLE75", NameKind::kCycle},
    {"CYCLE76", NameKind::kCycle},
    {"CYCLE77", NameKind::kCycle},
    {"CYCLE78", NameKind::kCycle},
    {"CYCLE79", NameKind::kCycle},
    {"CYCLE81", NameKind::kCycle},
    {"CYCLE82", NameKind::kCycle},
    {"CYCLE83", NameKind::kCycle},
    {"CYCLE84", NameKind::kCycle},
    {"CYCLE85", NameKind::kCycle},
    {"CYCLE86", NameKind::kCycle},
    {"CYCLE87", NameKind::kCycle},
    {"CYCLE88", NameKind::kCycle},
    {"CYCLE89", NameKind::kCycle},
    {"CYCLE90", NameKind::kCycle},
    {"CYCLE801", NameKind::kCycle},
    {"CYCLE802", NameKind::kCycle},
    {"CYCLE840", NameKind::kCycle},
    {"CYCLE899", NameKind::kCycle},
    {"HOLES1", NameKind::kCycle},
    {"HOLES2", NameKind::kCycle},
    {"SLOT1", NameKind::kCycle},
    {"SLOT2", NameKind::kCycle},
    {"LONGHOLE", NameKind::kCycle},
    {"POCKET1", NameKind::kCycle},
    {"POCKET2", NameKind::kCycle},
    {"POCKET3", NameKind::kCycle},
    {"POCKET4", NameKind::kCycle},
};

// R5, S2, M1, as addresses with digits.
bool is_address(std::string_view name, char letter) {
  return name.size() > 1 && name[0] == letter &&
         std::ranges::all_of(name.substr(1), [](char c) { return is_digit(c); });
}

// X1=10: an axis of the machine, or one of several.
bool is_numbered_axis(std::string_view name) {
  constexpr std::string_view kNamedAxes = "XYZABCUVWQ";
  return kNamedAxes.find(name.front()) != std::string_view::npos && is_address(name, name.front());
}

}  // namespace

std::optional<NameKind> kind_of_siemens_name(std::string_view name, bool assigned) {
  const auto* row = std::ranges::find(kNames, name, &NameRow::name);
  if (row != std::end(kNames)) return row->kind;
  // G505 to G599: more work offsets.
  if (name.size() == 4 && name.starts_with("G5") && is_digit(name[2]) && is_digit(name[3]) &&
      name.substr(2) >= "05") {
    return NameKind::kWorkOffset;
  }
  const bool is_parameter = name == "R" || is_address(name, 'R');  // R[5]=, R5=
  if (assigned && is_parameter) return NameKind::kVariable;
  if (assigned && (is_address(name, 'S') || is_address(name, 'M'))) return NameKind::kSpindle;
  if (assigned && is_address(name, 'T')) return NameKind::kTool;
  if (assigned && is_numbered_axis(name)) return NameKind::kOtherAxis;
  return std::nullopt;
}

namespace {

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
      name.clear();
      for (std::size_t i = at; i < end; ++i) name.push_back(upper(declaration[i]));
      at = end;
      continue;
    }
    at = after_part(declaration, at);
  }
  if (!in_value) end_of_name();
}

}  // namespace batten::gcode
