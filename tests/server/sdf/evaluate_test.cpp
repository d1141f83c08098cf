#include "server/sdf/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/sdf/bank.h"
#include "server/sdf/read.h"

namespace macula::sdf {
namespace {

constexpr std::size_t kLanes = 1024;
struct alignas(64) Lanes {
  float at[kLanes];
};

std::uint32_t bits(float value) {
  return std::bit_cast<std::uint32_t>(value);
}

/// What lies beyond differs by a power of four, and its root by one of two.
TEST(Evaluate, RootsByProductsAreRoundedCorrectlyFromOneToFour) {
  Lanes squares{}, roots{};
  std::size_t wrong = 0;
  for (std::uint32_t first = bits(1.0F); first < bits(4.0F); first += kLanes) {
    for (std::uint32_t i = 0; i < kLanes; ++i) squares.at[i] = std::bit_cast<float>(first + i);
    roots_by_products(squares.at, kLanes, roots.at);
    for (std::size_t i = 0; i < kLanes; ++i) wrong += roots.at[i] != std::sqrt(squares.at[i]);
  }
  EXPECT_EQ(wrong, 0U);
}

TEST(Evaluate, RootsByProductsAreRightFarFromOne) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float odd[] = {0.0F, 1e-37F, 3e-31F, 1e-30F, 2.5F, 1e30F, 2e30F, 3e38F, kInfinity};
  for (const float square : odd) {
    // Once beside others like it, once beside what is usual.
    for (const float beside : {square, 2.0F}) {
      Lanes squares{}, roots{};
      std::fill_n(squares.at, kLanes, beside);
      squares.at[5] = square;
      roots_by_products(squares.at, kLanes, roots.at);
      EXPECT_EQ(roots.at[5], std::sqrt(square)) << square << " beside " << beside;
      EXPECT_EQ(roots.at[700], std::sqrt(beside)) << square << " beside " << beside;
    }
  }
  Lanes squares{}, roots{};
  std::fill_n(squares.at, kLanes, 1.0F);
  squares.at[3] = std::numeric_limits<float>::quiet_NaN();
  roots_by_products(squares.at, kLanes, roots.at);
  EXPECT_TRUE(std::isnan(roots.at[3]));
  EXPECT_EQ(roots.at[4], 1.0F);
}

std::size_t count_of(const Program& program, Op op) {
  return static_cast<std::size_t>(std::ranges::count(program.code, op, &Instruction::op));
}

TEST(Evaluate, WhatIsRoundAboutOneLineMeasuresItsDistanceOnce) {
  const auto field = parse_field(R"({"scene": {"type": "union", "of": [
      {"type": "torus", "radius": 1, "tube_radius": 0.2, "at": [1, 0, 2]},
      {"type": "cone", "bottom_radius": 1, "top_radius": 0.5, "half_height": 1, "at": [1, 3, 2]},
      {"type": "cylinder", "radius": 0.5, "half_height": 1, "at": [1, -4, 2]},
      {"type": "cylinder", "radius": 0.5, "half_height": 1, "at": [5, 0, 2]}]}})",
                                 "test");
  ASSERT_TRUE(field) << field.error().message();
  const Program program = compile(*field, 0.0, DVec3{0.0});
  EXPECT_EQ(count_of(program, Op::Revolve), 2U);

  const Tape tape = make_tape(program);
  EXPECT_FLOAT_EQ(evaluate_at(tape, {1.0F, 0.0F, 2.0F}), 0.8F);
  EXPECT_FLOAT_EQ(evaluate_at(tape, {1.0F, -9.0F, 2.0F}), 4.0F);  // below the first cylinder
  EXPECT_FLOAT_EQ(evaluate_at(tape, {8.0F, 0.0F, 2.0F}), 2.5F);   // beside the second
  EXPECT_FLOAT_EQ(evaluate_at(tape, {1.0F, 6.0F, 2.0F}), 2.0F);   // above the cone
  // Beside the cone's upper rim the slanted side is nearest: 2 m up over 0.5 m in.
  EXPECT_FLOAT_EQ(evaluate_at(tape, {1.0F, 4.0F, 3.5F}), 4.0F / std::sqrt(17.0F));
}

}  // namespace
}  // namespace macula::sdf
