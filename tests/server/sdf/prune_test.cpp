// What pruning may change: the work, not one bit of the field.
#include <gtest/gtest.h>

#include <cmath>

#include "server/sdf/evaluate.h"
#include "shared/base/text.h"
#include "tests/server/sdf/random_points.h"
#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

std::vector<Instruction> pruned_in(const Program& program, const Ball& ball) {
  Registers registers;
  PointBatch points{};
  points.set(0, ball.centre);
  const Tape recording = make_recording_tape(program.code, program.constants);
  return pruned(program.code, program.constants, record(recording, points, registers), ball.radius);
}

class Pruning : public testing::TestWithParam<const char*> {};

TEST_P(Pruning, KeepsEveryBitOfTheFieldInItsBall) {
  const Program program = compile(built_in(GetParam()), 0.7, {0.0, 2.0, 3.0});
  const Tape whole = make_tape(program);
  Uniform uniform;
  Registers registers;
  PointBatch points{};
  DistanceBatch truth{}, found{};
  std::size_t operations = 0;
  constexpr int kBalls = 400;
  for (int i = 0; i < kBalls; ++i) {
    const Ball ball{12.0F * Vec3(uniform(), 0.5F * uniform(), uniform()),
                    std::pow(10.0F, -1.0F + uniform())};
    const std::vector<Instruction> code = pruned_in(program, ball);
    const Tape tape = make_tape(code, program.constants);
    operations += operations_of(tape);
    for (std::size_t j = 0; j < kBatch; ++j) points.set(j, uniform.in_ball(ball));
    evaluate(whole, points, kBatch, registers, truth);
    evaluate(tape, points, kBatch, registers, found);
    for (std::size_t j = 0; j < kBatch; ++j) ASSERT_EQ(truth.at[j], found.at[j]) << i;
  }
  EXPECT_LT(operations, kBalls * operations_of(whole) / 2);
}

INSTANTIATE_TEST_SUITE_P(Sdf, Pruning, testing::Values("primitives", "columns", "temple"));

/// Spheres on a lattice of side^3, side by side but apart.
Field lattice(int side) {
  std::string nodes;
  for (int i = 0; i < side * side * side; ++i) {
    const double x = i % side, y = i / side % side, z = i / (side * side);
    nodes += (i > 0 ? "," : "") + std::string(R"({"type": "sphere", "radius": )") +
             std::to_string(0.4 / side) + R"(, "at": [)" + std::to_string((x + 0.5) / side - 0.5) +
             "," + std::to_string((y + 0.5) / side - 0.5) + "," +
             std::to_string((z + 0.5) / side - 0.5) + "]}";
  }
  return scene_of(R"({"type": "union", "of": [)" + nodes + "]}");
}

TEST(Pruning, SparesAThousandPrimitivesToMostRays) {
  const Pose pose = math::look_at({0.0, 0.3, 1.6}, DVec3{0.0}, {0.0, 1.0, 0.0});
  const Program program = compile(lattice(10), 0.0, pose.position);
  const PixelGrid grid = ordinary_grid(192, 192, Degrees{30.0});
  TraceOptions options;
  const Traced cones = trace_picture(program, pose, grid, options);
  options.method = Method::Full;
  const Traced full = trace_picture(program, pose, grid, options);
  EXPECT_LT(cones.counts.operations, full.counts.operations / 2);
}

/// A file may hold 65536 nodes; a field of 33000 spheres ended the program, which counts what it
/// records in 16 bits. It is traced whole.
TEST(Pruning, LeavesWhatIsTooLongToRecord) {
  std::string nodes;
  for (int i = 0; i < 33000; ++i)
    nodes += base::concat(i > 0 ? "," : "", R"({"type": "sphere", "radius": 0.4, "at": [)",
                          i % 200 - 100, ",", i / 200 - 80, ", -50]}");
  const Program program =
      compile(scene_of(base::concat(R"({"type": "union", "smooth": 0.01, "of": [)", nodes, "]}")),
              0.0, DVec3{0.0});
  ASSERT_GT(program.code.size(), kMostRecorded);
  const PixelGrid grid = ordinary_grid(3, 3);
  const Traced cones = trace_picture(program, Pose{}, grid, {});
  TraceOptions options;
  options.method = Method::Full;
  const Traced full = trace_picture(program, Pose{}, grid, options);
  for (std::size_t i = 0; i < full.hits.size(); ++i)
    EXPECT_EQ(cones.hits[i].status, full.hits[i].status);
}

TEST(Pruning, IsCarefulAtTheWallsOfRepeatedCells) {
  // The ball reaches into the next cell, where the other sphere is nearer.
  const Program program = compile(scene_of(R"({"type": "repeat", "period": [2, 0, 0], "of": [
      {"type": "sphere", "radius": 0.1, "at": [0.85, 0, 0]},
      {"type": "sphere", "radius": 0.1, "at": [-0.85, 0, 0]}]})"),
                                  0.0, DVec3{0.0});
  const Tape whole = make_tape(program);
  const Ball ball{{0.95F, 0.0F, 0.0F}, 0.3F};
  const std::vector<Instruction> code = pruned_in(program, ball);
  const Tape part = make_tape(code, program.constants);
  Uniform uniform;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = uniform.in_ball(ball);
    ASSERT_EQ(evaluate_at(whole, p), evaluate_at(part, p));
  }
}

}  // namespace
}  // namespace macula::sdf
