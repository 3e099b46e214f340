#include "geometry/distance/joints.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

namespace batten::geometry {

namespace {

// Of the length between two joints, by which the paths may differ: much more than a path that is
// smoothed gets shorter by, and less than a loop.
constexpr double kLonger = 0.1;

// The vertices of a path by their places: open addressing, linear probing.
class PlaceTable {
 public:
  explicit PlaceTable(const PassedPlaces& places)
      : places_(places), slots_(std::bit_ceil(places.size() + places.size() / 3 + 1), kNone) {
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      std::size_t slot = slot_of(places.place_at(i));
      while (slots_[slot] != kNone) slot = next(slot);
      slots_[slot] = i;
    }
  }

  // The first vertex in that place, of those that `takes` takes; nothing where there is none.
  template <typename Takes>
  [[nodiscard]] std::optional<std::size_t> first_at(const Point3& place, const Takes& takes) const {
    for (std::size_t slot = slot_of(place); slots_[slot] != kNone; slot = next(slot)) {
      const std::uint32_t i = slots_[slot];
      if (takes(i) && places_.place_at(i) == place) return i;
    }
    return std::nullopt;
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  [[nodiscard]] std::size_t next(std::size_t slot) const {
    return (slot + 1) & (slots_.size() - 1);
  }

  [[nodiscard]] std::size_t slot_of(const Point3& place) const {
    constexpr std::uint64_t kMix = 0x9E3779B97F4A7C15;  // 2^64 over the golden ratio
    std::uint64_t sum = 0;
    for (const double mm : place) {
      sum = (sum ^ std::bit_cast<std::uint64_t>(mm + 0.0)) * kMix;  // -0 is 0
      sum ^= sum >> 29;
    }
    return sum & (slots_.size() - 1);
  }

  const PassedPlaces& places_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace

std::vector<Joint> joints_of(const PassedPlaces& a, const PassedPlaces& b, std::size_t apart) {
  const PlaceTable places(a);
  std::vector<Joint> joints;
  Joint last;
  double length_a = 0;  // up to the last one
  double length_b = 0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    const double on_b = b.lengths[k] - length_b;
    const auto at = places.first_at(b.place_at(k), [&](std::size_t i) {
      const double on_a = a.lengths[i] - length_a;
      return i >= last.a && std::abs(on_a - on_b) <= kLonger * std::max(on_a, on_b);
    });
    if (!at) continue;
    const Joint joint{*at + 1, k + 1};
    if (joint.a - last.a < apart && joint.b - last.b < apart) continue;
    joints.push_back(joint);
    last = joint;
    length_a = a.lengths[*at];
    length_b = b.lengths[k];
  }
  return joints;
}

}  // namespace batten::geometry
