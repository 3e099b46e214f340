// Which of many boxes in the plane overlap, where they are of about one size: the edges of a path
// that was cut into short chords. Linear time for those.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// Its edges belong to it.
struct FlatBox {
  Point2 low;
  Point2 high;
};

class BoxGrid {
 public:
  // Nothing where the boxes are of so many sizes, or in such heaps, that a grid would be slow.
  // `boxes` must outlive the grid. Requires one box or more, all finite.
  [[nodiscard]] static std::optional<BoxGrid> made_of(std::span<const FlatBox> boxes);

  // Calls `found(a, b)` with a < b once for each two boxes that overlap, in no special order.
  template <typename Function>
  void each_pair(const Function& found) const {
    for (std::size_t cell = 0; cell + 1 < first_.size(); ++cell) {
      for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        for (std::uint32_t k = i + 1; k < first_[cell + 1]; ++k) {
          if (meet_in(cell, inside_[i], inside_[k])) found(inside_[i], inside_[k]);
        }
      }
    }
  }

 private:
  struct Cells {
    std::size_t column_low;
    std::size_t column_high;  // inclusive
    std::size_t row_low;
    std::size_t row_high;
  };

  explicit BoxGrid(std::span<const FlatBox> boxes) : boxes_(boxes) {}

  void choose_cells();
  [[nodiscard]] bool fill();
  [[nodiscard]] std::size_t column_of(double x) const;
  [[nodiscard]] std::size_t row_of(double y) const;
  [[nodiscard]] Cells cells_of(const FlatBox& box) const;

  // Whether two boxes overlap and this is the cell of the lower corner of what they share: they
  // may be together in other cells too.
  [[nodiscard]] bool meet_in(std::size_t cell, std::uint32_t a, std::uint32_t b) const {
    const Point2 low = boxes_[a].low.cwiseMax(boxes_[b].low);
    const Point2 high = boxes_[a].high.cwiseMin(boxes_[b].high);
    if (low.x() > high.x() || low.y() > high.y()) return false;
    return row_of(low.y()) * columns_ + column_of(low.x()) == cell;
  }

  std::span<const FlatBox> boxes_;
  Point2 corner_ = Point2::Zero();  // the least place of all boxes
  double size_ = 1;                 // mm, of a cell
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  std::vector<std::uint32_t> first_;   // per cell, and one more: its first place in `inside_`
  std::vector<std::uint32_t> inside_;  // boxes, cell by cell, in order
};

}  // namespace batten::geometry
