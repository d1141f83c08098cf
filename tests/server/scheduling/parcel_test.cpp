#include "server/scheduling/parcel.h"

#include <gtest/gtest.h>

#include <vector>

#include "shared/math/hash.h"

namespace macula::test {
namespace {

using scheduling::Bytes;
using scheduling::Parcel;

image::Plane<float> numbered(int width, int height, float first) {
  image::Plane<float> plane(width, height);
  for (std::size_t i = 0; i < plane.size(); ++i) plane.data()[i] = first + static_cast<float>(i);
  return plane;
}

TEST(Parcel, CarriesTheCellsThatAMaskWantsAndLeavesTheOthersAlone) {
  constexpr int kWidth = 37, kHeight = 11;
  const image::Rect rect{5, 2, 30, 7};
  image::Plane<std::uint8_t> mask(kWidth, kHeight);
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask.data()[i] = static_cast<std::uint8_t>(math::hash_mix(i) & 1);
  for (const std::uint8_t wanted : {std::uint8_t{0}, std::uint8_t{1}}) {
    image::Plane<float> sent = numbered(kWidth, kHeight, 1000.0F);
    const image::Plane<float> before = numbered(kWidth, kHeight, 0.0F);
    image::Plane<float> got = before;
    const auto cells = scheduling::marked_cells(mask, rect, wanted);
    Bytes bytes;
    std::size_t weight = 0;
    Parcel::weighing(weight).cells(sent, cells);
    Parcel::packing(bytes).cells(sent, cells);
    EXPECT_EQ(weight, bytes.size());
    EXPECT_LT(bytes.size(), sizeof(float) * 30 * 7);
    Parcel unpacking = Parcel::unpacking(bytes);
    unpacking.cells(got, cells);
    EXPECT_EQ(unpacking.left(), 0U);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool inside = x >= 5 && x < 35 && y >= 2 && y < 9;
        const bool carried = inside && mask(x, y) == wanted;
        ASSERT_EQ(got(x, y), (carried ? sent : before)(x, y)) << x << ", " << y;
      }
    }
  }
}

TEST(Parcel, AMaskThatWantsNothingCarriesNothing) {
  const image::Plane<std::uint8_t> mask(8, 8, 0);
  EXPECT_TRUE(scheduling::marked_cells(mask, {0, 0, 8, 8}, 1).empty());
  EXPECT_EQ(scheduling::marked_cells(mask, {0, 0, 8, 8}, 0).size(), 64U);
}

}  // namespace
}  // namespace macula::test
