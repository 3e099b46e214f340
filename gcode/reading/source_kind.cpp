#include "gcode/reading/source_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "gcode/control/dialect.h"
#include "gcode/reading/language_marks.h"
#include "gcode/rs274/plain_beginning.h"

namespace batten::gcode {
namespace {

constexpr SourceMarks kMacroB = mark(SourceMark::kMacroFlow) | mark(SourceMark::kHighSpeedMode);

constexpr std::array kFamilies = {
    SourceFamily{SourceKind::kNgc, "ngc", "LinuxCNC", Language::kRs274,
                 mark(SourceMark::kSubWords) | mark(SourceMark::kNamedParameters) |
                     mark(SourceMark::kBlendTolerance) | mark(SourceMark::kUniformNurbs),
                 false, DwellForm::kSecondsP},
    SourceFamily{SourceKind::kFanuc, "fanuc", "FANUC", Language::kRs274, kMacroB, true,
                 DwellForm::kSecondsXOrMsP},
    SourceFamily{SourceKind::kHaas, "haas", "Haas", Language::kRs274,
                 kMacroB | mark(SourceMark::kHaasSmoothness), true, DwellForm::kSecondsByPoint},
    SourceFamily{SourceKind::kGrbl, "grbl", "grbl", Language::kRs274, mark(SourceMark::kDollarLine),
                 false, DwellForm::kSecondsP},
    SourceFamily{SourceKind::kSiemens, "siemens", "Siemens Sinumerik", Language::kSiemens, 0, false,
                 DwellForm::kSecondsF},
    SourceFamily{SourceKind::kHeidenhain, "heidenhain", "Heidenhain Klartext", Language::kKlartext,
                 0},
};

const SourceFamily* family_of(SourceKind kind) {
  const auto* found = std::ranges::find(kFamilies, kind, &SourceFamily::kind);
  return found == kFamilies.end() ? nullptr : found;
}

std::string_view option_for(Language language) {
  return language == Language::kSiemens    ? "--source siemens"
         : language == Language::kKlartext ? "--source heidenhain"
                                           : "--source ngc, fanuc, haas or grbl";
}

}  // namespace

std::span<const SourceFamily> source_families() { return kFamilies; }

std::optional<Language> source_language(const SourceText& source, SourceKind kind,
                                        std::optional<Language> target, Diagnostics& found) {
  const std::vector<LanguageMark> marks = language_marks(source);
  if (const SourceFamily* family = family_of(kind)) {
    const auto other = std::ranges::find_if(
        marks, [&](const LanguageMark& each) { return each.language != family->language; });
    if (other == marks.end()) return family->language;
    found.push_back(
        {Severity::kError, "source-contradicted", other->where,
         fmt::format("found {}, so this is a program in {}; expected one for {} "
                     "(--source {})",
                     other->evidence, describe(other->language), family->controls, family->name)});
    return std::nullopt;
  }
  // Many programs for Siemens controls are plain words that both languages have. The plainer
  // reading copies what it does not know.
  if (marks.empty()) {
    const bool klartext = target == Language::kKlartext && !plain_beginning(source);
    return klartext ? Language::kKlartext : Language::kRs274;
  }
  if (marks.size() == 1) return marks.front().language;
  found.push_back(
      {Severity::kError, "source-ambiguous", marks[1].where,
       fmt::format("found {}, as in a program in {}, and before it {}, as in one in {}; say {} or "
                   "{}, when the other mark is out of the program",
                   marks[1].evidence, describe(marks[1].language), marks[0].evidence,
                   describe(marks[0].language), option_for(marks[1].language),
                   option_for(marks[0].language))});
  return std::nullopt;
}

Decimals decimals_read(SourceKind kind, const Dialect* target, Language language,
                       const std::optional<Decimals>& declared) {
  if (language != Language::kRs274) return {};
  if (declared) return *declared;
  const SourceFamily* family = family_of(kind);
  const bool may_imply = family != nullptr ? family->may_imply_decimals
                                           : target != nullptr && target->may_imply_decimals();
  return {.pointless = may_imply ? PointlessNumbers::kUndeclared : PointlessNumbers::kUnits};
}

DwellForm dwells_of(SourceKind kind) {
  const SourceFamily* family = family_of(kind);
  return family != nullptr ? family->dwells : DwellForm::kUnknown;
}

std::string_view why_not_implied(SourceKind kind, const Dialect* target) {
  const SourceFamily* family = family_of(kind);
  if (family != nullptr && !family->may_imply_decimals) {
    return "programs for this source have no such numbers";
  }
  if (target != nullptr && !target->may_imply_decimals()) {
    return "this target takes X5 for 5 mm, and blocks are copied to it";
  }
  if (family == nullptr && target == nullptr) return "say --source fanuc or haas";
  return {};
}

void tell_of_contradictions(const Program& program, SourceKind kind, Diagnostics& found) {
  const SourceFamily* family = family_of(kind);
  if (family == nullptr) return;
  for (const FoundMark& each : source_marks(program)) {
    if ((family->marks & mark(each.mark)) != 0) continue;
    found.push_back({Severity::kError, "source-contradicted", each.where,
                     fmt::format("{}: not in a program for {} (--source {})", describe(each.mark),
                                 family->controls, family->name)});
  }
}

}  // namespace batten::gcode
