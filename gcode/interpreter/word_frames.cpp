// Words that move the origin, bend the coordinates, or act in their own block only.
#include "gcode/interpreter/word_applier.h"

namespace batten::gcode {

void WordApplier::apply_one_block_word(Code code) {
  switch (code) {
    case 40:
      // G4: X and U are seconds on FANUC, F and S seconds or turns on Sinumerik; LinuxCNC
      // would move with X.
      acts(reason::kDwell);
      effect_.takes_axes = true;
      forget_named_axes(state_, words_);
      return;
    case 90:
      // Exact stop; on Fagor an arc that starts tangentially.
      effect_.understood = false;
      return block(reason::kExactStop);
    case 530:
      // Machine coordinates: where that is in the program's is not known. The motion mode of
      // the block still becomes modal.
      acts(reason::kCoordinateChange);
      effect_.takes_axes = true;
      forget_named_axes(state_, words_);
      return;
    default:
      return acts(reason::kStateChange);
  }
}

void WordApplier::apply_axis_user(Code code) {
  effect_.takes_axes = true;
  switch (code) {
    case 280:
    case 300:
      // Home: all axes when none is named. Named ones pass through an intermediate place.
      acts(reason::kCoordinateChange);
      return words_.has_any("XYZUVW") ? forget_named_axes(state_, words_)
             : words_.has_any("ABC")  ? void()
                                      : forget_position(state_);
    case 281:
    case 301:
      // Store the home position: nothing moves by themselves. Axis words beside them are a motion
      // on LinuxCNC, in its mode, cycles too; of other controls nothing is known.
      acts(reason::kCoordinateChange);
      return words_.has_any("XYZABCUVWIJKR") ? forget_position(state_) : void();
    case 650:  // a macro call may leave any state behind
      acts(reason::kSubprogram);
      return;
    case 920:
      return apply_g92();
    case 100:
      // Data setting: work and tool offsets, and on FANUC lines of data until G11.
      acts(reason::kCoordinateChange);
      forget_position(state_);
      state_.work_offset = 0;
      modal().motion = MotionMode::kUnknown;
      return;
    default:  // G52, G92.1 ..: the coordinates of all axes may move
      acts(reason::kCoordinateChange);
      return forget_position(state_);
  }
}

// G92 sets coordinates; with S alone it limits the spindle on lathes; with F it is a thread.
void WordApplier::apply_g92() {
  acts(reason::kCoordinateChange);
  forget_named_axes(state_, words_);
  if (words_.has_any("FIKPQR")) {
    forget_position(state_);
    modal().motion = MotionMode::kUnknown;
  }
}

// G51 scales. G50 ends that on mills; on lathes it limits the spindle (S) or sets coordinates.
void WordApplier::apply_scaling(Code code) {
  effect_.takes_axes = true;
  if (code == 500 && words_.has_any("XYZUVWS")) {
    acts(reason::kCoordinateChange);
    return forget_named_axes(state_, words_);
  }
  set_frame(CodeGroup::kScaling, modal().scaling, code == 510 ? TriState::kOn : TriState::kOff,
            reason::kScaling);
}

void WordApplier::apply_rotation(Code code) {
  effect_.takes_axes = code != 690;
  if (code == 682 || code == 683 || code == 684) {
    return set_frame(CodeGroup::kRotation, modal().tilted_plane, TriState::kOn,
                     reason::kTiltedPlane);
  }
  if (code == 690) {
    set_frame(CodeGroup::kRotation, modal().tilted_plane, TriState::kOff, reason::kTiltedPlane);
  }
  set_frame(CodeGroup::kRotation, modal().rotation, code == 680 ? TriState::kOn : TriState::kOff,
            reason::kRotation);
}

// G7.1 C<radius>: on; a radius of zero ends it.
void WordApplier::apply_cylindrical() {
  bool ends = false;
  for (const char letter : {'A', 'B', 'C'}) {
    const Word* word = words_.find(letter);
    ends |= word != nullptr && word->is_number && word->value == 0;
  }
  effect_.takes_axes = true;
  set_frame(CodeGroup::kCylindrical, modal().cylindrical, ends ? TriState::kOff : TriState::kOn,
            reason::kCylindrical);
}

// G5.1 Q0, Q1: look-ahead only. Q2, Q3: the control fits a curve. With I, J: a spline.
void WordApplier::apply_smoothing(Code code) {
  if (code == 51 && words_.has_any("IJ")) {
    effect_.motion = code;
    return;
  }
  acts(reason::kControlSmoothing);
  effect_.takes_axes = true;  // X0 Y0 Z0 say which axes
  const Word* q = words_.find('Q');
  if (code == 51) {
    modal().control_smoothing = q == nullptr || !q->is_number ? TriState::kUnknown
                                : q->value <= 1               ? TriState::kOff
                                                              : TriState::kOn;
  } else {
    modal().control_smoothing = code == 1310 ? TriState::kOn : TriState::kOff;
  }
}

void WordApplier::apply_high_speed_mode() {
  const Word* p = words_.find('P');
  modal().control_smoothing = !p->is_number   ? TriState::kUnknown
                              : p->value == 0 ? TriState::kOff
                                              : TriState::kOn;
  acts(reason::kControlSmoothing);
}

void WordApplier::apply_modal_macro(Code code) {
  acts(reason::kModalMacro);
  if (code == 670) {
    modal().modal_macro = TriState::kOff;
  } else {
    effect_.takes_axes = true;  // arguments; apply_late_words forgets everything
  }
}

}  // namespace batten::gcode
