#include "geometry/path/box_grid.h"

#include <algorithm>
#include <cmath>

namespace batten::geometry {
namespace {

// A cell is so many boxes wide: most boxes are in one or two cells then.
constexpr double kBoxesPerCell = 2;

// Cells for each box at most, for paths that fill little of the area around them.
constexpr double kCellsPerBox = 2;

// Beyond these a grid is no help: cells that one box is in, and pairs that one box is asked for.
constexpr std::size_t kMostCellsPerBox = 8;
constexpr std::size_t kMostPairsPerBox = 64;

std::size_t index_at(double from_corner, double size, std::size_t count) {
  const double index = from_corner / size;
  if (!(index > 0)) return 0;
  return std::min(static_cast<std::size_t>(index), count - 1);
}

}  // namespace

std::size_t BoxGrid::column_of(double x) const {
  return index_at(x - corner_.x(), size_, columns_);
}

std::size_t BoxGrid::row_of(double y) const { return index_at(y - corner_.y(), size_, rows_); }

BoxGrid::Cells BoxGrid::cells_of(const FlatBox& box) const {
  return {column_of(box.low.x()), column_of(box.high.x()), row_of(box.low.y()),
          row_of(box.high.y())};
}

void BoxGrid::choose_cells() {
  const auto count = static_cast<double>(boxes_.size());
  Point2 low = boxes_.front().low;
  Point2 high = boxes_.front().high;
  double sizes = 0;
  for (const FlatBox& box : boxes_) {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
    sizes += (box.high - box.low).maxCoeff();
  }
  corner_ = low;
  const Point2 all = high - low;
  const double most_cells = kCellsPerBox * count;
  // In one direction alone and in both: no more cells than that.
  size_ = std::max({kBoxesPerCell * sizes / count, std::sqrt(all.x() * all.y() / most_cells),
                    all.maxCoeff() / most_cells});
  if (!(size_ > 0)) size_ = 1;  // all are one place
  columns_ = static_cast<std::size_t>(all.x() / size_) + 1;
  rows_ = static_cast<std::size_t>(all.y() / size_) + 1;
}

// False where the grid would be slow.
bool BoxGrid::fill() {
  std::vector<std::size_t> counts(columns_ * rows_, 0);
  std::size_t entries = 0;
  for (const FlatBox& box : boxes_) {
    const Cells cells = cells_of(box);
    entries += (cells.row_high - cells.row_low + 1) * (cells.column_high - cells.column_low + 1);
    if (entries > kMostCellsPerBox * boxes_.size()) return false;
    for (std::size_t row = cells.row_low; row <= cells.row_high; ++row) {
      for (std::size_t c = cells.column_low; c <= cells.column_high; ++c) {
        ++counts[row * columns_ + c];
      }
    }
  }
  std::size_t pairs = 0;
  first_.assign(counts.size() + 1, 0);
  for (std::size_t cell = 0; cell < counts.size(); ++cell) {
    pairs += counts[cell] * counts[cell] / 2;
    if (pairs > kMostPairsPerBox * boxes_.size()) return false;
    first_[cell + 1] = first_[cell] + static_cast<std::uint32_t>(counts[cell]);
  }
  inside_.resize(entries);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    const Cells cells = cells_of(boxes_[i]);
    for (std::size_t row = cells.row_low; row <= cells.row_high; ++row) {
      for (std::size_t c = cells.column_low; c <= cells.column_high; ++c) {
        inside_[next[row * columns_ + c]++] = i;
      }
    }
  }
  return true;
}

std::optional<BoxGrid> BoxGrid::made_of(std::span<const FlatBox> boxes) {
  BoxGrid grid(boxes);
  grid.choose_cells();
  if (!grid.fill()) return std::nullopt;
  return grid;
}

}  // namespace batten::geometry
