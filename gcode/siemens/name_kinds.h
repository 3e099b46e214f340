// What kind of word a name of a Siemens program is, as far as it is known.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>

namespace batten::gcode {

enum class NameKind : std::uint8_t {
  kNothing,      // how the axes are driven, messages: no path, no state
  kDeclaration,  // the rest of the line declares something
  kTolerance,    // how far the control may round, not where the path is
  kRefitOn,
  kRefitOff,
  kToolCenterOn,
  kTransformationOff,
  kPolarOn,
  kCylinderOn,
  kTilt,  // with arguments on, without off
  kTiltOn,
  kOffset,    // the frame that moves the origin
  kOffsetOn,  // what adds to it
  kRotation,
  kScaling,
  kMirror,
  kRotationOn,  // the additive frames: whatever stands beside them, they do not take any back
  kScalingOn,
  kMirrorOn,
  kSpline,     // the motion group: splines, circles through points
  kBlockPath,  // the path of this block, or its end, is not what X, Y, Z say
  kBlending,
  kInch,
  kMillimetre,
  kPole,      // takes axis words; nothing moves
  kApproach,  // takes axis words; the axes go to places of the machine
  kWorkOffset,
  kTool,
  kSpindle,
  kDiameterOn,
  kDiameterOff,
  kCycle,      // drills, mills ..; afterwards the modes are as before, the place is not known
  kModalCall,  // with a call beside it: a cycle at every place that follows; alone: no more
  kSurfaceSpeedOn,
  kSurfaceSpeedOff,
  kTiltOff,
  kThread,
  kOtherAxis,  // an axis or a direction beside X, Y, Z
  kVariable,   // a value for the program's own computing
};

// `name` in upper case; `assigned`: an = stands behind it. Nothing for names that are not known:
// they could do anything.
[[nodiscard]] std::optional<NameKind> kind_of_siemens_name(std::string_view name, bool assigned);

// Variables that a Siemens program declares for itself: DEF REAL A, B = 5, C[3]. To set one changes
// nothing but what words in which it stands will say.

using SiemensVariables = std::unordered_set<std::string>;  // in upper case

// `declaration` is what stands behind DEF: the type, then the names with their first values.
void add_declared_names(std::string_view declaration, SiemensVariables& variables);

}  // namespace batten::gcode
