#include "tests/support/klartext_arc_alarms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

constexpr double kGreatestPlace = 99999.9999;

// What one line says.
struct MoveBlock {
  enum class Kind { kOther, kLine, kCenter, kArc } kind = Kind::kOther;
  std::array<std::optional<double>, 3> place;
  int sense = 0;  // 1 or -1
};

MoveBlock::Kind kind_of(const KlartextWord& keyword) {
  if (keyword.value) return MoveBlock::Kind::kOther;
  if (keyword.is("L")) return MoveBlock::Kind::kLine;
  if (keyword.is("CC")) return MoveBlock::Kind::kCenter;
  if (keyword.is("C")) return MoveBlock::Kind::kArc;
  return MoveBlock::Kind::kOther;
}

MoveBlock sorted(const std::optional<KlartextLine>& line) {
  MoveBlock block;
  if (!line || line->continues || line->words.empty()) return block;
  for (std::size_t i = 1; i < line->words.size(); ++i) {
    const KlartextWord& word = line->words[i];
    const bool axis = word.name.size() == 1 && word.name[0] >= 'X' && word.name[0] <= 'Z';
    if (axis && word.value) {
      block.place[static_cast<std::size_t>(word.name[0] - 'X')] = word.value;
    } else if (word.is("DR+") || word.is("DR-")) {
      block.sense = word.is("DR+") ? 1 : -1;
    } else if (!(word.is("F") && word.value) && !(word.is("R") && word.value == 0.0) &&
               !(word.is("M") && !word.value)) {
      return block;  // kOther
    }
  }
  block.kind = kind_of(line->words.front());
  return block;
}

}  // namespace

CurveAlarms klartext_arc_alarms(const Program& program, Units units) {
  const double unit = millimetres_per(units);
  CurveAlarms alarms;
  std::optional<std::array<double, 2>> center;  // in the plane, as printed
  std::array<std::optional<double>, 3> place;
  for (const Block& line : program.blocks) {
    const auto say = [&](std::string_view id) { alarms.push_back({line.line, id}); };
    const MoveBlock block = sorted(read_klartext_line(program.source.text(line.span)));
    for (const auto& value : block.place) {
      if (value && std::abs(*value) > kGreatestPlace) say("place-range");
    }
    if (block.kind == MoveBlock::Kind::kCenter) {
      center.reset();
      if (block.place[0] && block.place[1]) center = {{*block.place[0], *block.place[1]}};
      continue;
    }
    const std::array<std::optional<double>, 3> before = place;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block.kind == MoveBlock::Kind::kOther) place[axis].reset();
      if (block.place[axis]) place[axis] = block.place[axis];
    }
    if (block.kind != MoveBlock::Kind::kArc) continue;
    if (!center) say("arc-no-centre");
    if (block.sense == 0) say("arc-no-sense");
    if (!center || !before[0] || !before[1] || !place[0] || !place[1]) continue;
    const double start_radius = std::hypot(*before[0] - (*center)[0], *before[1] - (*center)[1]);
    const double end_radius = std::hypot(*place[0] - (*center)[0], *place[1] - (*center)[1]);
    const double mismatch = std::abs(end_radius - start_radius) * unit;
    if (mismatch <= kKlartextRadiusMismatch) continue;
    say("arc-radius");
  }
  return alarms;
}

}  // namespace batten::gcode
