// The way of one motion. Nearly all are lines, whose two ends say all; what arcs and curves need
// beside them stands apart, so that a long program of lines takes little room.
#pragma once

#include <memory>
#include <variant>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// A geometry::PathPiece in half its room: 56 bytes, and another 112 for an arc or a cubic piece.
// Copies are cheap for lines.
class MotionPath {
 public:
  MotionPath() = default;  // no way, at the origin
  MotionPath(const geometry::Line& line) : start_(line.start), end_(line.end) {}
  MotionPath(const geometry::PathPiece& piece)
      : start_(geometry::start_point(piece)), end_(geometry::end_point(piece)) {
    if (!std::holds_alternative<geometry::Line>(piece)) {
      bend_ = std::make_unique<const geometry::PathPiece>(piece);
    }
  }
  MotionPath(const geometry::Arc& arc) : MotionPath(geometry::PathPiece(arc)) {}

  MotionPath(const MotionPath& other)
      : start_(other.start_), end_(other.end_), bend_(copy_of(other)) {}
  MotionPath& operator=(const MotionPath& other) {
    start_ = other.start_;
    end_ = other.end_;
    bend_ = copy_of(other);
    return *this;
  }
  MotionPath(MotionPath&&) noexcept = default;
  MotionPath& operator=(MotionPath&&) noexcept = default;
  ~MotionPath() = default;

  [[nodiscard]] const geometry::Point3& start() const { return start_; }
  [[nodiscard]] const geometry::Point3& end() const { return end_; }
  [[nodiscard]] bool is_line() const { return bend_ == nullptr; }
  // nullptr where it is no arc.
  [[nodiscard]] const geometry::Arc* arc() const {
    return bend_ != nullptr ? std::get_if<geometry::Arc>(bend_.get()) : nullptr;
  }

  operator geometry::PathPiece() const {
    return bend_ != nullptr ? *bend_ : geometry::PathPiece(geometry::Line{start_, end_});
  }

 private:
  static std::unique_ptr<const geometry::PathPiece> copy_of(const MotionPath& other) {
    return other.bend_ != nullptr ? std::make_unique<const geometry::PathPiece>(*other.bend_)
                                  : nullptr;
  }

  geometry::Point3 start_ = geometry::Point3::Zero();
  geometry::Point3 end_ = geometry::Point3::Zero();
  std::unique_ptr<const geometry::PathPiece> bend_;  // an arc or a cubic piece
};

}  // namespace batten::gcode
