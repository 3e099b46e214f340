#include "geometry/numeric/banded_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <vector>

namespace batten::geometry {
namespace {

// B B^T + I / 10, with B random and lower banded: positive definite with three sub-diagonals.
class RandomSystem {
 public:
  explicit RandomSystem(int size, unsigned seed = 1)
      : random_(seed), dense(Eigen::MatrixXd::Identity(size, size) / 10), banded(size) {
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(size, size);
    for (int i = 0; i < size; ++i) {
      for (int j = std::max(0, i - BandedMatrix::kBands); j <= i; ++j) b(i, j) = uniform_(random_);
    }
    dense += b * b.transpose();
    right_dense = Eigen::MatrixXd(size, 3);
    for (int i = 0; i < size; ++i) {
      for (int k = 0; k <= std::min(i, BandedMatrix::kBands); ++k)
        banded.at(i, k) = dense(i, i - k);
      right.emplace_back(uniform_(random_), uniform_(random_), uniform_(random_));
      right_dense.row(i) = right.back();
    }
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{-1, 1};

 public:
  Eigen::MatrixXd dense;
  Eigen::MatrixXd right_dense;
  BandedMatrix banded;
  std::vector<Point3> right;
};

TEST(BandedMatrix, SolvesAndInvertsAsADenseMatrixDoes) {
  for (const int size : {1, 2, 3, 4, 5, 8, 13, 40, 200}) {
    SCOPED_TRACE(testing::Message() << "size " << size);
    RandomSystem system(size);
    const Eigen::MatrixXd expected = system.dense.llt().solve(system.right_dense);
    const Eigen::MatrixXd expected_inverse = system.dense.inverse();
    ASSERT_TRUE(system.banded.solve(system.right));
    BandedMatrix inverse(0);
    system.banded.inverse_band(inverse, 0);
    for (int i = 0; i < size; ++i) {
      EXPECT_LE((system.right[i] - expected.row(i).transpose()).norm(), 1e-9) << i;
      for (int k = 0; k <= std::min(i, BandedMatrix::kBands); ++k) {
        EXPECT_NEAR(inverse.at(i, k), expected_inverse(i, i - k), 1e-9) << i << ", " << i - k;
      }
    }
  }
}

// With one unknown known, the others solve the system that is left when its row goes away and
// its column times the value goes to the right.
TEST(BandedMatrix, FixesAnUnknown) {
  constexpr int kSize = 12;
  const Point3 value(3, -2, 7);
  for (const int fixed : {0, 1, 5, kSize - 2, kSize - 1}) {
    SCOPED_TRACE(testing::Message() << "fixed " << fixed);
    RandomSystem system(kSize);
    std::vector<int> others;
    for (int i = 0; i < kSize; ++i) {
      if (i != fixed) others.push_back(i);
    }
    const Eigen::MatrixXd left = system.dense(others, others);
    Eigen::MatrixXd right = system.right_dense(others, Eigen::all);
    right -= system.dense(others, std::vector<int>{fixed}) * value.transpose();
    const Eigen::MatrixXd expected = left.llt().solve(right);

    system.banded.fix(fixed, value, system.right);
    ASSERT_TRUE(system.banded.solve(system.right));
    EXPECT_EQ(system.right[fixed], value);
    for (int i = 0; i + 1 < kSize; ++i) {
      EXPECT_LE((system.right[others[i]] - expected.row(i).transpose()).norm(), 1e-9) << others[i];
    }
  }
}

TEST(BandedMatrix, RefusesWhatIsNotPositiveDefinite) {
  for (const double last : {1.0, 2.0, 0.0}) {  // 1 last / last 1: singular, indefinite, and nothing
    BandedMatrix matrix(2);
    matrix.at(0, 0) = last > 0 ? 1 : 0;
    matrix.at(1, 0) = matrix.at(0, 0);
    matrix.at(1, 1) = last;
    std::vector<Point3> right(2, Point3::Ones());
    EXPECT_FALSE(matrix.solve(right)) << last;
  }
}

}  // namespace
}  // namespace batten::geometry
