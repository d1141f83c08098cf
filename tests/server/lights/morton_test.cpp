#include "server/lights/morton.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/lights/tree_oracle.h"

namespace macula::lights {
namespace {

std::uint64_t interleaved(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 21; ++bit) {
    code |= (std::uint64_t{x >> bit & 1U} << (3 * bit)) |
            (std::uint64_t{y >> bit & 1U} << (3 * bit + 1)) |
            (std::uint64_t{z >> bit & 1U} << (3 * bit + 2));
  }
  return code;
}

TEST(Morton, ACodeInterleavesTwentyOneBitsAnAxis) {
  EXPECT_EQ(morton_code(0x1FFFFF, 0x1FFFFF, 0x1FFFFF), (std::uint64_t{1} << 63) - 1);
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto draw = [&] { return static_cast<std::uint32_t>(random.next() * 0x1p21); };
    const std::uint32_t x = draw(), y = draw(), z = draw();
    EXPECT_EQ(morton_code(x, y, z), interleaved(x, y, z));
  }
}

/// As the room does it, by comparison instead of by digits.
std::vector<std::uint32_t> by_comparison(const std::vector<Vec3>& points) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
  const DVec3 extent = DVec3(high) - DVec3(low);
  const double side = std::max({extent.x, extent.y, extent.z});
  std::vector<std::uint64_t> codes;
  for (const Vec3& p : points) {
    const DVec3 at = (DVec3(p) - DVec3(low)) * (side > 0.0 ? 0x1p21 / side : 0.0);
    const auto cell = [](double c) { return std::min(static_cast<std::uint32_t>(c), 0x1FFFFFU); };
    codes.push_back(interleaved(cell(at.x), cell(at.y), cell(at.z)));
  }
  std::vector<std::uint32_t> order(points.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return codes[i]; });
  return order;
}

std::vector<std::uint32_t> by_radix(MortonOrder& order, const std::vector<Vec3>& points) {
  std::vector<Vec4> numbered;
  Vec3 low = points.empty() ? Vec3{0.0F} : points.front(), high = low;
  for (const Vec3& p : points) {
    low = glm::min(low, p), high = glm::max(high, p);
    numbered.emplace_back(p, static_cast<float>(numbered.size()));
  }
  base::BigVector<std::uint32_t> sorted;
  order.sort(numbered, cube_about(low, high), sorted);
  return {sorted.begin(), sorted.end()};
}

TEST(Morton, TheRadixSortOrdersAsAStableSortDoes) {
  test::Random random(2);
  std::vector<Vec3> points;
  for (int i = 0; i < 5000; ++i) points.push_back(random.in_cube(3.0));
  for (int i = 0; i < 500; ++i) points.push_back(points[static_cast<std::size_t>(7 * i)]);
  MortonOrder order;
  EXPECT_EQ(by_radix(order, points), by_comparison(points));
}

/// One point far away leaves the others in a few cells of the first digits: runs of every length,
/// down to points that only the last bits of their codes tell apart.
TEST(Morton, CrowdsInOneCellAreOrderedToTheLastBit) {
  MortonOrder order;
  for (const double crowd : {1.0, 1e-2, 1e-4, 1e-6}) {
    for (const std::size_t size : {3UL, 20UL, 200UL, 4000UL}) {
      test::Random random(size);
      std::vector<Vec3> points{{100.0F, 100.0F, 100.0F}};
      for (std::size_t i = 0; i < size; ++i) points.push_back(random.in_cube(crowd));
      points.push_back(points[size / 2]);
      ASSERT_EQ(by_radix(order, points), by_comparison(points)) << crowd << ' ' << size;
    }
  }
}

TEST(Morton, CoincidentAndCollinearPointsKeepTheirPlaces) {
  MortonOrder order;
  for (const std::size_t size : {100UL, 5000UL}) {
    const auto same = by_radix(order, std::vector<Vec3>(size, Vec3{5.0F, -2.0F, 1.0F}));
    for (std::uint32_t k = 0; k < size; ++k) ASSERT_EQ(same[k], k);
  }
  std::vector<Vec3> line;
  for (int i = 0; i < 64; ++i) line.emplace_back(0.0F, 0.0F, static_cast<float>(63 - i));
  const auto along = by_radix(order, line);
  for (std::uint32_t k = 0; k < 64; ++k) EXPECT_EQ(along[k], 63 - k);
  EXPECT_TRUE(by_radix(order, {}).empty());
}

}  // namespace
}  // namespace macula::lights
