#include "postproc/options/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "gcode/controls/built_in.h"
#include "gcode/state/reason.h"
#include "geometry/fitting/fair/fair.h"

namespace batten::postproc {

namespace {

// A tolerance above this (mm) is a slip of units: somebody meant micrometres.
constexpr double kGreatestTolerance = 10;

// More threads than this are a slip; no machine that runs a CAM has them.
constexpr int kMostThreads = 1024;

// path_distance.h: the proved bound is tight to within this part of the tolerance.
constexpr double kProofLooseness = 0.02;

// Part of the tolerance without rounding that arcs or chords may use; see options.h.
constexpr double kFormPart = 1.0 / 3;

constexpr Choice<Form> kForms[] = {
    {Form::kAuto, "auto", "curves that the target surely reads, arcs or lines, as --prefer says"},
    {Form::kCurves, "curves", "the target's own curves; arcs or lines for runs that are none"},
    {Form::kArcs, "arcs", "G02/G03 where a run lies in a plane of the target"},
    {Form::kLines, "lines", "G01 along the smoothed curve"},
};

constexpr Choice<Method> kMethods[] = {
    {Method::kBest, "best", "every method; the result that serves --prefer is taken"},
    {Method::kFair, "fair", "the path that was meant, as smooth as the machine needs it"},
    {Method::kTimeOptimal, "racing",
     "lines, and at each corner the fastest curve on the machine; slow to compute"},
    {Method::kTube, "tube", "of a few smooth curves in the tolerance the fastest on the machine"},
    {Method::kNaseath, "naseath",
     "a spline's control points moved inside a tube (Naseath 2007), repaired"},
    {Method::kGuo, "guo",
     "lines with a five-point curve at each vertex (Guo 2023), legs shared fairly"},
    {Method::kOzcan, "ozcan",
     "lines with an eight-point curve at each vertex (Ozcan 2018); slow to compute"},
    {Method::kNaseathLiteral, "naseath-literal",
     "as the thesis has it, for comparison: may make a path worse", false},
    {Method::kGuoLiteral, "guo-literal",
     "as the paper has it, for comparison: half the tolerance or less is used", false},
    {Method::kOzcanUsual, "ozcan-usual", "as the paper's corner without its search, for comparison",
     false},
    {Method::kNone, "none", "nothing is rewritten: checks and reports only"},
};

constexpr Choice<Prefer> kPreferences[] = {
    {Prefer::kTime, "time", "the least cutting time on the machine"},
    {Prefer::kAccuracy, "accuracy", "nearest to the path that was meant"},
    {Prefer::kSize, "size", "the fewest bytes inside the tolerance"},
};

using geometry::ToleranceKind;
constexpr Choice<ToleranceKind> kToleranceKinds[] = {
    {ToleranceKind::kPath, "path", "both ways and in order, corners too"},
    {ToleranceKind::kBand, "band", "new path to old one in order; corners may be further off"},
};

using geometry::Side;
constexpr Choice<Side> kSides[] = {
    {Side::kBoth, "both", "the new path may be on either side of the old one"},
    {Side::kLeft, "left", "only on the left of the way of travel, seen from above"},
    {Side::kRight, "right", "only on the right of the way of travel, seen from above"},
};

using geometry::Seam;
constexpr Choice<Seam> kSeams[] = {
    {Seam::kCorner, "corner", "a corner in which a closed path begins stays"},
    {Seam::kSmooth, "smooth", "it is rounded as others are, through the point where it begins"},
};

using gcode::SourceKind;
constexpr Choice<SourceKind> kSources[] = {
    {SourceKind::kAuto, "auto", "what the program's marks say; without any, as the target reads"},
    {SourceKind::kNgc, "ngc", "LinuxCNC and the RS274/NGC standard"},
    {SourceKind::kFanuc, "fanuc", "FANUC and controls like it, with macro B"},
    {SourceKind::kHaas, "haas", "Haas, with macro B"},
    {SourceKind::kGrbl, "grbl", "grbl and its kin"},
    {SourceKind::kSiemens, "siemens", "Siemens Sinumerik"},
    {SourceKind::kHeidenhain, "heidenhain", "Heidenhain Klartext"},
};

constexpr Choice<Linearize> kLinearizations[] = {
    {Linearize::kMinLink, "minlink", "the fewest lines: ends anywhere inside the tolerance"},
    {Linearize::kChord, "chord", "few chords with ends on the curve"},
    {Linearize::kIlca, "ilca", "equal steps of the parameter (Hamdan 2005)"},
    {Linearize::kBlca, "blca", "steps until the tangent is left (Hamdan 2005)"},
};

template <typename Value>
std::string_view name_in(std::span<const Choice<Value>> choices, Value value) {
  const auto found = std::ranges::find(choices, value, &Choice<Value>::value);
  return found != choices.end() ? found->name : "unknown";
}

// See ToleranceShares, 2.
double rounding_of(const SmoothOptions& options, gcode::Units units, int run_decimals) {
  gcode::NumberFormat places = place_format(*options.target, units);
  places.decimals = std::max(places.decimals, run_decimals);
  const double place = std::numbers::sqrt3 / 2 * gcode::printed_step(places, units);
  if (!may_have_arcs(options.output) && !options.quick) return place;
  const double offset = gcode::printed_step(center_format(*options.target, units), units);
  return place + std::numbers::sqrt2 / 2 * offset;
}

bool takes_any_arcs(const gcode::Control& target) {
  return takes_arcs_in(target, gcode::Plane::kXY) || takes_arcs_in(target, gcode::Plane::kZX) ||
         takes_arcs_in(target, gcode::Plane::kYZ);
}

// Why the target cannot have this form; empty where it can.
std::string_view why_not(Form form, const gcode::Control& target) {
  switch (form) {
    case Form::kArcs:
      return takes_any_arcs(target) ? "" : "takes no arcs";
    case Form::kCurves:
      return target.curves != nullptr ? "" : "reads no curves";
    case Form::kAuto:
    case Form::kLines:
      break;
  }
  return {};
}

void check_form(const SmoothOptions& options, std::vector<std::string>& problems) {
  if (options.target == nullptr) return;
  const std::string_view why = why_not(options.output, *options.target);
  if (why.empty()) return;
  std::vector<std::string_view> possible;
  for (const auto& form : kForms) {
    if (why_not(form.value, *options.target).empty()) possible.push_back(form.name);
  }
  problems.push_back(fmt::format("--output: target {} {}; possible: {}", options.target->name, why,
                                 fmt::join(possible, ", ")));
}

void check_tolerance(const SmoothOptions& options, std::vector<std::string>& problems) {
  const double tolerance = options.tolerance_mm;
  if (!std::isfinite(tolerance) || tolerance <= 0) {
    problems.push_back(
        fmt::format("--tolerance: {:g} mm, expected a length above 0, such as 0.01", tolerance));
    return;
  }
  if (tolerance > kGreatestTolerance) {
    problems.push_back(
        fmt::format("--tolerance: {:g} mm, expected {:g} mm or less (micrometres are written as "
                    "0.010)",
                    tolerance, kGreatestTolerance));
    return;
  }
  if (options.target == nullptr) return;
  // Units that only the program will tell: millimetres, the finer ones, are the least demand.
  const ToleranceShares shares = share_tolerance(options, options.units);
  if (shares.smoothing <= 0) {
    problems.push_back(
        fmt::format("--tolerance: {:g} mm, expected more than the {:.5f} mm that the decimals of "
                    "target {} lose by rounding",
                    tolerance, shares.rounding, options.target->name));
  }
}

constexpr Choice<LogLevel> kLevels[] = {
    {LogLevel::kError, "error", "what ends or stops the work"},
    {LogLevel::kWarning, "warning", "and what is doubtful in a program"},
    {LogLevel::kInfo, "info", "and notes, the summary, progress"},
};

constexpr std::string_view kImplied = "implied";

// By their decimals.
constexpr std::array<std::string_view, gcode::kMostIncrementDecimals + 1> kSteps = {
    "1", "0.1", "0.01", "0.001", "0.0001", "0.00001"};

}  // namespace

std::span<const Choice<Form>> forms() { return kForms; }
std::span<const Choice<Method>> methods() { return kMethods; }
std::span<const Choice<Prefer>> preferences() { return kPreferences; }
std::span<const Choice<Linearize>> linearizations() { return kLinearizations; }
std::span<const Choice<ToleranceKind>> tolerance_kinds() { return kToleranceKinds; }
std::span<const Choice<Side>> sides() { return kSides; }
std::span<const Choice<Seam>> seams() { return kSeams; }
std::span<const Choice<SourceKind>> sources() { return kSources; }

bool may_round_seams(Method method) {
  return method != Method::kGuoLiteral && method != Method::kNone;
}

bool is_of_corners(Method method) {
  return method == Method::kGuo || method == Method::kGuoLiteral || method == Method::kOzcan ||
         method == Method::kOzcanUsual || method == Method::kTimeOptimal;
}

bool may_have_arcs(Form form) {
  switch (form) {
    case Form::kAuto:
    case Form::kArcs:
    case Form::kCurves:
      return true;
    case Form::kLines:
      break;
  }
  return false;
}

std::string_view name_of(Form form) { return name_in(forms(), form); }
std::string_view name_of(Method method) { return name_in(methods(), method); }
std::string_view name_of(Prefer prefer) { return name_in(preferences(), prefer); }
std::string_view name_of(Linearize linearize) { return name_in(linearizations(), linearize); }

std::string_view name_of(ToleranceKind kind) { return name_in(tolerance_kinds(), kind); }
std::string_view name_of(Side side) { return name_in(sides(), side); }
std::string_view name_of(Seam seam) { return name_in(seams(), seam); }

std::string_view name_of(gcode::Units units) {
  if (units == gcode::Units::kUnknown) return "unknown";
  return units == gcode::Units::kInch ? "inch" : "mm";
}

bool calls_keep_modes(std::span<const std::string> allowed) {
  return std::ranges::find(allowed, gcode::reason::kSubprogram) != allowed.end();
}

gcode::ModeSet asked_modes(std::span<const std::string> allowed) {
  const bool lifts = std::ranges::find(allowed, gcode::reason::kControlSmoothing) != allowed.end();
  return lifts ? gcode::mode::kAll - gcode::mode::kControlSmoothing : gcode::mode::kAll;
}

bool usual_caller_modes(std::span<const std::string> allowed) {
  return std::ranges::find(allowed, gcode::reason::kCallerModes) != allowed.end();
}

namespace {

// A target without curves gets those of a program that the user says was written for a control of
// the same language that has some: it cannot run them, so that they can mean nothing else there.
const gcode::CurveFormat* curves_read(const gcode::Control& target, gcode::SourceKind source) {
  if (target.curves != nullptr) return target.curves;
  const gcode::Control* written_for = gcode::find_control(gcode::control_of(source));
  const bool understood = written_for != nullptr && written_for->language == target.language;
  return understood ? written_for->curves : nullptr;
}

// What the user says of a word goes first.
std::shared_ptr<const gcode::OwnWords> with_words_of(const gcode::Control& target,
                                                     std::shared_ptr<const gcode::OwnWords> said) {
  if (target.own_words.empty()) return said;
  std::vector<gcode::OwnWord> words;
  if (said != nullptr) words.assign(said->all().begin(), said->all().end());
  for (const auto& [name, effect] : target.own_words) {
    const auto row = std::ranges::find(gcode::own_effects(), effect, &gcode::OwnEffectRow::name);
    words.push_back({std::string(name), std::string(effect), row->effect});
  }
  return std::make_shared<const gcode::OwnWords>(std::move(words));
}

}  // namespace

void read_as(const gcode::Control* target, gcode::SourceKind source, gcode::ReadOptions& reading) {
  if (target == nullptr) return;
  reading.curves = curves_read(*target, source);
  const bool is_auto = source == gcode::SourceKind::kAuto;
  if (is_auto || gcode::control_of(source) == target->name) {
    reading.lacks = target->lacks;
    reading.own_words = with_words_of(*target, reading.own_words);
  }
  if (!is_auto) return;
  reading.needs_commands = target->needs_commands;
  reading.names_blocks = target->names_blocks;
  reading.centers_follow_distance = target->centers_follow_distance;
}

gcode::ReadOptions read_options_of(const SmoothOptions& options) {
  gcode::ReadOptions reading;
  reading.units = options.units;
  reading.calls_keep_modes = calls_keep_modes(options.allowed);
  reading.asked = asked_modes(options.allowed);
  reading.usual_caller_modes = usual_caller_modes(options.allowed);
  reading.stated_tolerances = !options.one_tolerance;
  reading.own_words = options.own_words;
  reading.subprograms = options.subprograms;
  if (options.convert) {
    if (options.target != nullptr) reading.curves = options.target->curves;
  } else {
    read_as(options.target, options.source, reading);
  }
  return reading;
}

std::vector<std::string> problems_of_allowed(std::span<const std::string> ids) {
  std::vector<std::string> problems;
  const auto all = gcode::reason::explanations();
  std::vector<std::string_view> liftable;
  for (const auto& each : all) {
    if (each.can_be_allowed) liftable.push_back(each.id);
  }
  const std::string possible = fmt::format("{}", fmt::join(liftable, ", "));
  for (const std::string& id : ids) {
    const auto found = std::ranges::find(all, id, &gcode::reason::Explanation::id);
    if (found == all.end()) {
      problems.push_back(
          fmt::format("--allow: there is no reason '{}'; possible: {}", id, possible));
    } else if (!found->can_be_allowed) {
      problems.push_back(
          fmt::format("--allow: '{}' cannot be lifted, since rewriting would not be safe there; "
                      "possible: {}",
                      id, possible));
    }
  }
  return problems;
}

std::vector<std::string> problems_of_side(geometry::Side side, geometry::ToleranceKind kind) {
  if (side == geometry::Side::kBoth || kind == geometry::ToleranceKind::kPath) return {};
  return {"--side: left and right need --tolerance-kind path"};
}

Linearize linearize_of(const SmoothOptions& options) {
  if (options.linearize) return *options.linearize;
  const bool few = options.prefer == Prefer::kSize && !options.quick;
  return few ? Linearize::kMinLink : Linearize::kChord;
}

bool wants_few_moves(const SmoothOptions& options) {
  if (options.prefer == Prefer::kAccuracy || options.quick) return false;
  return options.output == Form::kArcs || options.prefer == Prefer::kSize;
}

double keep_corner_angle_of(const SmoothOptions& options) {
  if (!options.keep_corners_deg) return geometry::FairOptions{}.keep_corner_angle;
  return *options.keep_corners_deg * std::numbers::pi / 180;
}

std::vector<std::string> problems_of(const SmoothOptions& options) {
  std::vector<std::string> problems;
  if (options.target == nullptr) {
    problems.emplace_back("--target: no target given; `batten targets` lists them");
  }
  if (options.machine == nullptr) {
    problems.emplace_back("--machine: no machine given; `batten machines` lists them");
  }
  check_tolerance(options, problems);
  check_form(options, problems);
  if (options.keep_corners_deg &&
      !(*options.keep_corners_deg > 0 && *options.keep_corners_deg <= 180)) {
    problems.push_back(
        fmt::format("--keep-corners: {:g} degrees, expected more than 0 and at most 180",
                    *options.keep_corners_deg));
  }
  std::ranges::move(problems_of_side(options.side, options.tolerance_kind),
                    std::back_inserter(problems));
  if (options.seam == Seam::kSmooth && options.side != Side::kBoth) {
    problems.emplace_back("--seam: smooth goes to both sides of the path, expected --side both");
  }
  if (options.seam == Seam::kSmooth && !may_round_seams(options.method)) {
    problems.push_back(
        fmt::format("--seam: --method {} rounds no seam, expected corner or another method",
                    name_of(options.method)));
  }
  std::ranges::move(problems_of_decimals(options.decimals, options.source, options.target),
                    std::back_inserter(problems));
  std::ranges::move(problems_of_allowed(options.allowed), std::back_inserter(problems));
  if (options.threads < 0 || options.threads > kMostThreads) {
    problems.push_back(
        fmt::format("--threads: {}, expected 0 (all cores) to {}", options.threads, kMostThreads));
  }
  return problems;
}

ToleranceShares share_tolerance(const SmoothOptions& options, gcode::Units units, int run_decimals,
                                std::optional<double> tolerance_mm) {
  ToleranceShares shares;
  const gcode::Units written =
      units == gcode::Units::kInch ? gcode::Units::kInch : gcode::Units::kMillimetre;
  shares.rounding = rounding_of(options, written, run_decimals);
  const double tolerance = tolerance_mm.value_or(options.tolerance_mm);
  const double rest = tolerance * (1 - kProofLooseness) - shares.rounding;
  if (rest > 0) {
    shares.form = kFormPart * rest;
    shares.smoothing = rest - shares.form;
  }
  return shares;
}

std::span<const Choice<LogLevel>> log_levels() { return kLevels; }

std::optional<gcode::Decimals> read_decimals(std::string_view text,
                                             std::vector<std::string>& problems) {
  using gcode::PointlessNumbers;
  if (text == "auto") return std::nullopt;
  if (text == "explicit") return gcode::Decimals{.pointless = PointlessNumbers::kUnits};
  if (text == kImplied) return gcode::Decimals{.pointless = PointlessNumbers::kIncrements};
  for (std::size_t decimals = 0; decimals < kSteps.size(); ++decimals) {
    if (text == fmt::format("{}:{}", kImplied, kSteps.at(decimals))) {
      return gcode::Decimals{.pointless = PointlessNumbers::kIncrements,
                             .increment_decimals = static_cast<int>(decimals)};
    }
  }
  problems.push_back(fmt::format(
      "--decimals: '{}', expected auto, explicit, implied, or implied: and the least increment of "
      "millimetre programs, one of {}",
      text, fmt::join(kSteps, ", ")));
  return std::nullopt;
}

std::string text_of(const std::optional<gcode::Decimals>& declared) {
  if (!declared) return "auto";
  if (declared->pointless == gcode::PointlessNumbers::kUnits) return "explicit";
  if (declared->increment_decimals == gcode::Decimals{}.increment_decimals)
    return std::string(kImplied);
  return fmt::format("{}:{}", kImplied,
                     kSteps.at(static_cast<std::size_t>(declared->increment_decimals)));
}

std::vector<std::string> problems_of_decimals(const std::optional<gcode::Decimals>& declared,
                                              gcode::SourceKind source,
                                              const gcode::Control* target) {
  if (!declared || declared->pointless != gcode::PointlessNumbers::kIncrements) return {};
  const std::string_view why = gcode::why_not_implied(source, target);
  if (why.empty()) return {};
  return {fmt::format("--decimals: {}: {}", text_of(declared), why)};
}

}  // namespace batten::postproc
